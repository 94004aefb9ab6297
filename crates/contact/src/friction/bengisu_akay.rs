//! Static and kinetic friction after Bengisu and Akay.

use chaindrive_quantities::{JsonSchema, Ratio, Slowness, Speed};
use serde::{Deserialize, Serialize};

use super::not_below_zero;

/// Friction that rises on a parabola to its static value and decays to its kinetic one.
///
/// ```text
/// f = −μ_s N [1 − (|v| − v₀)²/v₀²] sgn v                           |v| < v₀
/// f = −N {μ_k + (μ_s − μ_k) exp[−ξ (|v| − v₀)]} sgn v              beyond
/// ```
///
/// Continuous, zero at rest, μ_s N at v₀; the slope jumps there. Beyond v₀ the force falls with the
/// slip, which feeds vibration: the damping is reported as zero.
///
/// # Source
/// M. T. Bengisu and A. Akay, *J. Sound Vib.* **171**(4), 1994, 557–570; the form as in reviews, the
/// original was not at hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct BengisuAkay {
    /// Coefficient of static friction μ_s \[–\], at least μ_k.
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub static_coefficient: f64,
    /// Coefficient of kinetic friction μ_k \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Slip v₀ \[m/s\] of the greatest force.
    #[schemars(with = "Option<Speed>", extend("exclusiveMinimum" = 0))]
    pub slip_speed: f64,
    /// Decay ξ \[s/m\] from static to kinetic friction.
    #[schemars(with = "Slowness", extend("exclusiveMinimum" = 0))]
    pub decay: f64,
}

impl BengisuAkay {
    /// Tangential force \[N\], see [`Friction::force`](super::Friction::force).
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        let speed = slip.abs();
        let reached = if speed < self.slip_speed {
            // 1 − (|v| − v₀)²/v₀² = w (2 − w),   w = |v|/v₀
            let share = speed / self.slip_speed;
            self.static_coefficient * share * (2.0 - share)
        } else {
            self.coefficient + self.surplus(speed)
        };
        -(normal * reached).copysign(slip)
    }

    /// Damping \[N s/m\], see [`Friction::damping`](super::Friction::damping).
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        let speed = slip.abs();
        if speed < self.slip_speed {
            // −∂f/∂v = 2 μ_s N (1 − |v|/v₀)/v₀
            let share = speed / self.slip_speed;
            2.0 * self.static_coefficient * normal * (1.0 - share) / self.slip_speed
        } else {
            not_below_zero(-normal * self.decay * self.surplus(speed))
        }
    }

    /// (μ_s − μ_k) exp[−ξ (|v| − v₀)]
    fn surplus(self, speed: f64) -> f64 {
        let beyond = speed - self.slip_speed;
        (self.static_coefficient - self.coefficient) * (-self.decay * beyond).exp()
    }
}
