//! Sine and cosine of many angles.
//!
//! ```text
//! φ = k π/2 + r,  |r| ≤ π/4:     sin and cos of r by polynomials, exchanged and negated by k mod 4
//! ```
//!
//! # Source
//! Reduction in three parts: W. J. Cody and W. Waite, *Software Manual for the Elementary Functions*, Prentice-Hall,
//! 1980. Constants and polynomials: K. C. Ng, `k_sin.c`, `k_cos.c` and `e_rem_pio2.c` of *fdlibm* 5.3, Sun Microsystems.

use std::f64::consts::FRAC_2_PI;

use pulp::Simd;

use super::{Lane, Wide};

/// π/2 in three parts; the first two have 33 bits, so that their products with k are exact.
const QUARTER: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];
/// Angles \[rad\] up to which they are.
const FARTHEST: f64 = 1e6;
/// A number beside which there are no fractions: adding it rounds.
const ROUND: f64 = 6_755_399_441_055_744.0;
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

impl<S: Simd> Lane<S> {
    /// sin φ and cos φ to 1e-15.
    #[inline(always)]
    pub(crate) fn sin_cos(self) -> [Self; 2] {
        let w = Wide(self.simd);
        if self.abs().greater(w.splat(FARTHEST)).any() {
            return [self.one_by_one(f64::sin), self.one_by_one(f64::cos)];
        }
        let k = (self * w.splat(FRAC_2_PI)).rounded();
        let [p, q, r] = QUARTER.map(|part| k * w.splat(part));
        let r = self - p - q - r;
        let squared = r * r;
        // r + r³ (S₁ + S₂ r² + …),   1 − r²/2 + r⁴ (C₁ + C₂ r² + …)
        let sine = r + r * squared * horner(squared, SINE);
        let cosine =
            w.splat(1.0) - w.splat(0.5) * squared + squared * squared * horner(squared, COSINE);
        // Quadrant −2 to 2, both ends the same.
        let quadrant = k - w.splat(4.0) * (k * w.splat(0.25)).rounded();
        let size = quadrant.abs();
        let across = size.greater(w.splat(0.5)) & w.splat(1.5).greater(size);
        let behind = size.greater(w.splat(1.5));
        let sin = across.select(cosine, sine);
        let cos = across.select(sine, cosine);
        let left = quadrant.greater(w.splat(0.5));
        let right = w.splat(-0.5).greater(quadrant);
        [
            behind.select(-sin, right.select(-sin, sin)),
            behind.select(-cos, left.select(-cos, cos)),
        ]
    }

    /// The nearest whole number, of numbers well below 2^51.
    #[inline(always)]
    fn rounded(self) -> Self {
        let round = Wide(self.simd).splat(ROUND);
        (self + round) - round
    }
}

#[inline(always)]
fn horner<S: Simd>(x: Lane<S>, coefficients: [f64; 6]) -> Lane<S> {
    let w = Wide(x.simd);
    let mut sum = w.splat(coefficients[5]);
    for k in (0..5).rev() {
        sum = sum * x + w.splat(coefficients[k]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    #[test]
    fn agrees_with_the_standard_library() {
        let w = Wide(pulp::Scalar);
        for i in -40_000..40_000 {
            // Around the axes and the diagonals as well as anywhere, and beyond the range.
            for angle in [
                f64::from(i) * std::f64::consts::FRAC_PI_4,
                f64::from(i) * 1.234_567e-3,
                f64::from(i) * 31.234_567,
            ] {
                let [mut sin, mut cos] = [[0.0; LANES]; 2];
                let [s, c] = w.splat(angle).sin_cos();
                s.store(&mut sin, 0);
                c.store(&mut cos, 0);
                assert!((sin[0] - angle.sin()).abs() < 4e-16, "sin {angle}");
                assert!((cos[0] - angle.cos()).abs() < 4e-16, "cos {angle}");
            }
        }
    }
}
