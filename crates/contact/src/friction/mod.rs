//! The family of friction laws: tangential force from normal force and slip.
//!
//! To add a member write one file with its parameters, and enter it in `mod`, the variant, the
//! match arms and [`specimens`](Friction::specimens).

mod coulomb;

pub use coulomb::Coulomb;

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::no_parameters;

/// A friction law, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Friction {
    /// No friction.
    #[serde(deserialize_with = "no_parameters")]
    None,
    /// Coulomb friction, smooth through zero slip.
    Coulomb(Coulomb),
}

impl Friction {
    /// Tangential force \[N\] under the normal force \[N\] at the slip velocity \[m/s\]; opposes the slip.
    #[inline]
    pub fn force(&self, normal: f64, slip: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Coulomb(member) => member.force(normal, slip),
        }
    }

    /// Damping −∂f/∂v \[N s/m\] at the same arguments; what limits an explicit time step.
    #[inline]
    pub fn damping(&self, normal: f64, slip: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Coulomb(member) => member.damping(normal, slip),
        }
    }

    /// Refuses parameters outside the range of the member.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::None => Ok(()),
            Self::Coulomb(member) => member.check(),
        }
    }

    /// At least one law of every kind, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        vec![
            Self::None,
            Self::Coulomb(Coulomb {
                coefficient: 0.12,
                slip_speed: 0.01,
            }),
        ]
    }
}
