//! Why a simulation could not start or go on.

use chaindrive_integrate::IntegrationError;
use chaindrive_mechanics::AssemblyError;

/// Why a simulation stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum SimulationError {
    /// A setting of the run is out of range.
    #[error("{name} = {value}, must be {allowed}")]
    Setting {
        name: &'static str,
        value: f64,
        allowed: &'static str,
    },

    /// A channel that does not exist.
    #[error("no channel is named `{name}`{}; there are {known}", hint(.suggestion.as_deref()))]
    UnknownChannel {
        name: String,
        suggestion: Option<String>,
        known: String,
    },

    /// The drive could not be brought into its initial state.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),

    /// The time stepping failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

fn hint(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}
