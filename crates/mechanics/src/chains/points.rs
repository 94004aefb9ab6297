//! The particle chain with roller, bush and pin of every joint as points of their own.
//!
//! ```text
//! q = [ x, y of the rollers | x, y of the ends before the joints | x, y of the ends after them ]
//!
//!   link i − 1 ──○ before   after ○── link i      one of the two ends is the bush, the other the pin
//!                   ◎ roller, around the bush     tooth ↔ roller ↔ bush ↔ pin
//! ```
//!
//! All blocks are as long as the rollers' of the plain particle chain, copies of the first ones behind the last included. Links are
//! springs between ends and pull nothing else, so that what is stiff stands in one joint: an implicit step solves the contacts of
//! each joint by themselves, several joints at a time (`damp.rs`).

mod build;
mod damp;
mod forces;
pub(crate) mod model;
mod observe;
mod statics;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, Registers};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::particles::Links;
use crate::chains::Record;
use crate::chains::held_end::HeldEnd;
use crate::contact::{Bearing, ContactMemory, Drawn, OfPins, PlatePins, PlatePlaces, Tally};
use crate::joints::Joints;
use crate::lanes::Wide;
use crate::seam::Pose;

pub use model::PointJoints;

/// Roller, bush and pin as point masses.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    pub(super) links: Links,
    /// Resistance in the joints beside the contacts, if any.
    pub(in crate::chains) joints: Option<Joints>,
    /// Pins in bushes, and bushes in rollers.
    pin: Bearing,
    bush: Bearing,
    /// Stiffness of both where they hardly touch \[N/m\]: that of contacts which are open now.
    shallow: [f64; 2],
    /// One where the end after a joint is the bush, zero elsewhere.
    bush_after: Array,
    rollers: usize,
    stride: usize,
    pitch: f64,
    /// Masses \[kg\] and inverse masses \[1/kg\] of rollers, ends before and ends after.
    masses: [Array; 3],
    inverse_masses: [Array; 3],
    /// Inverse masses of the lightest of each \[1/kg\].
    lightest: [f64; 3],
    /// ω² of the links alone and twice their damping rate.
    link_rates: [f64; 2],
    /// Memory of the joints of the last accepted state.
    pub(in crate::chains) memory: Memory,
    /// None: the chain is closed.
    pub(in crate::chains) ends: Vec<HeldEnd>,
    pub(in crate::chains) registers: Registers,
}

/// Rollers, ends before the joints, ends after them: the order of the blocks.
const ROLLERS: usize = 0;
const BEFORE: usize = 1;
const AFTER: usize = 2;

/// State of the contacts in the joints at an accepted moment.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Memory {
    pub(in crate::chains) time: f64,
    pub(in crate::chains) pins: ContactMemory,
    /// Of the bushes in their rollers.
    pub(in crate::chains) bushes: ContactMemory,
}

/// Findings of one evaluation in the joints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Found {
    pub(in crate::chains) memory: Memory,
    pub(in crate::chains) tallies: [Tally; 2],
    pins: Held,
    bushes: Held,
    /// Closed contacts of rollers with wheels and rails.
    touching: Vec<damp::Touching>,
    /// Coordinates that each of these moves with.
    mounts: Vec<[usize; 3]>,
    /// Rollers with them, in the matrix and on the right of an implicit step.
    #[serde(skip)]
    pressed: damp::Pressed,
    /// Wheels and rails by themselves, in an implicit step.
    #[serde(skip)]
    own: damp::Own,
}

/// Contacts of one kind in all joints, whole lanes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Held {
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

impl Held {
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
    /// Block and number of an end of a link.
    fn entry(&self, link: usize, end: usize) -> (usize, usize) {
        if end == 0 {
            (AFTER, link)
        } else {
            // Behind the last link is the first joint again.
            (BEFORE, (link + 1) % self.chain.rollers)
        }
    }
}

impl PlatePlaces for Ends<'_> {
    fn place(&self, link: usize, end: usize) -> Point {
        let (block, i) = self.entry(link, end);
        self.chain.point(self.q, block, i)
    }
}

impl Ends<'_> {
    /// What the ends of a lane of links have.
    #[inline(always)]
    fn of_lane<S: Simd>(&self, w: Wide<S>, values: &[f64], link: usize) -> OfPins<S> {
        let n = self.chain.stride;
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
    fn drawn<S: Simd>(&self, _w: Wide<S>, _link: usize) -> Option<Drawn<S>> {
        None
    }

    #[inline(always)]
    fn push<S: Simd>(&mut self, w: Wide<S>, link: usize, [first, second]: OfPins<S>) {
        let n = self.chain.stride;
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
        let n = self.stride;
        Point::new(q[2 * block * n + joint], q[(2 * block + 1) * n + joint])
    }

    /// Entries of a point in the state.
    fn entries(&self, block: usize, joint: usize) -> [usize; 2] {
        let n = self.stride;
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

    pub(in crate::chains) fn coordinates(&self) -> usize {
        6 * self.stride
    }

    pub(in crate::chains) fn free_coordinates(&self) -> usize {
        6 * self.rollers
    }

    pub(in crate::chains) fn name(&self, coordinate: usize) -> String {
        let n = self.stride;
        let (block, axis) = (coordinate / n / 2, coordinate / n % 2);
        let joint = coordinate % n % self.rollers;
        let [bush, _] = self.sides(joint);
        let part = match block {
            ROLLERS => "roller",
            block if block == bush => "bush",
            _ => "pin",
        };
        format!("{part} {joint} along {}", ["x", "y"][axis])
    }

    pub(in crate::chains) fn inertias(&self) -> Vec<f64> {
        let each = self.masses.iter();
        each.flat_map(|masses| [&**masses, masses].concat())
            .collect()
    }

    pub(in crate::chains) fn rollers(&self) -> usize {
        self.rollers
    }

    pub(in crate::chains) fn links(&self) -> usize {
        self.links.count
    }

    pub(in crate::chains) fn joints(&self) -> usize {
        self.rollers
    }

    pub(in crate::chains) fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Length of the chain without load, from roller to roller, in nominal pitches a link.
    pub(in crate::chains) fn elongation(&self) -> f64 {
        let rest: f64 = self.links.rest[..self.links.count].iter().sum();
        // Every joint adds the play of its pin.
        rest / (self.links.count as f64 * self.pitch) + self.pin.clearance / self.pitch
    }

    pub(in crate::chains) fn pose<'a>(&self, at: Moment<'a>, _record: &'a mut Record) -> Pose<'a> {
        let n = self.stride;
        Pose {
            x: &at.q[..n],
            y: &at.q[n..2 * n],
            vx: &at.v[..n],
            vy: &at.v[n..2 * n],
        }
    }

    /// Moves the three points of every joint by the same.
    pub(in crate::chains) fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        for i in 0..self.rollers {
            let shift = [shift(), shift()];
            for block in [ROLLERS, BEFORE, AFTER] {
                for (entry, shift) in self.entries(block, i).into_iter().zip(shift) {
                    q[entry] += shift;
                }
            }
        }
        self.copy_ghosts(q);
    }

    /// Gives the copies behind the last joint the values of their originals.
    pub(in crate::chains) fn copy_ghosts(&self, values: &mut [f64]) {
        for block in values[..self.coordinates()].chunks_exact_mut(self.stride) {
            // A copy behind the first turn is one of the turn before.
            for ghost in self.rollers..block.len() {
                block[ghost] = block[ghost - self.rollers];
            }
        }
    }

    /// Gives the points of every joint the velocity of its roller.
    pub(in crate::chains) fn set_off(
        &self,
        _places: &[Point],
        velocities: &[Vector],
        v: &mut [f64],
    ) {
        for (i, velocity) in velocities.iter().enumerate() {
            for block in [ROLLERS, BEFORE, AFTER] {
                let [x, y] = self.entries(block, i);
                (v[x], v[y]) = (velocity.x, velocity.y);
            }
        }
        self.copy_ghosts(v);
    }

    pub(in crate::chains) fn commit(
        &mut self,
        _t: f64,
        _q: &mut [f64],
        _v: &mut [f64],
        record: &mut Record,
    ) {
        std::mem::swap(&mut self.memory, &mut record.points.memory);
        if let Some(joints) = &mut self.joints {
            joints.commit(&mut record.resistance);
        }
    }

    /// Goes on from what the joints remembered.
    pub(in crate::chains) fn remember(&mut self, memory: Memory) -> Result<(), crate::MemoryError> {
        let count = crate::lanes::padded(self.rollers);
        memory.pins.check(count)?;
        memory.bushes.check(count)?;
        self.memory = memory;
        Ok(())
    }
}
