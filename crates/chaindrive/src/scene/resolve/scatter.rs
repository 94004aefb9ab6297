//! Random numbers that are the same on every machine and in every version.
//!
//! Logarithm and cosine are those of the crate `libm`: those of the platform differ in the last bit.

/// Normally distributed numbers: SplitMix64 and the Box–Muller transform.
///
/// # Source
/// G. L. Steele, D. Lea and C. H. Flood, *OOPSLA* 2014, 453–472 (SplitMix64);
/// G. E. P. Box and M. E. Muller, *Ann. Math. Stat.* **29**(2), 1958, 610–611.
pub(super) struct Normal {
    state: u64,
}

impl Normal {
    /// `stream` separates the quantities that one seed scatters.
    pub(super) fn new(seed: u32, stream: u32) -> Self {
        Self {
            state: (u64::from(stream) << 32) | u64::from(seed),
        }
    }

    /// A number of mean 0 and standard deviation 1.
    pub(super) fn next(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        // x = √(−2 ln u) cos 2πv
        (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
    }

    /// A number in (0, 1].
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        ((z >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_the_normal_distribution() {
        let mut normal = Normal::new(1, 0);
        let sample: Vec<f64> = (0..40_000).map(|_| normal.next()).collect();
        let mean = |f: fn(f64) -> f64| sample.iter().map(|&x| f(x)).sum::<f64>() / 40_000.0;
        assert!(mean(|x| x).abs() < 0.02);
        assert!((mean(|x| x * x) - 1.0).abs() < 0.03);
        assert!((mean(|x| x.powi(4)) - 3.0).abs() < 0.2);
    }

    /// Beside a computation with forty digits (mpmath), where 2πv is not rounded, the bits that the library makes everywhere.
    #[test]
    fn numbers_are_the_same_everywhere() {
        let expected: [(f64, u64); 6] = [
            (-0.028_249_746_095_854_197, 0xbf9c_ed80_5e68_7295),
            (-0.227_919_522_867_634_78, 0xbfcd_2c77_886b_0faa),
            (0.103_090_951_685_740_7, 0x3fba_642b_2a00_f745),
            (-0.446_450_021_055_195_6, 0xbfdc_92a3_1bee_c1c5),
            (0.127_582_782_235_948_4, 0x3fc0_54a1_f29e_380a),
            (1.558_035_382_188_633, 0x3ff8_edb6_8248_2d37),
        ];
        let [mut first, mut second] = [Normal::new(1, 0), Normal::new(7, 3)];
        let drawn = std::iter::repeat_with(|| first.next()).take(3);
        let drawn = drawn.chain(std::iter::repeat_with(|| second.next()).take(3));
        for (drawn, (exact, bits)) in drawn.zip(expected) {
            assert!((drawn - exact).abs() < 2e-15, "{drawn} {exact}");
            assert_eq!(drawn.to_bits(), bits, "{drawn}");
        }
    }

    #[test]
    fn seeds_and_streams_differ_and_repeat() {
        let first = |seed, stream| Normal::new(seed, stream).next().to_bits();
        assert_eq!(first(1, 0), first(1, 0));
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
    }
}
