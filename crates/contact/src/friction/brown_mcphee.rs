//! Static, kinetic and viscous friction in one smooth curve, after Brown and McPhee.

use chaindrive_quantities::{Damping, Force, JsonSchema, Ratio, Speed};
use serde::{Deserialize, Serialize};

use super::not_below_zero;

/// Smooth friction with a static peak.
///
/// ```text
/// f = −{N [μ_d tanh 4r + (μ_s − μ_d) r/(r²/4 + ¾)²] + μ_v |v| tanh(4N/N_t)} sgn v,   r = |v|/v_t
/// ```
///
/// Infinitely smooth but for the sign, and cheap. Its peak, 0.9995 μ_s for μ_s = 1.5 μ_d, lies near r = 1; the
/// slope at rest is 4 μ_d + ¹⁶⁄₉ (μ_s − μ_d) times N/v_t, steeper than that of
/// [`Coulomb`](super::Coulomb) for the same v_t. Where the curve falls with the slip its damping
/// is reported as zero.
///
/// # Source
/// P. Brown and J. McPhee, *J. Comput. Nonlinear Dyn.* **11**(5), 2016, 054502,
/// <https://doi.org/10.1115/1.4033658>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct BrownMcphee {
    /// Coefficient of static friction μ_s \[–\], at least μ_d.
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub static_coefficient: f64,
    /// Coefficient of dynamic friction μ_d \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Slip v_t \[m/s\] of the greatest force.
    #[schemars(with = "Option<Speed>", extend("exclusiveMinimum" = 0))]
    pub slip_speed: f64,
    /// Viscous friction μ_v \[N s/m\]; none unless given.
    #[serde(default)]
    #[schemars(with = "Damping", extend("minimum" = 0))]
    pub viscosity: f64,
    /// Normal force N_t \[N\] at which viscous friction is whole.
    #[schemars(with = "Option<Force>", extend("exclusiveMinimum" = 0))]
    pub transition_force: f64,
}

impl BrownMcphee {
    /// Without viscous friction.
    pub fn dry(static_coefficient: f64, coefficient: f64, slip_speed: f64) -> Self {
        Self {
            static_coefficient,
            coefficient,
            slip_speed,
            viscosity: 0.0,
            transition_force: 1.0,
        }
    }

    /// Tangential force \[N\], see [`Friction::force`](super::Friction::force).
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        // Odd in r = v/v_t; the signs come by themselves.
        let r = slip / self.slip_speed;
        let bell = 0.25 * r * r + 0.75;
        let excess = self.static_coefficient - self.coefficient;
        // μ_d tanh 4r + (μ_s − μ_d) r/(r²/4 + ¾)²
        let dry = self.coefficient * (4.0 * r).tanh() + excess * r / (bell * bell);
        -(normal * dry + self.viscous(normal) * slip)
    }

    /// Damping \[N s/m\], see [`Friction::damping`](super::Friction::damping).
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        let r = slip / self.slip_speed;
        let bell = 0.25 * r * r + 0.75;
        let excess = self.static_coefficient - self.coefficient;
        let reached = (4.0 * r).tanh();
        // 4 μ_d (1 − tanh² 4r) + (μ_s − μ_d) (¾ − ¾ r²)/(r²/4 + ¾)³
        let steep = 4.0 * self.coefficient * (1.0 - reached * reached);
        let dry = steep + excess * 0.75 * (1.0 - r * r) / (bell * bell * bell);
        not_below_zero(normal * dry / self.slip_speed + self.viscous(normal))
    }

    /// μ_v tanh(4N/N_t) \[N s/m\].
    #[inline]
    fn viscous(self, normal: f64) -> f64 {
        if self.viscosity > 0.0 {
            self.viscosity * (4.0 * normal / self.transition_force).tanh()
        } else {
            0.0
        }
    }
}
