//! How exact a run is: its chaos horizon, its numerical error, and the method that an accuracy takes.
//!
//! | question | answer |
//! |---|---|
//! | how long can waveforms of two correct runs agree? | [`Horizon`], by a twin that starts 1e-12 m apart |
//! | how far is a run from the exact solution of its model? | [`estimate`], by shadow runs with half and a quarter of the step |
//! | which method and step keep an error? | [`choose`], by trying them from the cheapest on |
//! | what do methods and steps cost, and how exact are they? | [`work_precision`], against a reference that is checked |
//!
//! All of it looks at the beginning of a run, a [`Window`] of a few teeth, so that its cost does not grow
//! with the length of the run; and nothing of it decides by a clock, so that answers are the same to the
//! last bit wherever the binary runs on the same kind of processor.

mod accuracy;
mod attribute;
mod candidates;
mod choice;
mod compare;
mod convergence;
mod errors;
mod estimate;
mod growth;
mod horizon;
mod impacts;
mod judgement;
mod report;
mod sharper;
mod short_runs;
mod table;
mod trace;
mod variant;
mod window;
mod work;

pub use crate::scene::{ACCURACY, Quantity};
pub(crate) use accuracy::LEAST_LOSSES;
pub use accuracy::{Accuracy, Promise};
pub use attribute::Attribute;
pub(crate) use choice::choose_with;
pub use choice::{Choice, Trial, choose};
pub use compare::Comparison;
pub use errors::Errors;
pub use estimate::{ChannelHorizon, Estimate, estimate};
pub use horizon::{Divergence, Horizon, horizon};
pub use impacts::ImpactErrors;
pub use judgement::Judgement;
pub(crate) use short_runs::ShortRuns;
pub use table::Number;
pub use trace::{Gap, Strands};
pub use variant::Variant;
pub use window::Window;
pub use work::{Row, Study, Table, work_precision};

/// Asked after every sample whether the user wants the calculation to stop.
pub type Watch<'a> = &'a dyn Fn() -> bool;
