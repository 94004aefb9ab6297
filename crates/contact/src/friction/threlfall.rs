//! Coulomb friction with an exponential approach, after Threlfall.

use chaindrive_quantities::{JsonSchema, Ratio, Speed};
use serde::{Deserialize, Serialize};

/// Coulomb friction approached exponentially.
///
/// ```text
/// f = −μ N [1 − exp(−3 |v|/v_r)] sgn v   |v| ≤ v_r
/// f = −0.95 μ N sgn v                    beyond
/// ```
///
/// Continuous at v_r but for 2e-4 of μN, 1 − e⁻³ being 0.9502. The slope at rest is 3 μN/v_r.
///
/// # Source
/// D. C. Threlfall, *Mech. Mach. Theory* **13**(4), 1978, 475–483.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Threlfall {
    /// Coefficient of friction μ \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Slip v_r \[m/s\] at which the force reaches 95 %.
    #[schemars(with = "Option<Speed>", extend("exclusiveMinimum" = 0))]
    pub slip_speed: f64,
}

impl Threlfall {
    /// Tangential force \[N\], see [`Friction::force`](super::Friction::force).
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        let share = slip.abs() / self.slip_speed;
        let reached = if share <= 1.0 {
            // 1 − exp(−3 |v|/v_r)
            -(-3.0 * share).exp_m1()
        } else {
            0.95
        };
        -(self.coefficient * normal * reached).copysign(slip)
    }

    /// Damping \[N s/m\], see [`Friction::damping`](super::Friction::damping).
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        let share = slip.abs() / self.slip_speed;
        if share <= 1.0 {
            // −∂f/∂v = 3 μ N/v_r exp(−3 |v|/v_r)
            3.0 * self.coefficient * normal / self.slip_speed * (-3.0 * share).exp()
        } else {
            0.0
        }
    }
}
