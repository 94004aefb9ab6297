//! Vocabulary that chains, bodies and the system share: what they hand each other, as data.

mod balance;
mod carried;
mod contact_log;
mod loads;
mod moving;
mod observation;
mod pose;
mod rates;

pub(crate) use balance::{Balance, Load, Sum, Unknown};
pub(crate) use carried::{Carried, CarriedByMount};
pub(crate) use contact_log::EventLog;
pub use contact_log::{ContactEvent, ContactPair, EventKinds};
pub(crate) use loads::Loads;
pub(crate) use moving::{Moving, Way};
pub use observation::Observation;
pub(crate) use pose::Pose;
pub(crate) use rates::Rates;
