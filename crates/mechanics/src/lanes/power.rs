//! One fixed power of many numbers, without logarithms.
//!
//! ```text
//! x = 2^e m   ⇒   xⁿ = mⁿ 2^(n e),   n e = k + f,   k whole,   |f| ≤ ½
//! ```
//!
//! mⁿ and 2^f are polynomials through their values at Chebyshev's nodes, worked out once for the exponent; 2^k is put together from
//! its bits.

use pulp::Simd;

use super::octaves::{HALF, MIDDLE};
use super::polynomial::Polynomial;
use super::{Lane, Wide};

/// Upper digits of the exponent, whose products with e are exact: e has at most twelve binary digits.
const DIGITS: f64 = 1_099_511_627_776.0;

/// x ↦ xⁿ of positive numbers, as long as the result is a number with all of its digits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedPower {
    /// n, rounded to 40 digits after the point, and what is missing.
    exponent: [f64; 2],
    /// mⁿ of (m − MIDDLE)/HALF. For exponents up to 2 the error of the interpolation is below that of rounding.
    within: Polynomial,
    /// 2^f of 2 f.
    share: Polynomial,
}

impl FixedPower {
    pub(crate) fn new(exponent: f64) -> Self {
        let upper = (exponent * DIGITS).round() / DIGITS;
        Self {
            exponent: [upper, exponent - upper],
            within: Polynomial::through(|t| (MIDDLE + HALF * t).powf(exponent)),
            share: Polynomial::through(|t| (0.5 * t).exp2()),
        }
    }

    #[inline(always)]
    pub(crate) fn of<S: Simd>(&self, w: Wide<S>, x: Lane<S>) -> Lane<S> {
        let [e, t] = x.octaves();
        let [upper, missing] = self.exponent.map(|part| w.splat(part));
        let whole = e * upper;
        let k = whole.nearest();
        let f = (whole - k) + e * missing;
        let share = self.share.of(w, f + f);
        k.power_of_two() * share * self.within.of(w, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    /// Against the power of the standard library, over all depths that a contact can have and far beyond.
    #[test]
    fn is_exact_to_rounding() {
        let w = Wide(pulp::Scalar);
        let mut worst = 0.0_f64;
        for exponent in [0.0, 0.05, 0.094, 0.156, 0.41, 0.5, 1.0, 1.5, 2.0] {
            let power = FixedPower::new(exponent);
            for i in 0..20_000 {
                let x = 10.0_f64.powf(-35.0 + 37.4 * f64::from(i) / 20_000.0);
                let mut out = [0.0; LANES];
                power.of(w, w.splat(x)).store(&mut out, 0);
                worst = worst.max((out[0] / x.powf(exponent) - 1.0).abs());
            }
        }
        // Each of the two polynomials errs by some units of the last place.
        assert!(worst < 6e-15, "{worst:e}");
    }
}
