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
        self.stored(x, force)
    }

    /// Stored energies \[J\] at penetrations δ \[m\] of several contacts: those of [`energy`](Self::energy) to the last bit.
    ///
    /// Newton's method waits for one root and one quotient after the other: of contacts side by side the processor works on several at a
    /// time, where the law has no other function. One that has been found stays where it is while the others go on.
    #[inline]
    pub(crate) fn energies<const N: usize>(self, penetrations: [f64; N]) -> [f64; N] {
        let Curve::Hertz(_) = self.curve else {
            return penetrations.map(|penetration| self.energy(penetration));
        };
        if self.compliance <= 0.0 || !penetrations.iter().all(|penetration| *penetration >= 0.0) {
            return penetrations.map(|penetration| self.energy(penetration));
        }
        let (mut x, mut forces) = (penetrations, [0.0; N]);
        loop {
            let mut goes_on = false;
            for i in 0..N {
                let (force, stiffness) = self.curve.pair(x[i]);
                let next = self.nearer(penetrations[i], x[i], force, stiffness);
                let is_found = !comes_down(x[i], next);
                goes_on |= !is_found;
                forces[i] = force;
                x[i] = if is_found { x[i] } else { next };
            }
            if !goes_on {
                break;
            }
        }
        std::array::from_fn(|i| self.stored(x[i], forces[i]))
    }

    /// Energy of the surfaces at their own penetration x \[m\], and of what lies behind them.
    #[inline]
    fn stored(self, x: f64, force: f64) -> f64 {
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
            let next = self.nearer(penetration, x, force, stiffness);
            if !comes_down(x, next) {
                return (x, force, stiffness);
            }
            x = next;
        }
    }

    /// A step of that method.
    #[inline]
    fn nearer(self, penetration: f64, x: f64, force: f64, stiffness: f64) -> f64 {
        let excess = x + force * self.compliance - penetration;
        x - excess / (1.0 + stiffness * self.compliance)
    }
}

/// The iteration comes down from x until rounding begins.
#[inline]
fn comes_down(x: f64, next: f64) -> bool {
    next < x * (1.0 - FOUND) && next > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours of a contact, and kinds of law, change no bit.
    #[test]
    fn energies_side_by_side_are_those_of_one() {
        let depth = |i: usize| 1e-9 * 10.0_f64.powf(0.17 * i as f64);
        let power = |exponent| Power {
            stiffness: 6.6e10,
            exponent,
        };
        for curve in [1.0, 1.2, 1.5].map(|exponent| Curve::of_power(power(exponent))) {
            for series in [None, Some(5e7), Some(1e12)] {
                let stack = Stack::new(curve, series);
                for first in 0..40 {
                    let depths: [f64; 8] = std::array::from_fn(|i| depth(first + 3 * i % 7));
                    let found = stack.energies(depths).map(f64::to_bits);
                    assert_eq!(found, depths.map(|depth| stack.energy(depth).to_bits()));
                }
                let open = [1e-6, 0.0, -1e-6].map(|depth| stack.energy(depth).to_bits());
                assert_eq!(stack.energies([1e-6, 0.0, -1e-6]).map(f64::to_bits), open);
            }
        }
    }
}
