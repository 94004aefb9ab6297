//! Elastic laws with their constants worked out, for loops.

use super::{Curve, ElasticLaw, Power};

impl Curve {
    /// A power law by its exponent.
    #[expect(
        clippy::float_cmp,
        reason = "an exponent is a chosen constant, not the result of arithmetic"
    )]
    pub(super) fn of_power(power: Power) -> Self {
        if power.exponent == 1.0 {
            Self::Linear(power.stiffness)
        } else if power.exponent == 1.5 {
            Self::Hertz(power.stiffness)
        } else {
            Self::Power(power)
        }
    }

    /// Depth \[m\] from which on the law is no more than its own tangent, where there is one.
    pub(super) fn reach(self) -> Option<f64> {
        match self {
            Self::Linear(_) | Self::Hertz(_) | Self::Power(_) => None,
            Self::Logarithmic(curve) => Some(curve.reach()),
            Self::Plain(law) => law.reach(),
        }
    }

    /// Force g \[N\] and stiffness dg/dδ \[N/m\] at the penetration δ \[m\].
    #[inline]
    pub(crate) fn pair(self, penetration: f64) -> (f64, f64) {
        match self {
            Self::Linear(stiffness) if penetration > 0.0 => (stiffness * penetration, stiffness),
            Self::Hertz(stiffness) if penetration > 0.0 => {
                // g = K √δ δ,   k = 1.5 K √δ
                let secant = stiffness * penetration.sqrt();
                (secant * penetration, 1.5 * secant)
            }
            Self::Linear(_) | Self::Hertz(_) => (0.0, 0.0),
            Self::Power(power) => power.pair(penetration),
            Self::Logarithmic(curve) => curve.pair(penetration),
            Self::Plain(law) => law.pair(penetration),
        }
    }

    /// Stored energy \[J\] at the penetration δ \[m\].
    #[inline]
    pub(crate) fn energy(self, penetration: f64) -> f64 {
        match self {
            Self::Linear(stiffness) => Power::linear(stiffness).energy(penetration),
            Self::Hertz(stiffness) => {
                let exponent = 1.5;
                let power = Power {
                    stiffness,
                    exponent,
                };
                power.energy(penetration)
            }
            Self::Power(power) => power.energy(penetration),
            Self::Logarithmic(curve) => curve.energy(penetration),
            Self::Plain(law) => law.energy(penetration),
        }
    }
}
