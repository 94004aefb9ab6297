//! Natural logarithms of many numbers.
//!
//! ```text
//! x = 2ᵉ m,  m in [2^(−½), 2^½]:     ln x = e ln 2 + 2 (s + s³/3 + s⁵/5 + …),   s = (m − 1)/(m + 1)
//! ```

use std::f64::consts::{LN_2, SQRT_2};

use pulp::Simd;

use super::{Lane, Wide};

/// Terms of the series: what follows is below 1e-16 of the first one.
const TERMS: usize = 10;

impl<S: Simd> Lane<S> {
    /// ln x of finite, normal x > 0, to a few ulp; near x = 1 the error is absolute.
    #[inline(always)]
    pub(crate) fn ln(self) -> Self {
        let w = Wide(self.simd);
        let [exponent, fraction] = self.parts();
        let high = fraction.greater(w.splat(SQRT_2));
        let fraction = high.select(w.splat(0.5) * fraction, fraction);
        let exponent = high.select(exponent + w.splat(1.0), exponent);
        let one = w.splat(1.0);
        let s = (fraction - one) * (fraction + one).recip();
        let squared = s * s;
        // Every other term side by side.
        let fourth = squared * squared;
        let mut even = w.splat(2.0 / (2 * TERMS - 3) as f64);
        let mut odd = w.splat(2.0 / (2 * TERMS - 1) as f64);
        for k in (0..TERMS / 2 - 1).rev() {
            even = even.times_plus(fourth, w.splat(2.0 / (4 * k + 1) as f64));
            odd = odd.times_plus(fourth, w.splat(2.0 / (4 * k + 3) as f64));
        }
        let sum = even.plus(odd, squared);
        (exponent * w.splat(LN_2)).plus(s, sum)
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::{Registers, kernel};
    use pulp::WithSimd;

    use super::*;
    use crate::lanes::LANES;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>) {
            for i in 0..40_000 {
                let x = 10.0_f64.powf(-76.0 + 152.0 * f64::from(i) / 40_000.0);
                for x in [x, 1.0 + 1e-3 * x.min(1.0), f64::from(i + 1) * 0.125] {
                    let mut out = [0.0; LANES];
                    w.splat(x).ln().store(&mut out, 0);
                    let error = (out[0] - x.ln()).abs();
                    assert!(error <= 4e-16 * x.ln().abs().max(0.3), "{x}: {error:e}");
                }
            }
        }
    );

    #[test]
    fn agrees_with_the_standard_library() {
        checked().with_simd(pulp::Scalar);
        Registers::in_use().dispatch(checked());
    }
}
