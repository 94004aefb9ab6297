//! Chains as a family: this table of contents, and one folder a member.
//!
//! A chain owns its part of the state and answers every question about it ([`Makeup`], [`Statics`]): how many coordinates there are
//! and what they are called, where its rollers and plates are, what a force on a roller does, what it stores and loses, how stiff it
//! is, how it is laid. Coordinates are counted from the chain's own first one, and states come as the chain's own part. A chain may
//! look at the bodies that it touches, never at the system. Nobody outside this folder asks which member it is.

mod as_laid;
pub(crate) mod chain;
mod kernel;
pub(crate) mod links;
mod makeup;
pub(crate) mod model;
pub(crate) mod particles;
pub(crate) mod points;
mod series;
mod strand_ends;
pub(crate) mod strands;

use std::ops::Range;

use chaindrive_contact::PreparedLaw;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, Registers, Weights};
use serde::{Deserialize, Serialize};

pub(crate) use as_laid::ChainAsLaid;
use links::Linkage;
pub use links::test_access::{Contact, Inside, Joints};
use makeup::{Makeup, Statics};
use model::ChainModel;
use particles::Particles;
use points::Points;
use series::Series;
use strands::Strands;

use crate::MemoryError;
use crate::bodies::{BodyContacts, GroupBodies, Surroundings};
use crate::contact::{ContactState, Frame, Onsets, PlateContact, Touch, Wrench};
use crate::energy::Energy;
use crate::joints::{self, JointFindings, JointMemory, Stick};
use crate::seam::{Carried, Load, Loads, Moving, Observation, Pose, Rates, Sum, Unknown};

/// A chain ready to move.
#[derive(Clone, Debug)]
pub(crate) enum Chain {
    /// Point masses at the rollers.
    Particles(Box<Particles>),
    /// Point masses at rollers, bushes and pins.
    Points(Box<Points>),
    /// Rigid links.
    Links(Box<Linkage>),
    /// Strands side by side.
    Strands(Box<Strands>),
}

/// Memory of a chain beside its contacts with bodies: contacts in its joints, and the friction that resists beside them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ChainMemory {
    joints: JointMemory,
    stick: Option<Stick>,
}

/// Contact states, and the work space of every member; empty but for the one that the chain is.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) loads: Loads,
    particles: particles::Work,
    points: points::Work,
    links: links::Work,
    strands: strands::Work,
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

    /// What the equations of the step that was solved last added to the forces; nothing where steps add nothing.
    pub(crate) fn carried(&self) -> &Carried {
        &self.links.joint_state.carried
    }

    /// Contacts found in the joints of links and of points.
    fn findings(&self) -> [&JointFindings; 2] {
        [&self.links.joints, &self.points.joints]
    }

    /// Onsets of contacts: depth \[m\], and the share of the step after which each began.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = (f64, f64)> {
        let Loads {
            wheel_wrenches,
            rail_wrenches,
            ..
        } = &self.loads;
        let joints = self.findings().into_iter().flat_map(|it| &it.tallies);
        let wrenches = wheel_wrenches.iter().chain(rail_wrenches);
        wrenches
            .map(|wrench| (wrench.first_depth, wrench.first_share))
            .chain(joints.map(|tally| (tally.first_depth, tally.first_share)))
    }

    /// Contacts that began in the joints, and their depths: pins in bushes, bushes in rollers.
    pub(crate) fn joints(&self) -> [(Onsets, f64); 2] {
        // A chain has links or points.
        let [links, points] = self.findings().map(|it| &it.tallies);
        [0, 1].map(|k| {
            let begun = links[k].begun.and(points[k].begun);
            (begun, links[k].depth.max(points[k].depth))
        })
    }
}

/// Asks the member, whichever it is; with a record, for its own work there.
macro_rules! ask {
    ($chain:expr, $member:ident => $answer:expr) => {
        match $chain {
            Chain::Particles($member) => $answer,
            Chain::Points($member) => $answer,
            Chain::Links($member) => $answer,
            Chain::Strands($member) => $answer,
        }
    };
    ($chain:expr, $record:expr, ($member:ident, $work:ident) => $answer:expr) => {
        match ($chain, $record) {
            (
                Chain::Particles($member),
                Record {
                    particles: $work, ..
                },
            ) => $answer,
            (Chain::Points($member), Record { points: $work, .. }) => $answer,
            (Chain::Links($member), Record { links: $work, .. }) => $answer,
            (Chain::Strands($member), Record { strands: $work, .. }) => $answer,
        }
    };
}

/// Hands questions of [`Makeup`] and [`Statics`] on to the member.
macro_rules! hand_on {
    ($(fn $name:ident(&self $(, $arg:ident: $kind:ty)*) $(-> $answer:ty)?;)*) => {
        $(pub(crate) fn $name(&self $(, $arg: $kind)*) $(-> $answer)? {
            ask!(self, chain => chain.$name($($arg),*))
        })*
    };
}

/// Hands questions on that the member answers from what an evaluation left in a record.
macro_rules! hand_on_with_record {
    ($(fn $name:ident(&self, $at:ident: $moment:ty, $record:ident $(, $arg:ident: $kind:ty)*) $(-> $answer:ty)?;)*) => {
        $(pub(crate) fn $name(&self, $at: $moment, $record: &Record $(, $arg: $kind)*) $(-> $answer)? {
            ask!(self, $record, (chain, work) => chain.$name($at, work $(, $arg)*))
        })*
    };
}

/// Construction.
impl Chain {
    /// A chain as it is laid and settled, and its coordinates: of particles, or of strands, whose joints are particles too.
    pub(crate) fn laid(chain: &crate::Chain, places: &[Point]) -> (Self, Vec<f64>) {
        let (particles, q) = Particles::lay(chain, places);
        let laid = match &chain.model {
            ChainModel::Strands(model) => {
                let radius = 0.5 * chain.roller_diameter;
                Self::Strands(Box::new(Strands::new(particles, model, radius)))
            }
            ChainModel::Particles | ChainModel::Points(_) | ChainModel::Rigid(_) => {
                Self::Particles(Box::new(particles))
            }
        };
        (laid, q)
    }

    /// The chain of its own model, in place of the particles that it was laid as; `at` is the whole state, with the particles at `entries`.
    /// None for a chain of particles.
    pub(crate) fn put_in_place(
        &self,
        entries: Range<usize>,
        bodies: GroupBodies<'_>,
        laid: &ChainAsLaid<'_>,
        at: Moment<'_>,
    ) -> Option<(Self, [Vec<f64>; 2])> {
        let Self::Particles(particles) = self else {
            return None;
        };
        match &laid.chain.model {
            ChainModel::Particles | ChainModel::Strands(_) => None,
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
}

/// The row of its links, whatever they are made of.
impl Chain {
    fn series(&self) -> &Series {
        ask!(self, chain => chain.series())
    }

    fn series_mut(&mut self) -> &mut Series {
        ask!(self, chain => chain.series_mut())
    }

    pub(crate) fn rollers(&self) -> usize {
        self.series().rollers
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.series().is_closed()
    }

    pub(crate) fn links(&self) -> usize {
        self.series().links
    }

    /// Nominal pitch \[m\].
    pub(crate) fn pitch(&self) -> f64 {
        self.series().pitch
    }

    /// Whether something pulls at an end.
    pub(crate) fn is_pulled(&self) -> bool {
        self.series().is_pulled()
    }

    /// Time \[s\] of the first knot of an end's motion after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        self.series().next_knot(t)
    }

    /// Lets driven ends stand still.
    pub(crate) fn hold_still(&mut self) {
        self.series_mut().hold_still();
    }

    /// Says when the memory of joints and free rollers is of.
    pub(crate) fn set_clock(&mut self, t: f64) {
        self.series_mut().set_clock(t);
    }

    /// Says how much the plates at every joint rub sideways, over the normal force \[m\].
    pub(crate) fn press_sideways(&mut self, of: impl Fn(usize) -> f64) {
        if let Some(joints) = &mut self.series_mut().joints {
            joints.press_sideways(of);
        }
    }

    /// Computes on other registers from now on.
    pub(crate) fn compute_on(&mut self, registers: Registers) {
        self.series_mut().registers = registers;
    }

    /// Contacts of a joint with clearance: pin in bush, and bush in roller.
    pub(crate) fn contacts_of(&self, joint: usize) -> [Option<ContactState>; 2] {
        let JointMemory { pins, bushes, .. } = &self.series().memory;
        [pins, bushes].map(|memory| (memory.len() > 0).then(|| memory.at(joint)))
    }

    /// See [`System::memory`](crate::System::memory).
    pub(crate) fn memory(&self) -> ChainMemory {
        let Series { joints, memory, .. } = self.series();
        ChainMemory {
            joints: memory.clone(),
            stick: joints.as_ref().map(|joints| joints.memory.clone()),
        }
    }

    /// See [`System::remember`](crate::System::remember).
    pub(crate) fn remember(&mut self, remembered: ChainMemory) -> Result<(), MemoryError> {
        let Series { joints, memory, .. } = self.series_mut();
        joints::remember(joints.as_mut(), remembered.stick)?;
        memory.remember(remembered.joints)
    }
}

/// Its model.
impl Chain {
    hand_on! {
        fn coordinates(&self) -> usize;
        fn name(&self, coordinate: usize) -> String;
        fn inertias(&self) -> Vec<f64>;
        fn joints(&self) -> usize;
        fn bearing_laws(&self) -> [Option<PreparedLaw>; 2];
        fn has_springs(&self) -> bool;
        fn strands(&self) -> usize;
        fn elongation(&self) -> f64;
    }

    /// Number of coordinates that can move.
    pub(crate) fn free_coordinates(&self) -> usize {
        self.unknowns().len()
    }

    /// Makes every link longer by `change` \[m\].
    pub(crate) fn lengthen(&mut self, change: f64) {
        ask!(self, chain => chain.lengthen(change));
    }
}

/// Motion.
impl Chain {
    hand_on! {
        fn set_off(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]);
        fn close_in_motion(&self, begin: f64, bodies: GroupBodies<'_>, q: &[f64], v: &mut [f64]);
        fn nudge(&self, q: &mut [f64], shift: impl FnMut() -> f64);
        fn stabilisation(&self) -> f64;
        fn damps_stiffly(&self, touches: bool) -> bool;
        fn has_reactions(&self) -> bool;
    }

    /// Pose of the rollers.
    pub(crate) fn pose<'a>(&self, at: Moment<'a>, record: &'a mut Record) -> Pose<'a> {
        ask!(self, record, (chain, work) => chain.pose(at, work))
    }

    /// Accelerations of the chain, its powers, and what the bodies feel of it.
    pub(crate) fn evaluate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Record,
    ) {
        match self {
            Self::Particles(chain) => {
                let Record {
                    loads, particles, ..
                } = record;
                chain.evaluate(around, at, a, rates, loads, particles);
            }
            Self::Points(chain) => {
                let Record { loads, points, .. } = record;
                chain.evaluate(around, at, a, rates, loads, points);
            }
            Self::Links(chain) => {
                let Record { loads, links, .. } = record;
                chain.evaluate(around, at, a, rates, loads, links);
            }
            Self::Strands(chain) => {
                let Record { loads, strands, .. } = record;
                chain.evaluate(around, at, a, rates, loads, strands);
            }
        }
    }

    /// Takes an accepted state: memory, and places that are given in time.
    pub(crate) fn commit(&mut self, t: f64, q: &mut [f64], v: &mut [f64], record: &mut Record) {
        ask!(self, record, (chain, work) => {
            let Series { joints, memory, .. } = chain.series_mut();
            memory.commit(joints.as_mut(), &mut work.joints);
            chain.drive_ends(t, q, v);
        });
    }

    /// ω² and damping rate D of the stiffest mode, bodies by themselves left out.
    pub(crate) fn rates(&self, around: Surroundings<'_>, record: &mut Record) -> Rates {
        match self {
            Self::Particles(chain) => chain.rates(around, &record.loads, &mut record.particles),
            Self::Points(chain) => chain.rates(around, &record.loads, &mut record.points),
            Self::Links(chain) => chain.rates(around, &record.loads, &mut record.links),
            Self::Strands(chain) => chain.rates(around, &record.loads, &mut record.strands),
        }
    }

    /// See [`Makeup::READS_FACES`].
    pub(crate) fn reads_faces(&self) -> bool {
        match self {
            Self::Particles(_) => Particles::READS_FACES,
            Self::Points(_) => Points::READS_FACES,
            Self::Links(_) => Linkage::READS_FACES,
            Self::Strands(_) => Strands::READS_FACES,
        }
    }

    /// Whether [`solve`](Self::solve) knows the equations of an implicit step.
    pub(crate) fn can_solve(&self) -> bool {
        match self {
            Self::Particles(_) => Particles::SOLVES,
            Self::Points(_) => Points::SOLVES,
            Self::Links(_) => Linkage::SOLVES,
            Self::Strands(_) => Strands::SOLVES,
        }
    }

    /// x ← (M + c C + k K)⁻¹ M x over the chain and, after it, the bodies of its group.
    pub(crate) fn solve(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        record: &mut Record,
        x: &mut [f64],
    ) -> bool {
        ask!(self, record, (chain, work) => chain.solve(bodies, weights, work, x))
    }
}

/// Quantities that can be read off it.
impl Chain {
    hand_on_with_record! {
        fn tensions(&self, at: Moment<'_>, record, out: &mut Vec<f64>);
        fn tensions_of_step(&self, at: Moment<'_>, record, out: &mut Vec<f64>) -> [f64; 2];
        fn pressed(&self, at: Moment<'_>, record) -> f64;
        fn observe(&self, at: Moment<'_>, record, out: &mut Observation);
        fn observe_forces(&self, at: Moment<'_>, record, out: &mut Observation);
    }

    /// See [`Makeup::show_reactions`].
    pub(crate) fn show_reactions(&self, at: Moment<'_>, record: &mut Record) {
        ask!(self, record, (chain, work) => chain.show_reactions(at, work));
    }

    /// Adds kinetic energy, weight, and what links or joints store.
    pub(crate) fn energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        record: &Record,
        out: &mut Energy,
    ) {
        ask!(self, record, (chain, work) => chain.energies(at, gravity, work, out));
    }

    /// Energy stored in the contacts of link plates with a guide \[J\].
    pub(crate) fn plate_energy(
        &self,
        at: Moment<'_>,
        found: (&PlateContact, &Touch),
        frame: &Frame,
        record: &Record,
    ) -> f64 {
        ask!(self, record, (chain, work) => chain.plate_energy(at, found, frame, work))
    }
}

/// Statics.
impl Chain {
    hand_on! {
        fn unknowns(&self) -> Vec<Unknown>;
        fn roller_moving(&self, q: &[f64], roller: usize) -> Moving;
        fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving;
        fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>);
        fn each_hinge(&self, q: &[f64], visit: impl FnMut([Moving; 2]));
        fn stiffest_spring(&self) -> f64;
        fn weights(&self) -> [f64; 2];
        fn imbalance(&self, a: &[f64]) -> f64;
        fn reach(&self, step: &[f64]) -> f64;
        fn copy_ghosts(&self, values: &mut [f64]);
        fn has_play(&self) -> bool;
    }
}
