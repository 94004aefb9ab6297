//! One fixed power of many numbers, without logarithms.
//!
//! ```text
//! x = m · Π 2^(−s),   m in [2^(−½), 1]     ⇒     xⁿ = mⁿ · Π 2^(−s n)
//! ```
//!
//! The powers of two are taken off by comparing and selecting; mⁿ is a polynomial through its values at Chebyshev's
//! nodes, worked out once for the exponent.

use pulp::Simd;

use super::{Lane, Wide};

/// Coefficients of the polynomial. For exponents up to 2 the error of the interpolation is then below that of rounding.
const TERMS: usize = 14;
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
    /// Of rising powers of (m − MIDDLE)/HALF.
    coefficients: [f64; TERMS],
    /// 2^(−s), 2^s and 2^(−s n) of every octave.
    octaves: [[f64; 3]; OCTAVES.len()],
    /// 2^(8 n)
    largest: f64,
}

impl FixedPower {
    pub(crate) fn new(exponent: f64) -> Self {
        Self {
            coefficients: polynomial(|m| m.powf(exponent)),
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
        // Even and odd powers side by side.
        let squared = t * t;
        let mut even = w.splat(self.coefficients[TERMS - 2]);
        let mut odd = w.splat(self.coefficients[TERMS - 1]);
        for k in (0..TERMS / 2 - 1).rev() {
            even = even * squared + w.splat(self.coefficients[2 * k]);
            odd = odd * squared + w.splat(self.coefficients[2 * k + 1]);
        }
        power * (even + odd * t)
    }
}

/// Coefficients of the polynomial through the values of `f` at Chebyshev's nodes, in rising powers of (m − MIDDLE)/HALF.
fn polynomial(f: impl Fn(f64) -> f64) -> [f64; TERMS] {
    let count = TERMS as f64;
    let angle = |i: usize| std::f64::consts::PI * (i as f64 + 0.5) / count;
    let values: [f64; TERMS] = std::array::from_fn(|i| f(MIDDLE + HALF * angle(i).cos()));
    let mut sum = [0.0; TERMS];
    // T₀ = 1, T₁ = t, T_{k+1} = 2 t T_k − T_{k−1}
    let (mut before, mut basis) = ([0.0; TERMS], [0.0; TERMS]);
    basis[0] = 1.0;
    for k in 0..TERMS {
        let share: f64 = (0..TERMS)
            .map(|i| values[i] * (k as f64 * angle(i)).cos())
            .sum();
        let share = share * if k == 0 { 1.0 } else { 2.0 } / count;
        for (sum, basis) in sum.iter_mut().zip(&basis) {
            *sum += share * basis;
        }
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let next =
            std::array::from_fn(|j| factor * if j > 0 { basis[j - 1] } else { 0.0 } - before[j]);
        (before, basis) = (basis, next);
    }
    sum
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
