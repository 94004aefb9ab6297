//! Hysteretic damping after Lee and Wang.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Lee and Wang.
///
/// ```text
/// χ = ¾ (1 − e),   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// Half of [`HuntCrossley`](super::HuntCrossley)'s, and so half of what even a nearly elastic impact needs: asked for
/// e = 0.8 it returns 0.909, for e = 0.5 it returns 0.799, and never less than 0.663.
///
/// # Source
/// T. W. Lee and A. C. Wang, *J. Mech. Transm. Autom. Des.* **105**(3), 1983, 534–540.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeeWang {
    /// Coefficient of restitution e \[–\] asked for, in \[0, 1\].
    pub restitution: f64,
}

impl LeeWang {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = ¾ (1 − e)
        0.75 * (1.0 - e)
    }

    /// Refuses a restitution outside its range.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(self) -> Result<(), ParameterError> {
        require(
            (0.0..=1.0).contains(&self.restitution),
            "restitution",
            self.restitution,
            "in [0, 1]",
        )
    }
}
