//! Expired shares of many decays, e⁻ˣ − 1.
//!
//! ```text
//! p(x) = e⁻ˣ − 1:     p(2x) = p(x) (2 + p(x)),     p(x) = −x + x²/2 − x³/6 + …
//! ```
//!
//! Doubling keeps the relative error of p for x > 0, so that small and large decays are exact alike.

use pulp::Simd;

use super::{Lane, Wide};

/// Beyond this nothing is left beside rounding.
const OVER: f64 = 38.0;
/// Decays that the series serves by itself.
const SMALL: f64 = OVER / 256.0;
/// Doublings from there on.
const DOUBLINGS: usize = 8;
/// (−1)ᵏ/k! from k = 1 on; the next one leaves 1e-16 of a small decay.
const SERIES: [f64; 10] = [
    -1.0,
    1.0 / 2.0,
    -1.0 / 6.0,
    1.0 / 24.0,
    -1.0 / 120.0,
    1.0 / 720.0,
    -1.0 / 5_040.0,
    1.0 / 40_320.0,
    -1.0 / 362_880.0,
    1.0 / 3_628_800.0,
];

impl<S: Simd> Lane<S> {
    /// e⁻ˣ − 1 of numbers that are not negative, to a few units in the last place.
    #[inline(always)]
    pub(crate) fn decay(self) -> Self {
        let w = Wide(self.simd);
        if !self.greater(w.splat(SMALL)).any() {
            return self.small_decay();
        }
        let mut left = (self.min(w.splat(OVER)) * w.splat(1.0 / 256.0)).small_decay();
        for _ in 0..DOUBLINGS {
            left = left * (w.splat(2.0) + left);
        }
        left
    }

    #[inline(always)]
    fn small_decay(self) -> Self {
        let w = Wide(self.simd);
        // Pairs of terms side by side.
        let squared = self * self;
        let fourth = squared * squared;
        let mut pairs = [self; 5];
        for (k, pair) in pairs.iter_mut().enumerate() {
            *pair = w
                .splat(SERIES[2 * k])
                .plus(w.splat(SERIES[2 * k + 1]), self);
        }
        let second = pairs[1].plus(squared, pairs[2]);
        let third = pairs[3].plus(squared, pairs[4]);
        (self * pairs[0]).plus(self * squared, second.plus(fourth, third))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    #[test]
    fn agrees_with_the_standard_library() {
        let w = Wide(pulp::Scalar);
        let mut worst = 0.0_f64;
        for i in 0..40_000 {
            let x = 10.0_f64.powf(-20.0 + 23.0 * f64::from(i) / 40_000.0);
            let mut out = [0.0; LANES];
            w.splat(x).decay().store(&mut out, 0);
            worst = worst.max((out[0] / (-x).exp_m1() - 1.0).abs());
        }
        assert!(worst < 2e-15, "{worst:e}");
        let mut out = [1.0; LANES];
        w.splat(0.0).decay().store(&mut out, 0);
        assert!(out[0].abs() <= 0.0);
    }
}
