//! Hysteretic damping after Herbert and McWhannell.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Herbert and McWhannell.
///
/// ```text
/// χ = 6 (1 − e)/[(2e − 1)² + 3],   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// Good for nearly elastic impacts: asked for e = 0.8 it returns 0.807, for e = 0.5 it returns 0.594, and
/// never less than 0.488.
///
/// # Source
/// R. G. Herbert and D. C. McWhannell, *J. Eng. Ind.* **99**(3), 1977, 513–518.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HerbertMcWhannell {
    /// Coefficient of restitution e \[–\] asked for, in \[0, 1\].
    pub restitution: f64,
}

impl HerbertMcWhannell {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = 6 (1 − e)/[(2e − 1)² + 3]
        6.0 * (1.0 - e) / ((2.0 * e - 1.0).powi(2) + 3.0)
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
