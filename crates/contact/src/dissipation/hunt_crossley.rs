//! Hysteretic damping after Hunt and Crossley.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Hunt and Crossley.
///
/// ```text
/// χ = ³⁄₂ (1 − e),   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// The tangent of the exact factor at e = 1, and the first law whose damping vanishes with the penetration: asked for
/// e = 0.8 it returns 0.833, for e = 0.5 it returns 0.663, and never less than 0.488.
///
/// # Source
/// K. H. Hunt and F. R. E. Crossley, *J. Appl. Mech.* **42**(2), 1975, 440–445,
/// <https://doi.org/10.1115/1.3423596>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HuntCrossley {
    /// Coefficient of restitution e \[–\] asked for, in \[0, 1\].
    pub restitution: f64,
}

impl HuntCrossley {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = ³⁄₂ (1 − e)
        1.5 * (1.0 - e)
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
