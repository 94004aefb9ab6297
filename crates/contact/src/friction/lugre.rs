//! Friction of bristles that bend, after Canudas de Wit and others.

use chaindrive_quantities::{JsonSchema, PerLength, Ratio, Slowness, Speed};
use serde::{Deserialize, Serialize};

use super::{Rub, not_below_zero};

/// The `LuGre` law: friction with a state, sticking included.
///
/// ```text
/// ż = v − σ₀ |v| z/γ(v),   γ = μ_c + (μ_s − μ_c) exp[−(v/v_s)²]
/// f = −N (σ₀ z + σ₁ ż + σ₂ v)
/// ```
///
/// z is the mean deflection of the bristles \[m\]; the constants are per normal force, so that the law is
/// Coulomb's in proportion to N. Below the limit of sticking the contact is a spring σ₀ N and does not
/// creep; the state belongs to one contact and is zero when it opens.
///
/// [`Friction::rub`](super::Friction::rub) advances z over a step at constant slip by the exact solution,
///
/// ```text
/// z′ = z_∞ + (z − z_∞) exp(−σ₀ |v| h/γ),   z_∞ = γ sgn(v)/σ₀
/// ```
///
/// so that no step is too long for the state. Its damping is the derivative of the force at the end of the step
/// and contains σ₀ h: what a linearly implicit step needs.
/// [`force`](super::Friction::force) and [`damping`](super::Friction::damping) are those of the steady
/// state, a Stribeck curve that jumps at rest.
///
/// # Source
/// C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, *IEEE Trans. Autom. Control* **40**(3),
/// 1995, 419–425.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Lugre {
    /// Coefficient of static friction μ_s \[–\], at least μ_c.
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub static_coefficient: f64,
    /// Coefficient of kinetic friction μ_c \[–\].
    #[schemars(with = "Ratio", extend("exclusiveMinimum" = 0))]
    pub coefficient: f64,
    /// Stribeck speed v_s \[m/s\].
    #[schemars(with = "Option<Speed>", extend("exclusiveMinimum" = 0))]
    pub slip_speed: f64,
    /// Stiffness σ₀ of the bristles per normal force \[1/m\].
    #[schemars(with = "PerLength", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Damping σ₁ of the bristles per normal force \[s/m\].
    #[serde(default)]
    #[schemars(with = "Slowness", extend("minimum" = 0))]
    pub damping: f64,
    /// Viscous friction σ₂ per normal force \[s/m\].
    #[serde(default)]
    #[schemars(with = "Slowness", extend("minimum" = 0))]
    pub viscosity: f64,
}

impl Lugre {
    /// γ(v) \[–\] and dγ/dv \[s/m\].
    #[inline]
    fn level(self, slip: f64) -> (f64, f64) {
        let share = slip / self.slip_speed;
        // γ = μ_c + (μ_s − μ_c) exp[−(v/v_s)²]
        let surplus = (self.static_coefficient - self.coefficient) * (-share * share).exp();
        (
            self.coefficient + surplus,
            -2.0 * share / self.slip_speed * surplus,
        )
    }

    /// Tangential force \[N\] of the steady state; zero at rest.
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        if slip.abs() > 0.0 {
            // f = −N [γ sgn v + σ₂ v]
            let (level, _) = self.level(slip);
            -normal * (level.copysign(slip) + self.viscosity * slip)
        } else {
            0.0
        }
    }

    /// Damping \[N s/m\] of the steady state, without the jump at rest.
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        // −∂f/∂v = N (dγ/d|v| + σ₂)
        let (_, slope) = self.level(slip.abs());
        not_below_zero(normal * (slope + self.viscosity))
    }

    /// Force, damping and deflection at the end of a step, see [`Friction::rub`](super::Friction::rub).
    #[inline]
    pub fn rub(self, normal: f64, slip: f64, state: f64, dt: f64) -> Rub {
        let (level, slope) = self.level(slip);
        let speed = slip.abs();
        let sign = if speed > 0.0 { slip.signum() } else { 0.0 };
        // a = σ₀ |v| h/γ,   z′ = z + (z_∞ − z) (1 − e^{−a})
        let stiff = self.stiffness / level;
        let passed = -(-stiff * speed * dt).exp_m1();
        let deflection = state + (sign / stiff - state) * passed;
        // ż = v − σ₀ |v| z′/γ
        let rate = slip - stiff * speed * deflection;

        // dz′/dv = (1 − e^{−a}) dz_∞/dv + e^{−a} (z_∞ − z) da/dv, where
        // (z_∞ − z) da/dv = h (sgn v − σ₀ z/γ) (sgn v − |v| γ′/γ); at rest the mean of both sides
        let share = slope / level;
        let swing = if speed > 0.0 {
            dt * (sign - stiff * state) * (sign - speed * share)
        } else {
            dt
        };
        let bend = passed * sign * slope / self.stiffness + (1.0 - passed) * swing;
        // dż/dv = 1 − (σ₀/γ) [sgn(v) z′ + |v| dz′/dv − |v| z′ γ′/γ]
        let change = 1.0 - stiff * (sign * deflection + speed * (bend - deflection * share));
        Rub {
            // f = −N (σ₀ z + σ₁ ż + σ₂ v)
            force: -normal
                * (self.stiffness * deflection + self.damping * rate + self.viscosity * slip),
            damping: not_below_zero(
                normal * (self.stiffness * bend + self.damping * change + self.viscosity),
            ),
            state: deflection,
        }
    }
}
