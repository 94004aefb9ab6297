//! Numbers as powers of two.
//!
//! ```text
//! x = 2^e m,   e a multiple of ½,   m in [1, √2]
//! ```
//!
//! The exponent of a double stands in the upper half of its bits, where the shifts of whole numbers of 32 bits reach it: 2^20 + E has
//! E there, at the place of its last whole binary digit.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use pulp::{Simd, bytemuck};

use super::{Lane, Wide};

/// Bits of the exponent, and of the mantissa.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
/// Bias of the exponent of a double.
const BIAS: f64 = 1023.0;
/// The number whose last whole digit is the first bit of the upper half.
const UPPER: f64 = 1_048_576.0;
/// Where the exponent begins in the upper half.
const PLACE: u32 = 20;
/// Added and taken off again, it leaves whole numbers.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Middle and half width of the interval of m.
pub(super) const MIDDLE: f64 = 0.5 * (SQRT_2 + 1.0);
pub(super) const HALF: f64 = 0.5 * (SQRT_2 - 1.0);

impl<S: Simd> Lane<S> {
    /// e, and (m − [`MIDDLE`])/[`HALF`], of positive numbers that are neither infinite nor as small as no double is with all of its digits.
    #[inline(always)]
    pub(super) fn octaves(self) -> [Self; 2] {
        let w = Wide(self.simd);
        let [whole, m] = self.parts();
        let large = m.greater(w.splat(SQRT_2));
        let e = whole + large.select(w.splat(0.5), w.splat(0.0));
        let m = large.select(m * w.splat(FRAC_1_SQRT_2), m);
        [e, (m - w.splat(MIDDLE)) * w.splat(1.0 / HALF)]
    }

    /// Whole exponent of two and fraction, which is not below 1 and below 2, of such numbers.
    #[inline(always)]
    pub(super) fn parts(self) -> [Self; 2] {
        let w = Wide(self.simd);
        let upper = w.splat(UPPER);
        let bits = self.simd.and_f64s(self.v, mask::<S>(w, EXPONENT));
        let bits = self.simd.or_f64s(self.shifted::<false>(bits), upper.v);
        let whole = self.with(bits) - w.splat(UPPER + BIAS);
        let bits = self.simd.and_f64s(self.v, mask::<S>(w, MANTISSA));
        [whole, self.with(self.simd.or_f64s(bits, w.splat(1.0).v))]
    }

    /// The nearest whole numbers.
    #[inline(always)]
    pub(super) fn nearest(self) -> Self {
        let whole = Wide(self.simd).splat(WHOLE);
        (self + whole) - whole
    }

    /// 2^k of whole numbers between −1022 and 1023.
    #[inline(always)]
    pub(super) fn power_of_two(self) -> Self {
        let biased = self + Wide(self.simd).splat(UPPER + BIAS);
        self.with(self.shifted::<true>(biased.v))
    }

    /// All halves of the bits moved up to the place of the exponent, or down from there.
    #[inline(always)]
    fn shifted<const UP: bool>(self, bits: S::f64s) -> S::f64s {
        if size_of::<S::u32s>() == size_of::<S::f64s>() {
            let halves: S::u32s = bytemuck::cast(bits);
            let places = self.simd.splat_u32s(PLACE);
            return bytemuck::cast(if UP {
                self.simd.wrapping_dyn_shl_u32s(halves, places)
            } else {
                self.simd.wrapping_dyn_shr_u32s(halves, places)
            });
        }
        // One lane, whose numbers of 32 bits are no halves of it.
        let halves: [u32; 2] = bytemuck::cast(bits);
        bytemuck::cast(halves.map(|half| if UP { half << PLACE } else { half >> PLACE }))
    }
}

#[inline(always)]
fn mask<S: Simd>(w: Wide<S>, bits: u64) -> S::f64s {
    w.splat(f64::from_bits(bits)).v
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::{Registers, kernel};
    use pulp::{Scalar, Scalar128b, WithSimd};

    use super::*;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>) {
            for i in -400..400 {
                let x = 1.093_f64.powi(i) * (1.0 + 1e-9 * f64::from(i));
                let [e, t] = w.splat(x).octaves().map(|lane| lane.numbers()[0]);
                let m = MIDDLE + HALF * t;
                assert!(t.abs() < 1.0 + 1e-12 && (2.0 * e).fract().abs() < 1e-300);
                assert!((e.exp2() * m / x - 1.0).abs() < 4e-16, "{x}: {e}, {m}");
                let whole = w.splat(e + 0.1).nearest();
                let power = whole.power_of_two().numbers()[0];
                let expected = (e + 0.1).round().exp2();
                assert!((power / expected - 1.0).abs() < 1e-300, "{e}: {power}");
            }
        }
    );

    #[test]
    fn numbers_are_taken_apart_and_put_together() {
        checked().with_simd(Scalar);
        checked().with_simd(Scalar128b);
        Registers::in_use().dispatch(checked());
    }
}
