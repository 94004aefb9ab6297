//! From a valid drive to one that is ready to move: lay the chain, settle it, set it going.
//!
//! # Pretension
//!
//! A closed chain is to carry the pretension T₀ in every link, before gravity and load. Where links alone stretch, geometry says how long they
//! are for that. Where teeth or joints yield instead it does not, and the length is searched for. Three places have to do with it:
//!
//! ```text
//! Drive::assemble ── each group ──┬─ all links stretch ─► assemble_as_is
//!                                 └─ rigid links ───────► assemble_hard (2) ─► assemble_as_is, up to 20 times
//!
//! assemble_as_is: layout::lay (1) ─► newton::settle ─► put_in_place ── pins with play ─► pseudo_transient::settle ─► tighten (3)
//! ```
//!
//! 1. `layout::lay` shortens all links by the strain of T₀, or moves the adjusted body on until the closing has that strain:
//!
//!    ```text
//!    Σ ℓ₀ = n p (1 + ε) − T₀ Σ 1/k     ε: strain that closes links of the pitch around the polygons
//!    ```
//!
//!    ε and the travel are those of the phase at the start, or means over 8 phases of a tooth. The travel is searched for by
//!    `close_by_motion`. `newton::settle` finds the equilibrium of the chain with its masses lumped at the rollers, first under the
//!    pretension alone, in at most 300 iterations of Newton's method, and then under gravity and load. It keeps the lengths: what teeth yield
//!    is missing of T₀.
//! 2. `rigid_links::assemble_hard`: rigid links owe their tension to the teeth alone, which yield by another law and not all alike. They are laid as links a
//!    thousand times as stiff as teeth. The secant method finds the tension to be given to `lay` for which links carry T₀ in the mean
//!    at the end of the first stage of `newton::settle`, to 1 ‰: at most 20 assemblies.
//! 3. `pseudo_transient::tighten`: pins with play do not lie where the lumped chain has its joints, but where they are pressed to in their bushes.
//!    Without gravity and load all links are made longer or shorter until they carry T₀ in the mean, to 1 ‰: in growing strides while the
//!    chain is slack, then by the secant in a bracket, in at most 60 relaxations of at most 6000 iterations. A chain that carries T₀ in the mean over a
//!    tooth keeps the length with which it was laid, and only its joints find their places: one relaxation. Two kinds of chain are to carry what the
//!    lumped one carried in the first stage of `newton::settle`, not T₀: one with free rollers, if T₀ is that in the mean over a tooth, and
//!    one whose frame has grown since it was fitted. Gravity and load follow.

mod free_trains;
mod independent_groups;
mod layout;
mod newton;
mod overload;
mod overrun;
mod pseudo_transient;
mod pushes_away;
mod rearranging;
mod remedies;
mod rigid_links;
mod slack;
mod start_time;
mod start_velocities;
mod unclosed_chains;
mod wheels;
mod worn;

use std::f64::consts::TAU;

use chaindrive_geometry::{ArcSpline, Point, Wheel};
use chaindrive_integrate::{Moment, SecondOrderSystem, State};

use crate::body_positions::BodyPositions;
use crate::chains::ChainAsLaid;
use crate::check::clash::{clashes, fixed_in_teeth};
use crate::drive::{Layout, Parts, PretensionAt};
use crate::groups::groups;
use crate::system::{LaidDrive, Member};
use crate::{AssemblyError, Clash, Drive, Motion, System};
use crate::{MemoryError, SystemMemory};
use pseudo_transient::Tightening;

pub use free_trains::FreeTrain;
pub use newton::Statics;
pub(crate) use newton::{Curvature, curvature};
pub use slack::Sag;
pub use unclosed_chains::Gap;

/// An assembled drive at the start of its run, with positions and velocities.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The drive that was assembled.
    pub drive: Drive,
    /// The compiled drive.
    pub system: System,
    /// Time \[s\] at which it stands so: the drive's [begin](Drive::begin), or when it has [come](Assembled::come_to) to later.
    pub time: f64,
    /// Time \[s\] on the clock of the drive at which a record of it begins: its t = 0.
    pub zero: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// First-order states: those of pushes with one, in the order of the tensioners.
    pub z: Vec<f64>,
    /// Static states on the way, when the drive was settled: after pretension, gravity and load.
    pub statics: Vec<Statics>,
    /// Fitting of every chain that runs around sprockets.
    pub fittings: Vec<Option<Fitting>>,
    /// Bodies that take the same room in the plane, and are in each other's way unless they pass side by side; and guides too short
    /// for the chain that they turn.
    pub warnings: Vec<Clash>,
    /// The parts as they were laid.
    pub(crate) parts: Parts,
}

/// Fitting of a closed chain to its sprockets: links on each stop and span, and the strain that is left.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// Pitches seated on each stop of the route.
    pub seated: Vec<u32>,
    /// Pitches in the span after each stop.
    pub spans: Vec<u32>,
    /// Strain of the links as laid \[–\], negative where a slack span sags instead.
    pub strain: f64,
    /// Travel of the adjusted body \[m, or rad\].
    pub travel: f64,
    /// The stops as wheels, where they stand.
    pub wheels: Vec<Wheel>,
}

/// Rollers of a chain as laid, before any force acts.
#[derive(Clone, Debug, PartialEq)]
pub struct RollerLayout {
    /// Roller positions \[m\], (rollers,).
    pub positions: Vec<Point>,
    /// Fitting of the chain, where it runs around sprockets.
    pub fitting: Option<Fitting>,
}

impl Assembled {
    /// State at the start of a run.
    pub fn state(&self) -> State {
        State::new(self.time, self.q.clone(), self.v.clone()).with_states(self.z.clone())
    }
}

impl Assembled {
    /// Mean angular speed of every sprocket \[rad/s\], counter-clockwise positive, in the order of [`System::sprocket_names`].
    ///
    /// It is the speed of the motion that drives it, through chains, gears and couplings, without its sine terms; without such a
    /// motion, the present speed.
    pub fn mean_speeds(&self) -> Vec<f64> {
        let at = self.start();
        let shafts = self.shaft_speeds();
        let wheels = self.system.bodies.wheels.iter();
        wheels
            .map(|it| shafts[it.shaft].unwrap_or_else(|| it.kinematics(at.t, at.q, at.v).rate))
            .collect()
    }

    /// Mean angular speeds of the shafts \[rad/s\] that a motion drives, in the order of the drive.
    pub(crate) fn shaft_speeds(&self) -> Vec<Option<f64>> {
        let layouts: Vec<&Layout> = self.parts.chains.iter().map(|it| &it.layout).collect();
        let mean = |motion: &Motion| motion.mean_rate(self.drive.begin);
        start_velocities::speeds(&self.system, &layouts, mean)
    }

    /// Trains that no motion turns, as they are where the simulation begins.
    pub fn free_trains(&self) -> Vec<FreeTrain> {
        let layouts: Vec<&Layout> = self.parts.chains.iter().map(|it| &it.layout).collect();
        let begin = self.system.begin;
        let speeds = start_velocities::speeds(&self.system, &layouts, |it| it.at(begin).rate);
        // The drive was assembled, so speeds agree.
        free_trains::free_trains(&self.system, &self.parts, &self.q, &speeds).unwrap_or_default()
    }

    /// Time \[s\] that the slowest chain around sprockets takes for one circuit at its mean speed; infinite where there is none, or it
    /// stands still.
    ///
    /// ```text
    /// t = n 2π/(z ω)     n: links, z and ω: teeth and mean speed of its first sprocket
    /// ```
    pub fn slowest_circuit(&self) -> f64 {
        let speeds = self.mean_speeds();
        let circuit = |member: &Member| {
            let first = *member.route.first()?;
            let teeth = f64::from(self.system.bodies.wheels[first].teeth);
            Some(member.chain.links() as f64 * TAU / (teeth * speeds[first].abs()))
        };
        let circuits = self.system.chains.iter().filter_map(circuit);
        circuits.reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    /// The same drive as another one stood after it had moved for a while, with what it remembered and its coordinates, velocities
    /// and first-order states.
    ///
    /// # Errors
    /// [`MemoryError`] where that was another drive.
    pub fn stood(
        &self,
        time: f64,
        memory: SystemMemory,
        [q, v, z]: [Vec<f64>; 3],
    ) -> Result<Self, MemoryError> {
        for (what, found, own) in [
            ("coordinates", &q, &self.q),
            ("velocities", &v, &self.v),
            ("states of first order", &z, &self.z),
        ] {
            MemoryError::unless(what, found.len(), own.len())?;
        }
        let mut system = self.system.clone();
        system.remember(memory)?;
        Ok(Self {
            system,
            time,
            q,
            v,
            z,
            ..self.clone()
        })
    }

    /// How long it has moved since it stood at rest \[s\].
    pub fn moved_for(&self) -> f64 {
        self.time - self.drive.begin
    }

    /// The same with the zero of the record elsewhere on the clock of the drive \[s\].
    #[must_use]
    pub fn recorded_from(self, zero: f64) -> Self {
        Self { zero, ..self }
    }

    /// The same drive as it stands after it has moved for a while: a run that begins from here goes on from there.
    #[must_use]
    pub fn come_to(&self, system: System, state: &State) -> Self {
        Self {
            system,
            time: state.t,
            q: state.q.to_vec(),
            v: state.v.to_vec(),
            z: state.z.to_vec(),
            ..self.clone()
        }
    }
}

/// Mean tension \[N\] of some links under the pretension alone, where it was found.
fn carried(statics: &[Statics], links: std::ops::Range<usize>) -> Option<f64> {
    let taut = statics.first().filter(|it| it.stage == "pretension")?;
    let tensions = taut.tensions.get(links)?;
    Some(tensions.iter().sum::<f64>() / tensions.len() as f64)
}

/// What a chain whose pins have play is to carry.
fn tightening(parts: &Parts, index: usize, statics: &[Statics]) -> Tightening {
    let placed = &parts.chains[index];
    let (layout, model) = (&placed.layout, &placed.chain.model);
    let at = layout.pretension_at();
    // Bushes on smaller circles have the pitch of a worn chain: free rollers ride up the flanks, and a length does not tell how
    // tight that is. What a frame that has grown adds to the pretension is known from the lumped chain alone.
    let free = model.free_roller().is_some() && at == PretensionAt::MeanPhase;
    let as_lumped = carried(statics, rigid_links::links_of(&parts.chains, index))
        .filter(|_| free || layout.growth() != 0.0)
        .map(|tension| (tension, PretensionAt::Phase));
    let (pretension, at) = as_lumped.unwrap_or((layout.pretension(), at));
    Tightening {
        chain: index,
        pretension,
        stiffness: placed.chain.stiffness[0],
        at,
    }
}

impl Drive {
    /// Lays the chain, finds the static state where asked, and sets everything going at the
    /// speed of the first driven sprocket.
    ///
    /// # Errors
    /// [`AssemblyError`] when the chain does not close or no equilibrium is found.
    pub fn assemble(&self) -> Result<Assembled, AssemblyError> {
        let groups = groups(self.parts());
        let mut assembled = if let [_] = groups.as_slice() {
            self.assemble_joined()
        } else {
            self.assemble_apart(&groups)
        }?;
        // Hard links are laid as those of other drives.
        assembled.drive = self.clone();
        assembled.warnings = assembled.clashes()?;
        Ok(assembled)
    }

    fn assemble_joined(&self) -> Result<Assembled, AssemblyError> {
        let mut chains = self.chains.iter();
        if chains.all(|placed| placed.chain.model.stretches()) {
            self.assemble_as_is()
        } else {
            self.assemble_hard()
        }
    }

    fn assemble_as_is(&self) -> Result<Assembled, AssemblyError> {
        let (laid, fittings) = layout::lay(self)?;
        cuts_into_teeth(&laid).map_or(Ok(()), Err)?;
        let (mut system, mut q) = System::build(&laid)?;
        let layouts: Vec<&Layout> = self.chains.iter().map(|placed| &placed.layout).collect();
        let begin = system.begin;
        let mut speeds =
            start_velocities::speeds(&system, &layouts, |motion| motion.at(begin).rate);
        let trains = free_trains::free_trains(&system, &laid.parts, &q, &speeds)?;
        let (torques, moving) = free_trains::balance(&mut system, &trains, &q);
        let mut statics = Vec::new();
        if self.settle {
            pushes_away::check(&laid.parts, self.begin)?;
            overload::check(&system, &laid.parts, (&q, &torques))?;
            free_trains::hold(&mut system, &moving, &q);
            let settled = newton::settle(&mut system, &mut q, &|| buried(&laid));
            free_trains::let_go(&mut system, &moving);
            statics = settled
                .map_err(|error| laid_through_a_guide(&laid, 0.0).unwrap_or(error))
                .map_err(|error| worn::named(error, &laid.parts, &fittings))
                .map_err(|error| overload::named(error, &system, &laid.parts, (&q, &torques)))?;
        }
        for train in trains.iter().filter(|it| it.speed != 0.0) {
            for (shaft, ratio) in &train.shafts {
                speeds[*shaft] = Some(ratio * train.speed);
            }
        }
        let mut v = start_velocities::set_off(&system, &layouts, &speeds, &q);
        free_trains::hold(&mut system, &moving, &q);
        self.put_in_place(&mut system, &laid.parts, &statics, [&mut q, &mut v])?;
        free_trains::let_go(&mut system, &moving);
        free_trains::restore_torques(&mut system, torques);
        let z = system.settled_states(&q);
        system.start(self.begin, &mut q, &mut v, &z);
        Ok(Assembled {
            drive: self.clone(),
            system,
            time: self.begin,
            zero: 0.0,
            q,
            v,
            z,
            statics,
            fittings,
            warnings: Vec::new(),
            parts: laid.parts,
        })
    }

    /// Puts what the chains are made of where the laid particles are, and settles the joints.
    fn put_in_place(
        &self,
        system: &mut System,
        parts: &Parts,
        statics: &[Statics],
        [q, v]: [&mut Vec<f64>; 2],
    ) -> Result<(), AssemblyError> {
        let mut replaced = false;
        for (index, placed) in parts.chains.iter().enumerate() {
            let laid = ChainAsLaid {
                chain: &placed.chain,
                pretension: placed.layout.pretension(),
                on_route: matches!(placed.layout, Layout::Route { .. }),
                sprockets: &placed.sprockets,
                gravity: parts.gravity,
            };
            replaced |= system.put_in_place(index, &laid, [&mut *q, &mut *v]);
        }
        if !replaced {
            return Ok(());
        }
        let mut still = vec![0.0; q.len()];
        let z = system.settled_states(q);
        system.start(self.begin, q, &mut still, &z);
        let chains = 0..parts.chains.len();
        let loose = chains.filter(|index| system.chains[*index].chain.has_play());
        let tightenings = loose.map(|index| tightening(parts, index, statics));
        let tightenings: Vec<Tightening> = tightenings.collect();
        if self.settle && !tightenings.is_empty() {
            if !system.can_solve() {
                return Err(AssemblyError::Layout {
                    problem: "a chain whose pins have play settles beside chains of rigid links only; start with `settle = false`, or make all chains of rigid links".into(),
                });
            }
            pseudo_transient::settle(system, q, &tightenings)?;
        }
        system.close_in_motion(q, v);
        Ok(())
    }

    /// Lays the chains only, without settling.
    ///
    /// # Errors
    /// [`AssemblyError`] when a chain does not close.
    pub fn layouts(&self) -> Result<Vec<RollerLayout>, AssemblyError> {
        let (laid, fittings) = layout::lay(self)?;
        let chains = laid.chains.into_iter().zip(fittings);
        let layouts = chains.map(|(chain, fitting)| RollerLayout {
            positions: chain.positions,
            fitting,
        });
        Ok(layouts.collect())
    }

    /// The whole profile of a sprocket or guide where it stands when the chains have been laid, without settling.
    ///
    /// That of a sprocket is closed: all its teeth. That of a guide is its working face, an open curve with the material on the left
    /// of travel. Where a sprocket and a guide share a name, the sprocket is meant.
    ///
    /// # Errors
    /// [`AssemblyError`] when a chain does not close, or nothing has this name.
    pub fn profile(&self, name: &str) -> Result<ArcSpline, AssemblyError> {
        let (laid, _) = layout::lay(self)?;
        BodyPositions::laid(&laid).profile(&laid.parts, name)
    }
}

impl Assembled {
    /// The whole profile of a sprocket or guide where it stands when the run begins, as [`Drive::profile`] has it.
    ///
    /// # Errors
    /// [`AssemblyError`] when nothing has this name.
    pub fn profile(&self, name: &str) -> Result<ArcSpline, AssemblyError> {
        self.standing()?.profile(&self.parts, name)
    }

    fn standing(&self) -> Result<BodyPositions, AssemblyError> {
        Ok(BodyPositions::of(&self.system, &self.parts, self.start())?)
    }

    fn start(&self) -> Moment<'_> {
        Moment {
            t: self.time,
            q: &self.q,
            v: &self.v,
            z: &self.z,
        }
    }

    /// Overlaps of bodies at the start that may be meant.
    ///
    /// # Errors
    /// What is.
    fn clashes(&self) -> Result<Vec<Clash>, AssemblyError> {
        let rollers = self.system.roller_places(self.start());
        let standing = self.standing()?;
        let mut found = clashes(&self.parts, &standing, &rollers);
        for index in 0..self.parts.chains.len() {
            found.extend(overrun::of(&self.parts, index, &standing));
        }
        let (may_pass, certain): (Vec<_>, Vec<_>) = found.into_iter().partition(Clash::may_pass);
        if certain.is_empty() {
            Ok(may_pass)
        } else {
            Err(AssemblyError::Clash { clashes: certain })
        }
    }
}

/// Guides that cut into teeth wherever the chains settle, as neither moves.
fn cuts_into_teeth(laid: &LaidDrive) -> Option<AssemblyError> {
    let clashes = fixed_in_teeth(&laid.parts, &BodyPositions::laid(laid));
    (!clashes.is_empty()).then_some(AssemblyError::Clash { clashes })
}

/// The error of a chain that is laid through a guide, more than so deep \[m\].
fn laid_through_a_guide(laid: &LaidDrive, deeper: f64) -> Option<AssemblyError> {
    let rollers: Vec<_> = laid.chains.iter().map(|c| c.positions.clone()).collect();
    let mut clashes = clashes(&laid.parts, &BodyPositions::laid(laid), &rollers);
    clashes.retain(|clash| matches!(clash, Clash::Chain { depth, .. } if *depth > deeper));
    (!clashes.is_empty()).then_some(AssemblyError::Clash { clashes })
}

/// The same where it lies more than a pitch deep, from where no search downhill brings it out.
fn buried(laid: &LaidDrive) -> Option<AssemblyError> {
    let chains = laid.parts.chains.iter();
    let lengths = chains.flat_map(|placed| placed.chain.lengths.iter().copied());
    laid_through_a_guide(laid, lengths.reduce(f64::max)?)
}
