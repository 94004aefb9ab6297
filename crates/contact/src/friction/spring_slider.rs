//! Coulomb friction that holds elastically: a spring in series with a slider.

use chaindrive_quantities::{JsonSchema, Ratio, Stiffness};
use serde::{Deserialize, Serialize};

use super::Rub;

/// A spring and a slider in series: friction with a state, sticking included, sharp at any speed.
///
/// ```text
/// z′ = z + v h, drawn back to |z′| ≤ μ N/k,     f = −k z′
/// ```
///
/// z is the deflection of the spring \[m\]; it is zero where a contact begins, and a normal force that falls lets the slider
/// go. Below the limit the contact is a spring k and nothing is lost; at the limit it is Coulomb's law, whatever the speed.
/// It needs no speed at which friction fades in, so that no dashpot μ N/v_s stands in the way of long steps: all it asks
/// for is that the step resolves the spring k, which acts beside the springs of the contact.
///
/// [`force`](super::Friction::force) is that of steady sliding; its slope is zero.
///
/// # Source
/// C. F. Jenkin, *Engineering* **114**, 1922, 603 (spring and slider); P. A. Cundall and O. D. L. Strack, *Géotechnique*
/// **29**(1), 1979, 47–65 (as a law of contacts, advanced step by step).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct SpringSlider {
    /// Coefficient of friction μ \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Stiffness k along the surface, until it slides \[N/m\].
    #[schemars(with = "Option<Stiffness>", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
}

impl SpringSlider {
    /// Tangential force \[N\] of steady sliding; zero at rest.
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        if slip.abs() > 0.0 {
            // f = −μ N sgn v
            -(self.coefficient * normal).copysign(slip)
        } else {
            0.0
        }
    }

    /// Damping \[N s/m\] of steady sliding: none.
    #[inline]
    pub fn damping(self, _normal: f64, _slip: f64) -> f64 {
        0.0
    }

    /// Force, damping and deflection at the end of a step, see [`Friction::rub`](super::Friction::rub).
    #[inline]
    pub fn rub(self, normal: f64, slip: f64, state: f64, dt: f64) -> Rub {
        let limit = self.coefficient * normal / self.stiffness;
        let tried = state + slip * dt;
        let holds = tried.abs() < limit;
        let deflection = tried.max(-limit).min(limit);
        Rub {
            force: -self.stiffness * deflection,
            // −∂f/∂v = k h while it holds
            damping: if holds { self.stiffness * dt } else { 0.0 },
            state: deflection,
        }
    }
}
