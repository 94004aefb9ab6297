//! Random numbers that are the same on every machine and in every version.

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
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
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

    #[test]
    fn seeds_and_streams_differ_and_repeat() {
        let first = |seed, stream| Normal::new(seed, stream).next().to_bits();
        assert_eq!(first(1, 0), first(1, 0));
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
    }
}
