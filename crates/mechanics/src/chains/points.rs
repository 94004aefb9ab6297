//! The particle chain with roller, bush and pin of every joint as points of their own.
//!
//! ```text
//! q = [ x, y of the rollers | x, y of the ends before the joints | x, y of the ends after them ]
//!
//!   link i − 1 ──○ before   after ○── link i      one of the two ends is the bush, the other the pin
//!                   ◎ roller, around the bush     tooth ↔ roller ↔ bush ↔ pin
//! ```
//!
//! All blocks are as long as the rollers' of the plain particle chain, copies of the first ones after the last included. Links are
//! springs between ends and pull nothing else, so that what is stiff stands in one joint: an implicit step solves the contacts of
//! each joint by themselves, several joints at a time (`damp.rs`).

mod build;
mod damp;
mod forces;
pub(crate) mod model;
mod observe;
mod statics;

use chaindrive_contact::PreparedLaw;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Weights;
use chaindrive_integrate::{Array, Moment};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::particles::{Links, Turning};
use crate::bodies::{GroupBodies, Surroundings};
use crate::chains::makeup::{Makeup, Statics};
use crate::chains::series::Series;
use crate::contact::{BoreContact, OfPins, PinAccelerations, PlatePins};
use crate::energy::Energy;
use crate::joints::JointFindings;
use crate::lanes::Wide;
use crate::seam::{Loads, Observation, Pose, Rates};

pub use model::PointJoints;

/// Roller, bush and pin as point masses.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    series: Series,
    pub(super) links: Links,
    /// Pins in bushes, and bushes in rollers.
    pin: BoreContact,
    bush: BoreContact,
    /// Stiffness of both where they hardly touch \[N/m\]: that of contacts which are open now.
    shallow: [f64; 2],
    /// One where the end after a joint is the bush, zero elsewhere.
    bush_after: Array,
    /// Masses \[kg\] and inverse masses \[1/kg\] of rollers, ends before and ends after.
    masses: [Array; 3],
    inverse_masses: [Array; 3],
    /// Inverse masses of the lightest of each \[1/kg\].
    lightest: [f64; 3],
    /// ω² of the links alone and twice their damping rate.
    link_rates: [f64; 2],
}

/// Rollers, ends before the joints, ends after them: the order of the blocks.
const ROLLERS: usize = 0;
const BEFORE: usize = 1;
const AFTER: usize = 2;

/// Findings of one evaluation in the joints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Work {
    pub(crate) joints: JointFindings,
    /// Directions of the links, where something resists their turning.
    #[serde(skip)]
    turning: Turning,
    pins: JointContacts,
    bushes: JointContacts,
    /// Closed contacts of rollers with wheels and rails.
    touching: Vec<damp::ClosedContact>,
    /// Coordinates that each of these moves with.
    mounts: Vec<[usize; 3]>,
    /// Rollers with them, in the matrix and on the right of an implicit step.
    #[serde(skip)]
    pressed: damp::RollerBlocks,
    /// Wheels and rails by themselves, in an implicit step.
    #[serde(skip)]
    own: damp::BodyEquations,
}

/// Contacts of one kind in all joints, whole lanes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct JointContacts {
    /// n, from the centre of what has the bore to that of what turns in it, or back.
    normal_x: Array,
    normal_y: Array,
    force: Array,
    /// ∂F/∂δ \[N/m\] and ∂F/∂δ̇ \[N s/m\].
    stiffness: Array,
    damping: Array,
    /// The greatest of each.
    stiffest: f64,
    damped: f64,
}

impl JointContacts {
    fn resize(&mut self, count: usize) {
        if self.force.len() == count {
            return;
        }
        for values in [
            &mut self.normal_x,
            &mut self.normal_y,
            &mut self.force,
            &mut self.stiffness,
            &mut self.damping,
        ] {
            values.resize(count, 0.0);
        }
    }
}

/// The ends of the links as guides for plates see them.
struct Ends<'a> {
    chain: &'a Points,
    q: &'a [f64],
    v: &'a [f64],
    a: &'a mut [f64],
}

impl Ends<'_> {
    /// What the ends of a lane of links have.
    #[inline(always)]
    fn of_lane<S: Simd>(&self, w: Wide<S>, values: &[f64], link: usize) -> OfPins<S> {
        let n = self.chain.series.stride;
        let (after, before) = (2 * AFTER * n + link, 2 * BEFORE * n + link + 1);
        [
            [w.load(values, after), w.load(values, after + n)],
            [w.load(values, before), w.load(values, before + n)],
        ]
    }
}

impl PlatePins for Ends<'_> {
    #[inline(always)]
    fn places<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        self.of_lane(w, self.q, link)
    }

    #[inline(always)]
    fn velocities<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        self.of_lane(w, self.v, link)
    }

    /// An end that is struck in its joint moves at once.
    #[inline(always)]
    fn drawn<S: Simd>(&self, _w: Wide<S>, _link: usize) -> Option<PinAccelerations<S>> {
        None
    }

    #[inline(always)]
    fn push<S: Simd>(&mut self, w: Wide<S>, link: usize, [first, second]: OfPins<S>) {
        let n = self.chain.series.stride;
        for (block, i, force) in [(AFTER, link, first), (BEFORE, link + 1, second)] {
            let inverse_mass = w.load(&self.chain.inverse_masses[block], i);
            let (x, y) = (2 * block * n + i, (2 * block + 1) * n + i);
            (w.load(self.a, x) + force[0] * inverse_mass).store(self.a, x);
            (w.load(self.a, y) + force[1] * inverse_mass).store(self.a, y);
        }
    }
}

impl Points {
    /// Two coordinates as a point.
    fn point(&self, q: &[f64], block: usize, joint: usize) -> Point {
        let n = self.series.stride;
        Point::new(q[2 * block * n + joint], q[(2 * block + 1) * n + joint])
    }

    /// Entries of a point in the state.
    fn entries(&self, block: usize, joint: usize) -> [usize; 2] {
        let n = self.series.stride;
        [2 * block * n + joint, (2 * block + 1) * n + joint]
    }

    /// Block of the bush at a joint, and of the pin.
    fn sides(&self, joint: usize) -> [usize; 2] {
        if self.bush_after[joint] > 0.0 {
            [AFTER, BEFORE]
        } else {
            [BEFORE, AFTER]
        }
    }
}

impl Makeup for Points {
    type Work = Work;

    const SOLVES: bool = true;
    const READS_FACES: bool = true;

    fn series(&self) -> &Series {
        &self.series
    }

    fn series_mut(&mut self) -> &mut Series {
        &mut self.series
    }

    fn coordinates(&self) -> usize {
        6 * self.series.stride
    }

    fn name(&self, coordinate: usize) -> String {
        let n = self.series.stride;
        let (block, axis) = (coordinate / n / 2, coordinate / n % 2);
        let joint = coordinate % n % self.series.rollers;
        let [bush, _] = self.sides(joint);
        let part = match block {
            ROLLERS => "roller",
            block if block == bush => "bush",
            _ => "pin",
        };
        format!("{part} {joint} along {}", ["x", "y"][axis])
    }

    fn inertias(&self) -> Vec<f64> {
        let each = self.masses.iter();
        each.flat_map(|masses| [&**masses, masses].concat())
            .collect()
    }

    /// Gives the points of every joint the velocity of its roller.
    fn set_off(&self, _places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        for (i, velocity) in velocities.iter().enumerate() {
            for block in [ROLLERS, BEFORE, AFTER] {
                let [x, y] = self.entries(block, i);
                (v[x], v[y]) = (velocity.x, velocity.y);
            }
        }
        self.copy_ghosts(v);
    }

    fn pose<'a>(&self, at: Moment<'a>, _work: &'a mut Work) -> Pose<'a> {
        Pose::of_first(at, self.series.stride)
    }

    fn evaluate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        loads: &mut Loads,
        work: &mut Work,
    ) {
        self.accelerate(around, at, a, rates, (loads, work));
    }

    fn rates(&self, around: Surroundings<'_>, loads: &Loads, work: &mut Work) -> Rates {
        Rates::of(self.stiffest_mode(around, loads, work))
    }

    fn tensions(&self, at: Moment<'_>, _work: &Work, out: &mut Vec<f64>) {
        let end = |block: usize, joint: usize| {
            let place = self.point(at.q, block, joint);
            (place, self.point(at.v, block, joint).coords)
        };
        let links = (0..self.series.rollers).map(|link| {
            let next = (link + 1) % self.series.rollers;
            let ends = [end(AFTER, link), end(BEFORE, next)];
            self.links.tension(link, ends)
        });
        out.extend(links);
    }

    fn observe(&self, at: Moment<'_>, _work: &Work, out: &mut Observation) {
        self.observe_motion(at, out);
    }

    fn energies(&self, at: Moment<'_>, gravity: Vector, work: &Work, out: &mut Energy) {
        self.add_energies(at, gravity, &work.joints, out);
    }

    fn observe_forces(&self, at: Moment<'_>, work: &Work, out: &mut Observation) {
        self.tensions(at, work, &mut out.link_tension);
        self.observe_joints(work, out);
    }

    fn joints(&self) -> usize {
        self.series.rollers
    }

    fn bearing_laws(&self) -> [Option<PreparedLaw>; 2] {
        [&self.pin, &self.bush].map(|bearing| Some(bearing.law))
    }

    fn damps_stiffly(&self, _touches: bool) -> bool {
        true
    }

    fn solve(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        work: &mut Work,
        x: &mut [f64],
    ) -> bool {
        self.implicit_step(bodies, weights, work, x)
    }
}
