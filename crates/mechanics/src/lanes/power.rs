//! One fixed power of many numbers, without logarithms.
//!
//! ```text
//! x = m · Π 2^(−s),   m in [2^(−½), 1]     ⇒     xⁿ = mⁿ · Π 2^(−s n)
//! ```
//!
//! The powers of two are taken off by comparing and selecting; mⁿ is a polynomial through its values at Chebyshev's
//! nodes, worked out once for the exponent.

use pulp::Simd;

use super::polynomial::Polynomial;
use super::{Lane, Wide};

/// Powers of two that are taken off, from the largest number on; they reach down to 10⁻³⁵.
const OCTAVES: [f64; 8] = [64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5];
/// Numbers are below 2 to this power.
const LARGEST: f64 = 8.0;
/// Middle and half width of the interval of m.
const MIDDLE: f64 = 0.5 * (1.0 + std::f64::consts::FRAC_1_SQRT_2);
const HALF: f64 = 0.5 * (1.0 - std::f64::consts::FRAC_1_SQRT_2);

/// x ↦ xⁿ for 10⁻³⁵ < x < 256.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedPower {
    /// mⁿ of (m − MIDDLE)/HALF. For exponents up to 2 the error of the interpolation is below that of rounding.
    within: Polynomial,
    /// 2^(−s), 2^s and 2^(−s n) of every octave.
    octaves: [[f64; 3]; OCTAVES.len()],
    /// 2^(8 n)
    largest: f64,
}

impl FixedPower {
    pub(crate) fn new(exponent: f64) -> Self {
        Self {
            within: Polynomial::through(|t| (MIDDLE + HALF * t).powf(exponent)),
            octaves: OCTAVES.map(|s| [(-s).exp2(), s.exp2(), (-s * exponent).exp2()]),
            largest: (LARGEST * exponent).exp2(),
        }
    }

    #[inline(always)]
    pub(crate) fn of<S: Simd>(&self, w: Wide<S>, x: Lane<S>) -> Lane<S> {
        let mut m = x * w.splat((-LARGEST).exp2());
        let mut power = w.splat(self.largest);
        for [least, scale, share] in self.octaves {
            let below = w.splat(least).greater(m);
            m = below.select(m * w.splat(scale), m);
            power = below.select(power * w.splat(share), power);
        }
        let t = (m - w.splat(MIDDLE)) * w.splat(1.0 / HALF);
        power * self.within.of(w, t)
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
        assert!(worst < 3e-15, "{worst:e}");
    }
}
