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

mod applied;
mod articulation;
mod assembly;
mod bodies;
mod chains;
mod check;
mod contact;
mod coupling;
mod dense;
mod drive;
mod energy;
mod error;
mod events;
mod fights;
mod forcing;
mod groups;
#[doc(hidden)]
pub mod inside;
mod joints;
mod lanes;
mod modes;
mod motion;
mod nudge;
mod observe;
mod order;
mod pose;
mod profile;
mod seam;
mod standing;
mod strength;
mod struck;
mod surface;
mod system;
mod tensioner;
mod torque;
mod trains;

pub use articulation::Articulation;
pub use assembly::{Assembled, Fitting, FreeTrain, Gap, RollerLayout, Statics};
pub use bodies::Input;
pub use chains::chain::{Chain, End, Ends};
pub use chains::model::*;
pub use contact::{Impact, Impacts};
pub use coupling::Coupling;
pub use drive::{
    Adjust, AgainstRoute, Drive, Fit, GearPair, Guide, GuideSupport, Layout, Parts, PlacedChain,
    PretensionAt, Rotation, Shaft, SpanStart, Sprocket, StartSpeed, Stop, Support, Tighten,
    Touches,
};
pub use energy::{Energy, Flow, Place, Store};
pub use error::{AssemblyError, Clash, DriveError, MemoryError, Pull};
pub use fights::Fight;
pub use joints::{Clearance, FreeRoller};
pub use modes::{Mode, Modes};
pub use motion::{Harmonic, Kinematics, Motion, Table};
pub use observe::ChainSize;
pub use order::Order;
pub use pose::{
    Body, BodyKind, Figure, FigureChain, Instant, MissingChannel, Placement, PlateShape, Pose,
};
pub use seam::{ContactEvent, ContactPair, EventKinds, Observation};
pub use strength::{Capacity, PowerLimits, Strength, Unrated};
pub use struck::Struck;
pub use surface::{Flank, Surface};
pub use system::{Record, System, SystemMemory};
pub use tensioner::{Carrier, Push, PushForce, Tensioner, carriers, pushes};
pub use torque::{Argument, Torque};

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
