//! Why a simulation could not start or go on.

use chaindrive_integrate::{IntegrationError, StateQuantity};
use chaindrive_mechanics::{AssemblyError, Flow, System};

use crate::Stepping;

/// Why a simulation stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum SimulationError {
    /// A setting of the run is out of range.
    #[error("{name} = {}, must be {allowed}", shown(*.value))]
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

    /// A channel of something that the drive does not have.
    #[error(
        "this chain has no `{name}`: {}, or leave the channel out",
        way_to(name)
    )]
    AbsentChannel { name: &'static str },

    /// The drive could not be brought into its initial state.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),

    /// The time stepping failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),

    /// An implicit method for a chain that does not solve the equations of an implicit step.
    #[error(
        "method = `{method}` is implicit, and this kind of chain does not solve the equations of an \
         implicit step; choose {works}"
    )]
    Implicit { method: &'static str, works: String },

    /// A method, an event or the like that does not exist.
    #[error("{} named `{name}`; there are {known}", nothing(setting))]
    UnknownName {
        setting: &'static str,
        name: String,
        known: String,
    },

    /// An accuracy and what it would choose.
    #[error("`accuracy` chooses the method and its step, and `{given}` is given as well")]
    Conflict { given: &'static str },

    /// The system refuses a thread.
    #[error("no thread can be started: {reason}")]
    Thread { reason: String },

    /// A chain faster than strain can travel in it.
    #[error(
        "the chain starts at {speed:.3e} m/s, must be at most {fastest} m/s, the speed of sound in steel; \
         look at the unit of its speed, or of the speed of a sprocket"
    )]
    TooFast { speed: f64, fastest: f64 },

    /// The drive cannot be run in like that.
    #[error("`run_in`: {reason}")]
    RunIn {
        /// Why not, and what to write instead.
        reason: String,
    },

    /// A time that has passed.
    #[error(
        "t = {time} s is past: the simulation was read at {read} s; take a snapshot to go back to"
    )]
    Past { time: f64, read: f64 },

    /// An end before what has been simulated.
    #[error("until = {until} s is past: the run has samples up to {reached} s")]
    Ended { until: f64, reached: f64 },

    /// A control that cannot be set while a drive moves.
    #[error("{what} `{name}` cannot be set: {reason}")]
    Control {
        what: &'static str,
        name: String,
        reason: String,
    },

    /// A recording that the memory cannot hold.
    #[error(
        "the recording takes {gigabytes:.1} GB, more than the memory holds: {samples} samples of {values} values; \
         record fewer channels (`record`) or fewer samples (`every`), or stream them into a store (`output`)"
    )]
    TooLarge {
        gigabytes: f64,
        samples: f64,
        values: usize,
    },

    /// Somebody asked the calculation to stop.
    #[error("interrupted")]
    Interrupted,

    /// The motion ceased to be finite.
    #[error(
        "at t = {t:.6} s the {quantity} of {place} is no longer finite; try a smaller step, or look for a contact or damping that is too stiff for its mass"
    )]
    NotFinite {
        t: f64,
        place: String,
        quantity: String,
    },
}

impl SimulationError {
    /// The error of a start, with the methods as scenes name them.
    pub(crate) fn starting(error: IntegrationError, method: Stepping) -> Self {
        match error {
            IntegrationError::Unsupported { .. } => {
                let explicit =
                    |method: &Stepping| !method.is_implicit() && *method != Stepping::Auto;
                let explicit = Stepping::ALL.into_iter().filter(explicit);
                let works: Vec<_> = explicit.map(Stepping::name).collect();
                Self::Implicit {
                    method: method.name(),
                    works: works.join(", "),
                }
            }
            other => Self::Integration(other),
        }
    }

    /// The error of a step, with the place in the drive instead of the number of a coordinate.
    pub(crate) fn stepping(error: IntegrationError, system: &System) -> Self {
        match error {
            IntegrationError::NotFinite { t, dof, quantity } => Self::NotFinite {
                t,
                place: match quantity {
                    StateQuantity::Quadrature => {
                        format!("the energy flow `{}`", Flow::ALL[dof].name())
                    }
                    _ => system.place(dof),
                },
                quantity: quantity.to_string(),
            },
            other => Self::Integration(other),
        }
    }
}

/// The thing that is missing, in words.
fn nothing(setting: &str) -> &'static str {
    match setting {
        "events" => "no contacts are",
        "kind" => "nothing that can be set is",
        _ => "no method is",
    }
}

/// A number without hundreds of zeros.
fn shown(value: f64) -> String {
    let plain = !value.is_finite() || value == 0.0 || (1e-6..1e15).contains(&value.abs());
    if plain {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn hint(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// Keys that would give a chain a channel that it lacks.
fn way_to(channel: &str) -> &'static str {
    if channel.starts_with("bush_") {
        "its rollers are no bodies of their own; set `chain.rollers` to `free` on rigid links"
    } else {
        "particles have neither joints nor directions; set `chain.model` to `clearance-joints` or `ideal-joints`"
    }
}
