//! Hysteretic damping that returns what it is asked for.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;
use crate::restitution::factor_for;

/// Hysteretic damping with the factor that delivers the restitution exactly.
///
/// ```text
/// χ (1 + e) = ln[(1 + χ)/(1 − χ e)],   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// Whatever the elastic law, the mass and the speed: a free impact asked for e returns e. The factor is found
/// by Newton's method, once where a law is [prepared](crate::Law::prepared); every other member
/// is an approximation of it.
///
/// # Source
/// Integration of the separable equation of motion, see [`restitution`](crate::restitution); same
/// content as Y. Gonthier et al., *Multibody Syst. Dyn.* **11**, 2004, 209–233.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exact {
    /// Coefficient of restitution e \[–\], in \[1e-6, 1\]; the factor is infinite at 0.
    pub restitution: f64,
}

impl Exact {
    /// Damping factor χ \[–\].
    pub fn factor(self) -> f64 {
        factor_for(self.restitution)
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
