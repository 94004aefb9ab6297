//! Hysteretic damping after Hu and Guo.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Hu and Guo.
///
/// ```text
/// χ = 3 (1 − e)/(2e),   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// Right in both limits, and within 2.5 % for e ≥ 0.5: asked for e = 0.8 it returns 0.799, for e = 0.5 it returns
/// 0.488, for e = 0.1 it returns 0.074.
///
/// # Source
/// S. Hu and X. Guo, *Multibody Syst. Dyn.* **35**, 2015, 131–151. The constant is the one that has the exact
/// limit for e → 1; a program in circulation has half of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HuGuo {
    /// Coefficient of restitution e \[–\] asked for, in \[1e-6, 1\]; the factor is infinite at 0.
    pub restitution: f64,
}

impl HuGuo {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = 3 (1 − e)/(2e)
        1.5 * (1.0 - e) / e
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
