//! Coulomb friction with two tolerances of slip, after Ambrósio.

use chaindrive_quantities::{JsonSchema, Ratio, Speed};
use serde::{Deserialize, Serialize};

/// Coulomb friction that fades in between two slip speeds.
///
/// ```text
/// f = −μ c N sgn v,   c = clamp[(|v| − v₀)/(v₁ − v₀), 0, 1]
/// ```
///
/// There is no friction at all below v₀: what should stick creeps freely. With v₀ = 0 the law is a
/// straight line through rest.
///
/// # Source
/// J. A. C. Ambrósio, *Impact of rigid and flexible multibody systems: deformation description and contact
/// models*, in *Virtual Nonlinear Multibody Systems*, Kluwer, 2003, 57–81.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Ambrosio {
    /// Coefficient of friction μ \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Slip v₀ \[m/s\] up to which there is no friction.
    #[schemars(with = "Speed", extend("minimum" = 0))]
    pub lower_speed: f64,
    /// Slip v₁ \[m/s\] from which friction is whole, above v₀.
    #[schemars(with = "Speed", extend("exclusiveMinimum" = 0))]
    pub upper_speed: f64,
}

impl Ambrosio {
    /// Tangential force \[N\], see [`Friction::force`](super::Friction::force).
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        // c = clamp[(|v| − v₀)/(v₁ − v₀), 0, 1]
        let share = (slip.abs() - self.lower_speed) / (self.upper_speed - self.lower_speed);
        -(self.coefficient * normal * share.clamp(0.0, 1.0)).copysign(slip)
    }

    /// Damping \[N s/m\], see [`Friction::damping`](super::Friction::damping).
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        let speed = slip.abs();
        if speed >= self.lower_speed && speed < self.upper_speed {
            // −∂f/∂v = μ N/(v₁ − v₀)
            self.coefficient * normal / (self.upper_speed - self.lower_speed)
        } else {
            0.0
        }
    }
}
