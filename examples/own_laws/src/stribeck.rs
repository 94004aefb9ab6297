//! Friction of lubricated surfaces.

use chaindrive::laws::friction::FrictionLaw;
use chaindrive::laws::quantities::{JsonSchema, ParameterError, Ratio, Speed};
use serde::{Deserialize, Serialize};

/// Friction that falls from a static to a kinetic level as a film of oil builds up.
///
/// ```text
/// f = −N γ(v) tanh(v/v_t),   γ = μ_c + (μ_s − μ_c) exp\[−(v/v_s)²\]
/// ```
///
/// The hyperbolic tangent takes the force through zero slip: a contact creeps instead of sticking.
///
/// # Source
/// L. C. Bo and D. Pavelescu, *Wear* **82**(3), 1982, 277–289 (the exponential curve).
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Coefficient of static friction μ_s \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub static_coefficient: f64,
    /// Coefficient of kinetic friction μ_c \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Slip v_s \[m/s\] at which most of the difference is gone.
    #[schemars(with = "Speed", extend("exclusiveMinimum" = 0))]
    pub stribeck_speed: f64,
    /// Slip v_t \[m/s\] over which the force reverses; small beside v_s.
    #[schemars(with = "Speed", extend("exclusiveMinimum" = 0))]
    pub transition_speed: f64,
}

impl Stribeck {
    /// γ \[–\] and dγ/dv \[s/m\].
    fn level(&self, slip: f64) -> [f64; 2] {
        let share = slip / self.stribeck_speed;
        let surplus = (self.static_coefficient - self.coefficient) * (-share * share).exp();
        let level = self.coefficient + surplus;
        [level, -2.0 * share / self.stribeck_speed * surplus]
    }
}

impl FrictionLaw for Stribeck {
    fn force(&self, normal: f64, slip: f64) -> f64 {
        // f = −N γ tanh(v/v_t)
        let [level, _] = self.level(slip);
        -normal * level * (slip / self.transition_speed).tanh()
    }

    fn damping(&self, normal: f64, slip: f64) -> f64 {
        // −∂f/∂v = N [γ′ tanh(v/v_t) + γ (1 − tanh²)/v_t]
        let [level, slope] = self.level(slip);
        let tanh = (slip / self.transition_speed).tanh();
        let rise = level * (1.0 - tanh * tanh) / self.transition_speed;
        (normal * (slope * tanh + rise)).max(0.0)
    }

    fn check(&self) -> Result<(), ParameterError> {
        if self.static_coefficient >= self.coefficient {
            return Ok(());
        }
        Err(ParameterError {
            parameter: "static_coefficient".into(),
            value: self.static_coefficient,
            allowed: "at least the kinetic coefficient".into(),
        })
    }
}
