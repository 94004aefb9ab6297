//! Hysteretic damping after Lankarani and Nikravesh.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Lankarani and Nikravesh.
///
/// ```text
/// χ = ¾ (1 − e²),   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// Meant for nearly elastic impacts: asked for e = 0.8 it returns 0.847, for e = 0.5 it returns
/// 0.725, whatever the mass and the elastic law, and never less than 0.663. In contacts that begin without an
/// impact δ̇₀ is no more than the floor of the [`Law`](crate::Law).
///
/// # Source
/// H. M. Lankarani and P. E. Nikravesh, *J. Mech. Des.* **112**(3), 1990, 369–376,
/// <https://doi.org/10.1115/1.2912617>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LankaraniNikravesh {
    /// Coefficient of restitution e \[–\] asked for, in \[0, 1\].
    pub restitution: f64,
}

impl LankaraniNikravesh {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        // χ = ¾ (1 − e²)
        0.75 * (1.0 - self.restitution * self.restitution)
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
