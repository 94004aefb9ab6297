//! Accuracy of a run: its chaos horizon, its numerical error, and the method that reaches a given accuracy.
//!
//! | question | answer |
//! |---|---|
//! | how long can waveforms of two correct runs agree? | [`Horizon`], by a twin that starts 1e-12 m apart |
//! | how far is a run from the exact solution of its model? | [`estimate`], by shadow runs with half and a quarter of the step |
//! | which method and step keep an error? | [`choose`], by trying them from the cheapest on |
//! | what do methods and steps cost, and how exact are they? | [`work_precision`], against a reference that is checked |
//!
//! Read the files in this order: how much of a run is looked at (`window`), what is kept of it (`trace`, `short_runs`), how far two of
//! these are apart (`compare`, `impacts`); then the answers (`horizon`; `estimate` and, in words, `judgement`; `variant` and
//! `choice`; `work` and `table`).
//!
//! All of it looks at the beginning of a run, a [`Window`] of a few teeth, so that its cost does not grow
//! with the length of the run; and nothing of it decides by a clock, so that answers are the same to the
//! last bit wherever the binary runs on the same kind of processor.

mod choice;
mod compare;
mod estimate;
mod horizon;
mod impacts;
mod judgement;
mod short_runs;
mod table;
mod trace;
mod variant;
mod window;
mod work;

pub use crate::scene::{ACCURACY, Quantity};
pub(crate) use choice::choose_with;
pub use choice::{Accuracy, Choice, Promise, Trial, choose};
pub use compare::{Comparison, Errors, Number};
pub use estimate::{ChannelHorizon, Estimate, estimate};
pub use horizon::{Divergence, Horizon, horizon};
pub use impacts::ImpactErrors;
pub use judgement::Judgement;
pub(crate) use short_runs::ShortRuns;
pub(crate) use trace::LEAST_LOSSES;
pub use trace::{Gap, Strands};
pub use variant::Variant;
pub use window::Window;
pub use work::{Row, Study, Table, work_precision};

/// Asked after every sample whether the user wants the calculation to stop.
pub type Watch<'a> = &'a dyn Fn() -> bool;
