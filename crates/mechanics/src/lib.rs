//! Chain, sprockets, guides and tensioners, and the forces between them.
//!
//! A [`Drive`] is a checked description; [`Drive::assemble`] lays the chain, finds the static
//! state and compiles everything into a [`System`] of flat arrays that the time stepping of
//! `chaindrive-integrate` advances.
//!
//! | model | file | degrees of freedom |
//! |---|---|---|
//! | particle chain | [`ChainModel::Particles`] | 2 per roller |
//! | roller, bush and pin as points | [`ChainModel::Points`] | 6 per roller |
//! | rigid links, ideal joints or clearance | [`ChainModel::Rigid`] | 3 per link |
//! | free rollers on them | [`RollerModel::Free`] | 3 per roller |
//! | bush chain of several strands | [`ChainModel::Strands`] | 2 per joint |
//! | shaft, free to turn, with its sprockets | [`Shaft`] | 1 |
//! | sprocket centre on springs | [`Support::Springs`] | 2 |
//! | tensioner: slider or arm | [`Tensioner`] | 1 |
//! | guide | [`Guide`] | 0 |
//!
//! SI units and radians throughout; counter-clockwise positive; tension positive; normals point
//! out of the material; penetration positive.
//!
//! # Example
//!
//! Two links between fixed ends under a tension T. The joint between them swings across with ω² = 2 T/(m ℓ), and along with
//! ω² = 2 k/m, whose energy a run keeps.
//!
//! ```
//! use chaindrive_geometry::{Point, Vector};
//! use chaindrive_integrate::{Method, Moment, SecondOrderSystem};
//! use chaindrive_mechanics::{
//!     Chain, ChainModel, Drive, End, Ends, Layout, Observation, Parts, PlacedChain, Strength,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (pitch, mass, stiffness, tension) = (0.0127, 0.01, 20e6, 500.0);
//! let chain = Chain {
//!     pitch,
//!     lengths: vec![pitch - tension / stiffness; 2],
//!     stiffness: vec![stiffness; 2],
//!     damping: vec![0.0; 2],
//!     masses: vec![mass; 3],
//!     roller_diameter: 7.75e-3,
//!     roller_deviations: Vec::new(),
//!     plate_height: 9.6e-3,
//!     articulation: None,
//!     drag: 0.0,
//!     ends: Ends::Open([End::Fixed, End::Fixed]),
//!     model: ChainModel::Particles,
//!     strength: Strength::default(),
//! };
//! let placed = PlacedChain {
//!     name: None,
//!     chain,
//!     layout: Layout::Points {
//!         positions: (0..3).map(|i| Point::new(pitch * f64::from(i), 0.0)).collect(),
//!         velocities: vec![Vector::zeros(); 3],
//!     },
//!     sprockets: vec![],
//!     guides: vec![],
//! };
//! let parts = Parts {
//!     chains: vec![placed],
//!     sprockets: vec![],
//!     guides: vec![],
//!     tensioners: vec![],
//!     shafts: vec![],
//!     couplings: vec![],
//!     gears: vec![],
//!     settle: true,
//!     gravity: Vector::zeros(),
//!     oil: None,
//!     tunable: Vec::new(),
//! };
//! // All parameters out of range at once, or a drive.
//! let drive = Drive::new(parts).map_err(|problems| format!("{problems:?}"))?;
//! let mut assembled = drive.assemble()?;
//!
//! let [across, along] = [2.0 * tension / pitch, 2.0 * stiffness];
//! for (found, stiffness) in assembled.modes()?.frequencies().iter().zip([across, along]) {
//!     let exact = (stiffness / mass).sqrt() / std::f64::consts::TAU;
//!     assert!((found / exact - 1.0).abs() < 1e-9);
//! }
//!
//! let mut state = assembled.state();
//! let middle = 1;
//! state.v[middle] = 0.5; // m/s along the chain
//! let system = &mut assembled.system;
//! let mut stepper = Method::Verlet { step: 1e-6 }.start(system, &mut state)?;
//! for _ in 0..1000 {
//!     stepper.advance(system, &mut state)?;
//! }
//! let (mut seen, flows) = (Observation::default(), vec![0.0; system.quadratures()]);
//! let at = Moment { t: state.t, q: &state.q, v: &state.v, z: &state.z };
//! system.observe(at, &flows, &mut system.new_record(), &mut seen);
//! // ½ m v² + 2 · T²/(2 k)
//! let energy = seen.energy.kinetic() + seen.energy.stored();
//! let given = 0.5 * mass * 0.5_f64.powi(2) + tension * tension / stiffness;
//! assert!((energy / given - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```

mod accounts;
mod action;
mod alignment;
mod applied;
mod articulation;
mod assembly;
mod bodies;
mod body_impacts;
mod body_positions;
mod chains;
mod check;
mod contact;
mod coupling;
mod course;
mod dense;
mod drive;
mod energy;
mod engagement;
mod error;
mod events;
mod force;
mod forcing;
mod groups;
#[doc(hidden)]
pub mod inside;
mod joints;
mod kinematics;
mod lanes;
mod modes;
mod motion;
mod motion_conflicts;
mod observe;
mod order;
mod pose;
mod profile;
mod seam;
mod shaft_loss;
mod speed_table;
mod strength;
mod surface;
mod system;
mod table;
mod tensioner;
mod tolerance;
mod tooth_stack;
mod torque;
mod trains;
mod twin_start;
mod warming;
mod watch;

pub use accounts::{
    Accounts, GuideAccount, ShaftAccount, Source, SprocketAccount, TensionerAccount,
};
pub use action::{Action, Argument};
pub use alignment::Alignment;
pub use articulation::{Articulation, LateralRub};
pub use assembly::{Assembled, Fitting, FreeTrain, Gap, RollerLayout, Sag, Statics};
pub use bodies::Input;
pub use body_impacts::BodyImpacts;
pub use chains::chain::{Chain, End, Ends};
pub use chains::model::*;
pub use contact::{Impact, Impacts};
pub use coupling::Coupling;
pub use course::{Course, Path};
pub use drive::{
    Adjust, AgainstRoute, Drive, Fit, GearPair, Guide, GuideSupport, Layout, OilSupply, Parts,
    PlacedChain, PretensionAt, Rotation, Shaft, SpanStart, Sprocket, StartSpeed, Stop, Support,
    Tighten, Touches, Tunable,
};
pub use energy::{Energy, Flow, Place, Store};
pub use engagement::engagement_wave;
pub use error::{AssemblyError, Clash, DriveError, MemoryError, Pull};
pub use force::Forces;
pub use joints::{Clearance, FreeRoller};
pub use kinematics::Kinematics;
pub use modes::{Mode, Modes};
pub use motion::{Harmonic, Motion};
pub use motion_conflicts::MotionConflict;
pub use observe::{ChainSize, Sights};
pub use order::{Forcing, Order};
pub use pose::{
    Body, BodyKind, Figure, FigureChain, Instant, MissingChannel, Placement, PlateShape, Pose,
    RotationArrow,
};
pub use seam::{ContactEvent, ContactPair, EventKinds, Observation};
pub use shaft_loss::{Bearing, BearingFeed, Series, ShaftDrag, ShaftLoss, SkfBearing};
pub use speed_table::SpeedTable;
pub use strength::{Capacity, MissingRating, PowerLimits, Strength};
pub use surface::{Flank, Surface};
pub use system::{Record, System, SystemMemory};
pub use table::Table;
pub use tensioner::{Carrier, Push, PushForce, Tensioner, carriers, pushes};
pub use tolerance::Tolerance;
pub use tooth_stack::{
    Beam, BeamEnds, JointMasses, StackTerm, StrikingMass, ToothStack, dry_blow, rim_compliance,
    wall_compliance,
};
pub use torque::Torque;
pub use warming::warming;
pub use watch::{DriveExtremes, Extremes, SprocketExtremes, WatchPlan};

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
