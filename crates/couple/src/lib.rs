//! A chain drive as a part of another simulation.
//!
//! A [`Model`] is a drive at the start of its run with a list of [`Variable`]s; an [`Instance`] moves it from one communication point to the
//! next. [`package()`] makes a functional mock-up unit (FMU) for co-simulation of it, after FMI 2.0 and 3.0, which the library of the crate
//! `chaindrive-fmu` carries out.
//!
//! | part | idea |
//! |---|---|
//! | [`Variable`] | an input, parameter, output or constant, by its value reference |
//! | [`Instance`] | phases, values, steps, saved states |
//! | `signal` | an input between two communication points, and what of its work has not arrived |
//! | `description` | `modelDescription.xml` of both versions |
//! | [`package`](package()) | the archive |

mod description;
mod export;
mod fault;
mod instance;
mod model;
mod package;
mod ports;
mod signal;
mod variable;

pub use chaindrive::{caught, plain};
pub use description::Standard;
pub use export::{Export, Facts, LIBRARY, ResourceError, RunFacts};
pub use fault::Fault;
pub use instance::{Instance, Phase, SavedInstance};
pub use model::{Model, ModelError};
pub use package::{PackageError, package, platform, read_library};
pub use variable::{Causality, Choices, Kind, Variable};
