//! An elastic law with a spring behind it.
//!
//! ```text
//!   δ = x + g(x)/k_s,   F = g(x),   1/k = 1/g′(x) + 1/k_s,   U = U_g(x) + F²/(2 k_s)
//! ```
//!
//! Parts behind two surfaces that touch, plates behind a pin or the rim behind a tooth, bear the same force. Of a linear and
//! of a logarithmic law such a stack is again a law of its kind, with other constants; of any other x is found by Newton's method.

use super::{Curve, Power};

/// A law with its constants worked out, and what lies behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stack {
    curve: Curve,
    /// 1/k_s \[m/N\]; zero where there is nothing.
    compliance: f64,
}

/// Change of x, relative, at which it is found.
const FOUND: f64 = 4e-16;

impl Stack {
    pub(crate) fn new(curve: Curve, series: Option<f64>) -> Self {
        let whole = |curve| Self {
            curve,
            compliance: 0.0,
        };
        match (curve, series) {
            (curve, None) => whole(curve),
            (Curve::Linear(k), Some(behind)) => whole(Curve::Linear(k * behind / (k + behind))),
            (Curve::Logarithmic(law), Some(behind)) => {
                whole(Curve::Logarithmic(law.with_series(behind)))
            }
            (curve, Some(behind)) => Self {
                curve,
                compliance: 1.0 / behind,
            },
        }
    }

    /// The law, if nothing lies behind it that is not in its constants.
    pub(crate) fn curve(self) -> Option<Curve> {
        (self.compliance <= 0.0).then_some(self.curve)
    }

    /// Depth \[m\] from which on the law is no more than its own tangent, what lies behind included.
    pub(crate) fn reach(self) -> Option<f64> {
        // δ = x + g(x)/k_s
        let whole = |x: f64| x + self.curve.pair(x).0 * self.compliance;
        self.curve.reach().map(whole)
    }

    /// The law of a power, and the stiffness k_s behind it \[N/m\].
    pub(crate) fn power_and_series(self) -> Option<(Power, f64)> {
        let power = match self.curve {
            Curve::Hertz(stiffness) => Power {
                stiffness,
                exponent: 1.5,
            },
            Curve::Power(power) => power,
            Curve::Linear(_) | Curve::Logarithmic(_) | Curve::Plain(_) => return None,
        };
        (self.compliance > 0.0).then(|| (power, 1.0 / self.compliance))
    }

    /// Force F \[N\] and stiffness dF/dδ \[N/m\] at the penetration δ \[m\].
    #[inline]
    pub(crate) fn pair(self, penetration: f64) -> (f64, f64) {
        if self.compliance <= 0.0 {
            return self.curve.pair(penetration);
        }
        let (_, force, stiffness) = self.share(penetration);
        // k = k_g/(1 + k_g/k_s)
        (force, stiffness / (1.0 + stiffness * self.compliance))
    }

    /// Stored energy \[J\] at the penetration δ \[m\].
    #[inline]
    pub(crate) fn energy(self, penetration: f64) -> f64 {
        if self.compliance <= 0.0 {
            return self.curve.energy(penetration);
        }
        let (x, force, _) = self.share(penetration);
        self.curve.energy(x) + 0.5 * self.compliance * force * force
    }

    /// Penetration x of the surfaces themselves, with their force and stiffness.
    ///
    /// Newton's method on x + g(x)/k_s − δ = 0 from x = δ: g grows ever faster, so the steps come down to the root from above
    /// and cannot pass it.
    fn share(self, penetration: f64) -> (f64, f64, f64) {
        if penetration <= 0.0 {
            return (0.0, 0.0, 0.0);
        }
        let mut x = penetration;
        loop {
            let (force, stiffness) = self.curve.pair(x);
            let excess = x + force * self.compliance - penetration;
            let next = x - excess / (1.0 + stiffness * self.compliance);
            // It ceases to come down where rounding begins.
            if !(next < x * (1.0 - FOUND) && next > 0.0) {
                return (x, force, stiffness);
            }
            x = next;
        }
    }
}
