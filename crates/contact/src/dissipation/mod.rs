//! The family of dissipations: what the closing speed makes of an elastic force.
//!
//! To add a member write one file with its parameters, its constants and its range, and enter it
//! in the five lines of this file: `mod`, the variant, the arms of [`action`](Dissipation::action) and
//! [`check`](Dissipation::check), and [`specimens`](Dissipation::specimens). A hysteretic
//! member is complete with its factor χ: the force is [`Action`]'s.

mod action;
mod lankarani_nikravesh;
mod viscous;

pub use action::{Action, RATIO_LIMIT};
pub use lankarani_nikravesh::LankaraniNikravesh;
pub use viscous::Viscous;

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::no_parameters;

/// A dissipation, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Dissipation {
    /// No loss: the contact returns what it stored.
    #[serde(deserialize_with = "no_parameters")]
    None,
    /// Hysteretic, χ = ¾ (1 − e²), for nearly elastic impacts.
    LankaraniNikravesh(LankaraniNikravesh),
    /// A dashpot beside the elastic law.
    Viscous(Viscous),
}

impl Dissipation {
    /// The dissipation with its constants worked out; ask once, outside a loop.
    #[inline]
    pub fn action(&self) -> Action {
        match self {
            Self::None => Action::None,
            Self::LankaraniNikravesh(member) => Action::Hysteretic {
                factor: member.factor(),
            },
            Self::Viscous(member) => Action::Viscous {
                damping: member.damping,
            },
        }
    }

    /// Refuses parameters outside the range of the member.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::None => Ok(()),
            Self::LankaraniNikravesh(member) => member.check(),
            Self::Viscous(member) => member.check(),
        }
    }

    /// At least one dissipation of every kind, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        vec![
            Self::None,
            Self::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.9 }),
            Self::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.3 }),
            Self::Viscous(Viscous { damping: 250.0 }),
        ]
    }
}
