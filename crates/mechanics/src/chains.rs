//! Chains as a family: this table of contents, and one folder a member.
//!
//! A chain owns its part of the state and answers every question about it: how many coordinates there are and what they are
//! called, where its rollers and plates are, what a force on a roller does, what it stores and loses, how stiff it is, how it is
//! laid. Coordinates are counted from the chain's own first one, and states come as the chain's own part. A chain may look at the
//! bodies that it touches, never at the system. Nobody outside this folder asks which member it is.

pub(crate) mod chain;
mod held_end;
mod laid;
pub(crate) mod links;
pub(crate) mod model;
pub(crate) mod particles;
pub(crate) mod points;

use std::ops::Range;

use chaindrive_contact::Prepared;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, Registers, Weights};
use serde::{Deserialize, Serialize};

use held_end::held_ends;
pub(crate) use laid::LaidAs;
pub use links::inside::{Contact, Inside, Joints};
use links::{Impulses, JointState, Linkage};
use model::ChainModel;
use particles::{Particles, Turning};
use points::Points;

use crate::bodies::{BodyContacts, GroupBodies, Surroundings};
use crate::contact::{Begun, ContactState, Frame, PlateContact, Touch, Wrench};
use crate::energy::Energy;
use crate::joints::{self, Resistance};
use crate::seam::{Load, Loads, Moving, Observation, Pose, Rates, Sum, Unknown};
use crate::{End, MemoryError};

/// A chain ready to move.
#[derive(Clone, Debug)]
pub(crate) enum Chain {
    /// Point masses at the rollers.
    Particles(Box<Particles>),
    /// Point masses at rollers, bushes and pins.
    Points(Box<Points>),
    /// Rigid links.
    Links(Box<Linkage>),
}

/// Memory of a chain beside its contacts with bodies.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum ChainMemory {
    /// The friction of its joints, if there is any.
    Particles(Option<joints::Stick>),
    /// The contacts in its joints, and their friction.
    Points(Box<points::Memory>, Option<joints::Stick>),
    /// The contacts in its joints, and the friction of those without clearance.
    Links(Box<links::Memory>, Option<joints::Stick>),
}

/// Contact states, and the work space of the member.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) loads: Loads,
    /// What joints leave behind; empty where links are springs.
    joint_state: JointState,
    #[serde(skip)]
    impulses: Impulses,
    /// Findings in joints that are points; empty elsewhere.
    points: points::Found,
    /// What resists in the joints; empty where nothing does.
    resistance: Resistance,
    /// How the links of particles turn, where something resists that.
    #[serde(skip)]
    turning: Turning,
}

impl Record {
    /// Room for every evaluation of a chain with these contacts.
    pub(crate) fn new(contacts: &BodyContacts) -> Self {
        let (wheels, rails) = (contacts.teeth.len(), contacts.rails.len());
        let touches = |count: usize| vec![Box::<Touch>::default(); count];
        Self {
            loads: Loads {
                teeth: touches(wheels),
                rails: touches(rails),
                wheel_wrenches: vec![Wrench::default(); wheels],
                rail_wrenches: vec![Wrench::default(); rails],
                frames: vec![Frame::fixed(); wheels + rails],
                ways: vec![None; wheels + rails],
            },
            ..Self::default()
        }
    }

    /// How contacts began: depth \[m\], and the share of the step after which they did.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = (f64, f64)> {
        let Loads {
            wheel_wrenches,
            rail_wrenches,
            ..
        } = &self.loads;
        let joints = self.joint_state.tallies.iter().chain(&self.points.tallies);
        let wrenches = wheel_wrenches.iter().chain(rail_wrenches);
        wrenches
            .map(|wrench| (wrench.first_depth, wrench.first_share))
            .chain(joints.map(|tally| (tally.first_depth, tally.first_share)))
    }

    /// Contacts that began in the joints, and their depths: pins in bushes, bushes in rollers.
    pub(crate) fn joints(&self) -> [(Begun, f64); 2] {
        // A chain has links or points.
        let [links, points] = [&self.joint_state.tallies, &self.points.tallies];
        [0, 1].map(|k| {
            let begun = links[k].begun.and(points[k].begun);
            (begun, links[k].depth.max(points[k].depth))
        })
    }
}

/// Asks the member, whichever it is.
macro_rules! ask {
    ($chain:expr, $member:ident => $answer:expr) => {
        match $chain {
            Chain::Particles($member) => $answer,
            Chain::Points($member) => $answer,
            Chain::Links($member) => $answer,
        }
    };
}

/// How it comes to be.
impl Chain {
    /// Every chain is laid and settled as particles first; returns its coordinates too.
    pub(crate) fn laid(chain: &crate::Chain, places: &[Point]) -> (Self, Vec<f64>) {
        let (particles, q) = Particles::lay(chain, places);
        (Self::Particles(Box::new(particles)), q)
    }

    /// What a chain is made of, in the place of the particles that it was laid as; `at` is the whole state, with the particles at
    /// `entries`. None where it is made of particles.
    pub(crate) fn put_in_place(
        &self,
        entries: Range<usize>,
        bodies: GroupBodies<'_>,
        laid: &LaidAs<'_>,
        at: Moment<'_>,
    ) -> Option<(Self, [Vec<f64>; 2])> {
        let Self::Particles(particles) = self else {
            return None;
        };
        match &laid.chain.model {
            ChainModel::Particles => None,
            ChainModel::Points(joints) => {
                let own = Moment {
                    t: at.t,
                    q: &at.q[entries.clone()],
                    v: &at.v[entries],
                    z: &[],
                };
                let (points, state) = Points::replace(particles, laid, joints, own);
                Some((Self::Points(Box::new(points)), state))
            }
            ChainModel::Rigid(links) => {
                let replacement =
                    links::build::replace(particles, entries, bodies, laid, links, at);
                let chain = Self::Links(Box::new(replacement.linkage));
                Some((chain, [replacement.q, replacement.v]))
            }
        }
    }

    /// Brings velocities of the chain and, behind it, the bodies to where no joint opens.
    pub(crate) fn close_in_motion(
        &self,
        begin: f64,
        bodies: GroupBodies<'_>,
        q: &[f64],
        v: &mut [f64],
    ) {
        match self {
            Self::Particles(_) | Self::Points(_) => {}
            Self::Links(chain) => chain.close_in_motion(begin, bodies, q, v),
        }
    }

    /// Gives rollers at these places these velocities.
    pub(crate) fn set_off(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        ask!(self, chain => chain.set_off(places, velocities, v));
    }
}

/// Its model.
impl Chain {
    /// Number of coordinates.
    pub(crate) fn coordinates(&self) -> usize {
        ask!(self, chain => chain.coordinates())
    }

    /// Number of coordinates that can move.
    pub(crate) fn free_coordinates(&self) -> usize {
        ask!(self, chain => chain.free_coordinates())
    }

    /// Description of a coordinate, in words.
    pub(crate) fn name(&self, coordinate: usize) -> String {
        ask!(self, chain => chain.name(coordinate))
    }

    /// Mass or inertia that goes with every coordinate \[kg or kg m²\].
    pub(crate) fn inertias(&self) -> Vec<f64> {
        ask!(self, chain => chain.inertias())
    }

    pub(crate) fn rollers(&self) -> usize {
        ask!(self, chain => chain.rollers())
    }

    pub(crate) fn links(&self) -> usize {
        ask!(self, chain => chain.links())
    }

    /// Joints that have a state of their own: none where links are springs.
    pub(crate) fn joints(&self) -> usize {
        match self {
            Self::Particles(_) => 0,
            Self::Points(chain) => chain.joints(),
            Self::Links(chain) => chain.joints(),
        }
    }

    /// Laws of pins in bushes with clearance, and of bushes in free rollers.
    pub(crate) fn bearing_laws(&self) -> [Option<Prepared>; 2] {
        match self {
            Self::Particles(_) => [None, None],
            Self::Points(chain) => chain.bearing_laws(),
            Self::Links(chain) => chain.bearing_laws(),
        }
    }

    /// Nominal pitch \[m\].
    pub(crate) fn pitch(&self) -> f64 {
        ask!(self, chain => chain.pitch())
    }

    /// Length of the chain without load, in nominal pitches a link.
    pub(crate) fn elongation(&self) -> f64 {
        ask!(self, chain => chain.elongation())
    }
}

/// How it moves.
impl Chain {
    /// Where the rollers are.
    pub(crate) fn pose<'a>(&self, at: Moment<'a>, record: &'a mut Record) -> Pose<'a> {
        ask!(self, chain => chain.pose(at, record))
    }

    /// Accelerations of the chain, its powers, and what the bodies feel of it.
    ///
    /// The frames of the contacts stand in the record; powers are added to those of others.
    pub(crate) fn evaluate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        ask!(self, chain => chain.evaluate(around, at, a, rates, record));
    }

    /// Says when the memory of joints and free rollers is of.
    pub(crate) fn set_clock(&mut self, t: f64) {
        let resisting = match self {
            Self::Particles(chain) => chain.joints.as_mut(),
            Self::Points(chain) => {
                chain.memory.time = t;
                chain.joints.as_mut()
            }
            Self::Links(chain) => {
                chain.memory.time = t;
                chain.resisting.as_mut()
            }
        };
        if let Some(joints) = resisting {
            joints.set_clock(t);
        }
    }

    /// Takes an accepted state: memory, and places that are given in time.
    pub(crate) fn commit(&mut self, t: f64, q: &mut [f64], v: &mut [f64], record: &mut Record) {
        ask!(self, chain => chain.commit(t, q, v, record));
    }

    /// ω² and damping rate D of the stiffest mode, bodies by themselves left out.
    pub(crate) fn rates(&self, around: Surroundings<'_>, record: &mut Record) -> Rates {
        match self {
            Self::Particles(chain) => chain.rates(around, record),
            Self::Points(chain) => Rates::of(chain.rates(around, record)),
            Self::Links(chain) => chain.rates(around, record),
        }
    }

    /// Frequency \[1/s\] of what every method takes explicitly, beside the mode above.
    pub(crate) fn stabilisation(&self) -> f64 {
        match self {
            Self::Particles(_) | Self::Points(_) => 0.0,
            Self::Links(chain) => chain.stabilisation(),
        }
    }

    /// Whether contacts are to write down the faces that rollers press on.
    pub(crate) fn wants_faces(&self) -> bool {
        self.can_solve()
    }

    /// Whether [`solve`](Self::solve) is there.
    pub(crate) fn can_solve(&self) -> bool {
        match self {
            Self::Particles(_) => false,
            Self::Points(_) | Self::Links(_) => true,
        }
    }

    /// Whether damping is so stiff in it that a method had better take it implicitly: contacts in joints are, springs between
    /// rollers are not.
    pub(crate) fn prefers_implicit_damping(&self) -> bool {
        match self {
            Self::Particles(_) => false,
            Self::Points(_) | Self::Links(_) => true,
        }
    }

    /// x ← (M + c C + k K)⁻¹ M x over the chain and, behind it, the bodies of its group.
    pub(crate) fn solve(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        record: &mut Record,
        x: &mut [f64],
    ) -> bool {
        match self {
            Self::Particles(_) => false,
            Self::Points(chain) => chain.solve(bodies, weights, record, x),
            Self::Links(chain) => chain.solve(bodies, weights, record, x),
        }
    }

    /// Computes on other registers from now on.
    pub(crate) fn compute_on(&mut self, registers: Registers) {
        match self {
            Self::Particles(chain) => chain.registers = registers,
            Self::Points(chain) => chain.registers = registers,
            Self::Links(chain) => chain.registers = registers,
        }
    }

    /// Moves every roller or body along x and y by what `shift` says.
    pub(crate) fn nudge(&self, q: &mut [f64], shift: impl FnMut() -> f64) {
        ask!(self, chain => chain.nudge(q, shift));
    }
}

/// Its memory.
impl Chain {
    /// See [`System::memory`](crate::System::memory).
    pub(crate) fn memory(&self) -> ChainMemory {
        let stick = |joints: Option<&joints::Joints>| joints.map(|joints| joints.memory.clone());
        match self {
            Self::Particles(chain) => ChainMemory::Particles(stick(chain.joints.as_ref())),
            Self::Points(chain) => {
                let memory = Box::new(chain.memory.clone());
                ChainMemory::Points(memory, stick(chain.joints.as_ref()))
            }
            Self::Links(chain) => {
                let memory = Box::new(chain.memory.clone());
                ChainMemory::Links(memory, stick(chain.resisting.as_ref()))
            }
        }
    }

    /// See [`System::remember`](crate::System::remember).
    pub(crate) fn remember(&mut self, memory: ChainMemory) -> Result<(), MemoryError> {
        match (self, memory) {
            (Self::Particles(chain), ChainMemory::Particles(memory)) => {
                joints::remember(chain.joints.as_mut(), memory)
            }
            (Self::Points(chain), ChainMemory::Points(memory, stick)) => {
                joints::remember(chain.joints.as_mut(), stick)?;
                chain.remember(*memory)
            }
            (Self::Links(chain), ChainMemory::Links(memory, stick)) => {
                joints::remember(chain.resisting.as_mut(), stick)?;
                chain.remember(*memory)
            }
            (Self::Particles(_) | Self::Points(_) | Self::Links(_), _) => Err(MemoryError::Model),
        }
    }
}

/// Quantities that can be read off it.
impl Chain {
    /// Appends what belongs to the chain.
    pub(crate) fn observe(&self, at: Moment<'_>, record: &Record, out: &mut Observation) {
        ask!(self, chain => chain.observe(at, record, out));
    }

    /// Appends forces of joints, and tensions of links, as a record has them.
    pub(crate) fn observe_forces(&self, at: Moment<'_>, record: &Record, out: &mut Observation) {
        ask!(self, chain => chain.observe_forces(at, record, out));
    }

    /// Whether the tension of its links follows from the places of their ends.
    pub(crate) fn has_springs(&self) -> bool {
        !matches!(self, Self::Links(_))
    }

    /// Adds kinetic energy, weight, and what links or joints store.
    pub(crate) fn energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        record: &Record,
        out: &mut Energy,
    ) {
        ask!(self, chain => chain.energies(at, gravity, record, out));
    }

    /// What the contacts of link plates with a guide store \[J\].
    pub(crate) fn plate_energy(
        &self,
        at: Moment<'_>,
        plates: &PlateContact,
        frame: &Frame,
        record: &Record,
    ) -> f64 {
        ask!(self, chain => chain.plate_energy(at, plates, frame, record))
    }

    /// How a pin stands to its bush, and a bush to its roller, where they have play.
    pub(crate) fn contacts_of(&self, joint: usize) -> [Option<ContactState>; 2] {
        match self {
            Self::Particles(_) => [None; 2],
            Self::Points(chain) => chain.contacts_of(joint),
            Self::Links(chain) => chain.contacts_of(joint),
        }
    }
}

/// How joints find their places after the chain was laid.
impl Chain {
    /// Whether they must: those with play lie somewhere in their bushes.
    pub(crate) fn has_play(&self) -> bool {
        match self {
            Self::Particles(_) | Self::Points(_) => false,
            Self::Links(chain) => chain.has_play(),
        }
    }

    /// Makes every link longer by `change` \[m\].
    pub(crate) fn lengthen(&mut self, change: f64) {
        ask!(self, chain => chain.lengthen(change));
    }

    /// Lets driven ends stand still.
    pub(crate) fn hold_still(&mut self) {
        ask!(self, chain => chain.hold_still());
    }

    /// Tension of every link \[N\].
    pub(crate) fn tensions(&self, at: Moment<'_>, record: &Record) -> Vec<f64> {
        ask!(self, chain => chain.tensions(at, record))
    }

    /// Largest force out of balance that accelerates a roller or body \[N\].
    pub(crate) fn imbalance(&self, a: &[f64]) -> f64 {
        ask!(self, chain => chain.imbalance(a))
    }

    /// Largest force in a link or contact \[N\].
    pub(crate) fn pressed(&self, at: Moment<'_>, record: &Record) -> f64 {
        ask!(self, chain => chain.pressed(at, record))
    }

    /// Share of a step that moves nothing too far.
    pub(crate) fn reach(&self, step: &[f64]) -> f64 {
        ask!(self, chain => chain.reach(step))
    }
}

/// Equilibrium: forces and their derivatives.
impl Chain {
    /// Coordinates that are unknown in equilibrium, in an order that keeps neighbours together.
    pub(crate) fn unknowns(&self) -> Vec<Unknown> {
        ask!(self, chain => chain.unknowns())
    }

    /// How the circle that runs on the teeth moves with the coordinates.
    pub(crate) fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        ask!(self, chain => chain.roller_moving(q, roller))
    }

    /// How the first (0) or second (1) pin of a link moves with the coordinates.
    pub(crate) fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        ask!(self, chain => chain.pin_moving(q, link, end))
    }

    /// Stiffness of the stiffest link or joint \[N/m\].
    pub(crate) fn stiffest_spring(&self) -> f64 {
        ask!(self, chain => chain.stiffest_spring())
    }

    /// Mass of the chain, and of its heaviest roller or body \[kg\].
    pub(crate) fn weights(&self) -> [f64; 2] {
        ask!(self, chain => chain.weights())
    }

    /// Whether something pulls at an end.
    pub(crate) fn is_pulled(&self) -> bool {
        let ends = ask!(self, chain => &chain.ends);
        ends.iter()
            .any(|held| matches!(held.end, End::Pulled { .. }))
    }

    /// Time \[s\] of the first knot of an end's motion after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        let ends = ask!(self, chain => &chain.ends);
        let knots = ends.iter().filter_map(|held| match &held.end {
            End::Driven { x, y } => x
                .next_knot(t)
                .into_iter()
                .chain(y.next_knot(t))
                .reduce(f64::min),
            End::Free | End::Fixed | End::Pulled { .. } => None,
        });
        knots.reduce(f64::min)
    }

    /// Gives copies of coordinates the values of their originals.
    pub(crate) fn copy_ghosts(&self, values: &mut [f64]) {
        match self {
            Self::Particles(chain) => chain.copy_ghosts(values),
            Self::Points(chain) => chain.copy_ghosts(values),
            Self::Links(_) => {}
        }
    }

    /// Adds the energy of links or joints, weight, and forces at the ends.
    pub(crate) fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>) {
        ask!(self, chain => chain.add_balance(q, gravity, load, sum));
    }

    /// Visits the joints that no energy but a condition holds together: the pin and its hole, where they move.
    pub(crate) fn each_hinge(&self, q: &[f64], visit: impl FnMut([Moving; 2])) {
        match self {
            Self::Particles(_) | Self::Points(_) => {}
            Self::Links(chain) => chain.each_hinge(q, visit),
        }
    }
}
