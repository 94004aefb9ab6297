//! Hysteretic damping after Flores, Machado, Silva and Martins.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Flores and others.
///
/// ```text
/// χ = 8 (1 − e)/(5e),   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// For soft and hard contacts: asked for e = 0.8 it returns 0.789, for e = 0.5 it returns 0.470, for
/// e = 0.1 it returns 0.069.
///
/// # Source
/// P. Flores, M. Machado, M. T. Silva and J. M. Martins, *Multibody Syst. Dyn.* **25**, 2011, 357–375,
/// <https://doi.org/10.1007/s11044-010-9237-4>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flores {
    /// Coefficient of restitution e \[–\] asked for, in \[1e-6, 1\]; the factor is infinite at 0.
    pub restitution: f64,
}

impl Flores {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = 8 (1 − e)/(5e)
        8.0 * (1.0 - e) / (5.0 * e)
    }

    /// Refuses a restitution outside its range.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(self) -> Result<(), ParameterError> {
        require(
            (super::LEAST..=1.0).contains(&self.restitution),
            "restitution",
            self.restitution,
            super::POSITIVE,
        )
    }
}
