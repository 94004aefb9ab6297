//! The open simulator of roller chain drives.
//!
//! A [`Scene`] is what somebody wrote; [`Scene::drive`] checks it and makes a [`Drive`];
//! a [`Simulation`] moves it and hands out one [`Observation`] after the other, which a
//! [`Recording`] keeps.
//!
//! ```
//! use chaindrive::{Channel, Recording, Run, Scene, Simulation};
//!
//! let drive = Scene::preset("spinning_ring")?.drive()?;
//! let run = Run { until: 5e-3, every: 1e-3, ..Run::default() };
//! let mut simulation = Simulation::start(&drive, &run)?;
//! let mut recording = Recording::new(&[Channel::LinkTension], simulation.system());
//! while let Some(sample) = simulation.next_sample()? {
//!     recording.push(sample);
//! }
//! assert_eq!(recording.len(), 6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! `stores`, on unless switched off: results in Zarr stores, on a disk or in an object store, files, sweeps, many simulations at once. Without it
//! the crate describes, simulates, judges and draws with half as many libraries, and compiles for `wasm32-unknown-unknown`.

#![cfg_attr(
    not(feature = "stores"),
    allow(
        dead_code,
        unreachable_pub,
        unused_imports,
        reason = "stores and sweeps ask for it"
    )
)]

pub mod catalogue;
pub mod chain_verdict;
pub mod channel;
mod clock;
pub mod describe;
pub mod design;
pub mod draw;
mod error;
mod event;
mod execute;
pub mod figure;
mod identity;
mod interruptible;
pub mod laws;
mod net;
pub mod page;
pub mod plausibility;
pub mod precision;
mod rainflow;
pub mod rating;
pub mod record;
mod run;
mod run_in;
pub mod scene;
mod seal;
mod sheet;
mod simulate;
mod statistic;
mod stepping;
mod story;
mod summary;
mod terminal_text;
pub mod verdict;

// Stores: files of results, sweeps, and what else takes threads. Without the feature `stores` these are left out, with the stores of
// `record` and `simulate::step_many`: what remains compiles for browsers too.
#[cfg(feature = "stores")]
mod new_file;
#[cfg(feature = "stores")]
pub mod sweep;
#[cfg(feature = "stores")]
mod zarr;

pub use catalogue::CatalogueChain;
pub use chain_verdict::{ChainVerdict, CheckOutcome};
pub use chaindrive_integrate::{InstructionSet, Method, Statistics};
pub use chaindrive_mechanics::{
    Accounts, Assembled, Body, BodyKind, Clash, ContactEvent, ContactPair, Course, Drive,
    DriveExtremes, Energy, EventKinds, Extremes, Figure, FigureChain, Flow, Impact, Instant,
    MissingChannel, Mode, Modes, Observation, Placement, PlateShape, Pose, RotationArrow, Source,
    Store,
};
pub use channel::{Axis, Channel};
pub use describe::Description;
pub use error::SimulationError;
pub use event::EventTable;
pub use execute::{Report, RunError, Stop, execute};
pub use identity::{Build, Origin};
pub use interruptible::{assemble, patiently};
pub use net::{ProgramError, catch_everywhere, caught};
pub use precision::{Choice, Estimate, Judgement};
pub use rainflow::{Cycle, rainflow};
pub use rating::Rating;
pub use record::{Checkpoint, End, Memory, Recording, Sink};
pub use run::{Request, RequestError, Run, SettingValue, Settings};
pub use run_in::{MOST_CIRCUITS, Onlooker, RunInReport, run_in};
pub use scene::{RunIn, Scene};
pub use seal::{SealError, SealedValue, opened, sealed};
pub use sheet::aligned;
pub use simulate::{Control, Period, Simulation, Snapshot, SnapshotError, View};
pub use stepping::Stepping;
pub use summary::{ImpactStatistics, Summary};
pub use terminal_text::{cell, one_line, plain, plain_json};
pub use verdict::{Reason, Rule, Trust, Verdict};

#[cfg(feature = "stores")]
pub use new_file::{FilePart, NewFile};
#[cfg(feature = "stores")]
pub use simulate::step_many;
