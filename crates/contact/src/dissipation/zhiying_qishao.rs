//! Hysteretic damping after Zhiying and Qishao.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Hysteretic damping of Zhiying and Qishao.
///
/// ```text
/// χ = ¾ (1 − e²) exp[2 (1 − e)],   F = g(δ) (1 + χ δ̇/δ̇₀)
/// ```
///
/// [`LankaraniNikravesh`](super::LankaraniNikravesh) with a correction for hard losses: asked for e = 0.8 it returns
/// 0.787, for e = 0.5 it returns 0.483, and never less than 0.179.
///
/// # Source
/// Z. Qin and Q. Lu, *J. Dyn. Control* **4**(4), 2006, 294–298.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ZhiyingQishao {
    /// Coefficient of restitution e \[–\] asked for, in \[0, 1\].
    pub restitution: f64,
}

impl ZhiyingQishao {
    /// Damping factor χ \[–\].
    #[inline]
    pub fn factor(self) -> f64 {
        let e = self.restitution;
        // χ = ¾ (1 − e²) exp[2 (1 − e)]
        0.75 * (1.0 - e * e) * (2.0 * (1.0 - e)).exp()
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
