//! Hysteretic damping after Gonthier, McPhee, Lange and Piedbœuf.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Gonthier and others.
///
/// ```text
/// χ = (1 − e²)/e,   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// The best of the explicit factors over the whole range, within 4.3 % for 0.1 ≤ e ≤ 1: asked for e = 0.8 it returns
/// 0.768, for e = 0.5 it returns 0.488.
///
/// # Source
/// Y. Gonthier, J. McPhee, C. Lange and J.-C. Piedbœuf, *Multibody Syst. Dyn.* **11**, 2004, 209–233.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gonthier {
    /// Coefficient of restitution e \[–\] asked for, in \[1e-6, 1\]; the factor is infinite at 0.
    pub restitution: f64,
}

impl Gonthier {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = (1 − e²)/e
        (1.0 - e * e) / e
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
