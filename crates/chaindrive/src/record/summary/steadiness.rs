//! How well a mean over time is known, and whether it is that of a steady state.
//!
//! Samples follow one another and are not independent, so their scatter says little about their mean. What counts is the spectrum at
//! frequency 0, which is found as Heidelberger and Welch do (Communications of the ACM 24, 1981), from means b of batches of samples: a
//! line through the logarithm of the periodogram near 0, in pairs, so that single lines (teeth, cams) count little:
//!
//! ```text
//! x̄ ± t √(p₀/n),   I_j = |Σ b_l exp(−2πi j l/n)|²/n,   J_k = ln ((I₂ₖ₋₁ + I₂ₖ)/2) + 0.270,   k = 1 … 12
//! ln p₀ = a − C/2,   J ≈ a + b f,   C = 0.645 (1/K + f̄²/Σ (f − f̄)²),   t: 97.5 % of Student's t with 2/(exp C − 1) degrees of freedom
//! ```
//!
//! Of what repeats, teeth and cams, the mean keeps what the ends of the record cut off a period: for m periods of amplitude A up to A/(π m), which no
//! spectrum near 0 tells. Weights that fade towards the ends (Hann; Harris, Proceedings of the IEEE 66, 1978) keep 1/(m² − 1) of that, so that the
//! difference from their mean shows it, in all but sign the error itself:
//!
//! ```text
//! x̄ ± √(t² p₀/n + 1.5² (x̄ − x̄_w)²),   x̄_w = Σ w_l b_l/Σ w_l,   w_l = 1 − cos 2π(l + ½)/n
//! ```
//!
//! 1.5 = 1/(1 − ⅓) is for two periods, the fewest. Noise adds to the second term as well, of variance ½ p₀/n, independent of the error of the mean:
//! the interval of noise alone becomes a tenth wider.
//!
//! A series that is shorter than 20 of its correlation times τ is too short for that:
//!
//! ```text
//! τ = 1 + 2 Σ_{k≤M} ρ_k,   M ≥ 5 τ the smallest        (Sokal, Monte Carlo Methods in Statistical Mechanics, 1997)
//! ```
//!
//! The start of a run, before the steady state,
//! is cut off where the standard error of the rest is least (MSER: White, Simulation 69, 1997; on means of batches as in MSER-5,
//! White, Cobb and Spratt, Winter Simulation Conference 2000):
//!
//! ```text
//! d = argmin Σ_{j>d} (b_j − x̄_d)²/(n − d)²,   d < n/2
//! ```
//!
//! A minimum at half of the run, or halves of the rest whose means differ (Geweke 1992), say that there is no steady state yet.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// Batches kept at most; when there are so many, neighbours are joined.
const MOST: usize = 160;

/// Batches below which nothing is said.
const LEAST: usize = 20;

/// Groups of batches whose means tell whether the halves agree.
const GROUPS: usize = 10;

/// Pairs of ordinates of the periodogram that the line goes through, where there are as many.
const PAIRS: usize = 12;

/// Mean, and variance, of the logarithm of half of χ² with 4 degrees of freedom over 2: the mean of two ordinates over the spectrum.
const LOG_PAIR: (f64, f64) = (-0.270, 0.645);

/// The normal variate that is exceeded in 2.5 % of cases.
const NORMAL: f64 = 1.959_964;

/// Error of a mean of what repeats over its difference from the weighted mean, for two periods.
const ENDS: f64 = 1.5;

/// Correlation times below which a series is too short for its mean to be known.
const CORRELATION_TIMES: f64 = 20.0;

/// Correlation times over which correlations are added up.
const WINDOW: f64 = 5.0;

/// Standard errors by which the means of two halves may differ: 1 of 130 steady runs differs by more.
const HALVES_AGREE: f64 = 3.0;

/// Relative scatter below which a number is constant.
const CONSTANT: f64 = 1e-12;

/// Means of batches of a series, in bounded memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Batches {
    means: Vec<f64>,
    /// Samples in a batch.
    length: u64,
    /// Sum and number of those in the batch that is not full.
    begun: (f64, u64),
}

/// Knowledge of a mean over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Half width of the 95 % interval of the mean, without what comes before the steady state.
    pub half_width: f64,
    /// Mean of the steady state.
    pub mean: f64,
    /// Share of the samples that come before it.
    pub before: f64,
    /// Whether a steady state is reached.
    pub is_steady: bool,
    /// Whether the series is long enough for the half width to be believed.
    pub is_independent: bool,
}

impl Default for Batches {
    fn default() -> Self {
        Self {
            means: Vec::with_capacity(MOST),
            length: 1,
            begun: (0.0, 0),
        }
    }
}

impl Batches {
    pub(crate) fn push(&mut self, value: f64) {
        let (sum, count) = &mut self.begun;
        *sum += value;
        *count += 1;
        if *count < self.length {
            return;
        }
        self.means.push(*sum / self.length as f64);
        self.begun = (0.0, 0);
        if self.means.len() == MOST {
            let joined = self.means.chunks_exact(2);
            self.means = joined.map(|pair| 0.5 * (pair[0] + pair[1])).collect();
            self.length *= 2;
        }
    }

    /// Their statement about the mean; none as long as there are fewer than 20.
    pub(crate) fn steadiness(&self) -> Option<Steadiness> {
        let all = &self.means;
        if all.len() < LEAST {
            return None;
        }
        let cut = truncation(all);
        let steady = &all[cut..];
        let groups = grouped(steady, GROUPS)?;
        let (first, second) = groups.split_at(GROUPS / 2);
        let [[a, ea], [b, eb]] = [first, second].map(moments);
        let constant = CONSTANT * a.abs().max(b.abs());
        let apart = (a - b).abs() > HALVES_AGREE * ea.hypot(eb) + constant;
        Some(Steadiness {
            half_width: half_width(steady),
            mean: mean(steady),
            before: cut as f64 / all.len() as f64,
            is_steady: cut < all.len() / 2 && !apart,
            is_independent: steady.len() as f64 > CORRELATION_TIMES * correlation_time(steady),
        })
    }
}

/// Half width of the 95 % interval of the mean of values that follow one another.
fn half_width(values: &[f64]) -> f64 {
    let n = values.len();
    let mean = mean(values);
    let ordinate = |j: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (l, value) in values.iter().enumerate() {
            // What differs by whole turns is the same.
            let (s, c) = (TAU * ((j * l) % n) as f64 / n as f64).sin_cos();
            re += (value - mean) * c;
            im += (value - mean) * s;
        }
        (re * re + im * im) / n as f64
    };
    let pairs = PAIRS.min((n / 2 - 1) / 2);
    let points: Vec<(f64, f64)> = (1..=pairs)
        .map(|k| {
            let power = 0.5 * (ordinate(2 * k - 1) + ordinate(2 * k));
            let frequency = (4 * k - 1) as f64 / (2 * n) as f64;
            (frequency, power.ln() - LOG_PAIR.0)
        })
        .collect();
    let count = pairs as f64;
    let centre = points.iter().map(|(f, _)| f).sum::<f64>() / count;
    let level = points.iter().map(|(_, power)| power).sum::<f64>() / count;
    // Nothing scatters: no power has no logarithm.
    if level.is_infinite() {
        return 0.0;
    }
    let spread: f64 = points.iter().map(|(f, _)| (f - centre).powi(2)).sum();
    let rise: f64 = points
        .iter()
        .map(|(f, power)| (f - centre) * (power - level))
        .sum();
    let at_zero = level - rise / spread * centre;
    let doubt = LOG_PAIR.1 * (1.0 / count + centre * centre / spread);
    let spectrum = (at_zero - 0.5 * doubt).exp();
    let of_noise = students(2.0 / doubt.exp_m1()) * (spectrum / n as f64).sqrt();
    of_noise.hypot(ENDS * (mean - fading(values)))
}

/// Mean with weights that fade towards the ends.
fn fading(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let (mut sum, mut weights) = (0.0, 0.0);
    for (l, value) in values.iter().enumerate() {
        // w_l = 1 − cos 2π(l + ½)/n
        let weight = 1.0 - (TAU * (l as f64 + 0.5) / n).cos();
        sum += weight * value;
        weights += weight;
    }
    sum / weights
}

/// Student's t that is exceeded in 2.5 % of cases, of some degrees of freedom.
///
/// # Source
/// Abramowitz and Stegun, *Handbook of Mathematical Functions*, 26.7.5; to 1e-3 from 4 degrees on.
fn students(freedom: f64) -> f64 {
    let z = NORMAL;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
        (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5)
            - 1920.0 * z.powi(3)
            - 945.0 * z)
            / 92_160.0,
    ];
    let powers = (1..).zip(terms);
    z + powers.map(|(k, term)| term / freedom.powi(k)).sum::<f64>()
}

/// Batches before the steady state, at most half of them.
fn truncation(means: &[f64]) -> usize {
    let n = means.len();
    // Sums over what is left, from the end.
    let (mut sum, mut squares) = (0.0, 0.0);
    // About the last mean, so that nothing is lost where scatter is small.
    let origin = means[n - 1];
    let mut best = (f64::INFINITY, 0);
    for d in (0..n).rev() {
        let x = means[d] - origin;
        sum += x;
        squares += x * x;
        if d > n / 2 {
            continue;
        }
        let left = (n - d) as f64;
        let scatter = (squares - sum * sum / left).max(0.0) / (left * left);
        if scatter <= best.0 {
            best = (scatter, d);
        }
    }
    best.1
}

/// Means of some groups of equal length; what does not fill one is left out at the start.
fn grouped(means: &[f64], groups: usize) -> Option<Vec<f64>> {
    let length = means.len() / groups;
    let chunks = means.rchunks_exact(length.max(1));
    let mut chunks: Vec<f64> = chunks.take(groups).map(mean).collect();
    chunks.reverse();
    (length > 0).then_some(chunks)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean, and its standard error.
fn moments(values: &[f64]) -> [f64; 2] {
    let mean = mean(values);
    let n = values.len() as f64;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    [mean, (squares / (n - 1.0) / n).sqrt()]
}

/// Correlation of those that are `lag` apart; none where nothing scatters.
fn correlation(values: &[f64], lag: usize) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let pairs = values.iter().zip(&values[lag..]);
    let products: f64 = pairs.map(|(a, b)| (a - mean) * (b - mean)).sum();
    let correlation = products / squares;
    if correlation.is_nan() {
        0.0
    } else {
        correlation
    }
}

/// Number of values after which one tells little of the next, at least 1.
fn correlation_time(values: &[f64]) -> f64 {
    let mut time = 1.0_f64;
    for lag in 1..values.len() {
        if lag as f64 >= WINDOW * time.max(1.0) {
            break;
        }
        time += 2.0 * correlation(values, lag);
    }
    time.max(1.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Mean half width over the true standard error of the mean: √(2.254² + ½ 1.5²), with the noise t exp(−C/8) = 2.254,
    /// C = 0.645 (1/12 + 625/2288) = 0.230 for 12 pairs, t = 2.32 for 2/(exp C − 1) = 7.7 degrees of freedom, and exp(−C/8) the mean of √p₀
    /// whose logarithm is normal; and the ends, whose variance is half of that of the mean.
    const MEAN_WIDTH: f64 = 2.491;

    /// Numbers that look normal and are the same every time.
    struct Noise(u64);

    impl Noise {
        fn uniform(&mut self) -> f64 {
            // xorshift64* (Vigna 2016)
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
        }

        /// Sum of twelve: variance 1.
        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
        }
    }

    /// x ← φ x + e, which has the mean 0, after `settle` steps.
    fn series(seed: u64, phi: f64, count: usize) -> impl Iterator<Item = f64> {
        let mut noise = Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let mut x = noise.normal() / (1.0 - phi * phi).sqrt();
        (0..count).map(move |_| {
            x = phi * x + noise.normal();
            x
        })
    }

    fn of(values: impl Iterator<Item = f64>) -> Option<Steadiness> {
        let mut batches = Batches::default();
        values.for_each(|value| batches.push(value));
        batches.steadiness()
    }

    /// The intervals hold the true mean, 0, as often as they say, for noise that is independent and for noise that is not.
    #[test]
    fn intervals_hold_the_mean_as_often_as_they_say() {
        for (phi, count) in [(0.0, 500), (0.5, 1000), (0.9, 4000), (0.98, 20_000)] {
            let seeds = 1..=400;
            let held = seeds.filter(|&seed| {
                let found = of(series(seed, phi, count)).unwrap();
                found.mean.abs() < found.half_width
            });
            let share = held.count() as f64 / 400.0;
            assert!((0.90..0.985).contains(&share), "{phi}: {share}");
        }
    }

    /// s/√n of independent numbers with variance 1, and √((1 + φ)/(1 − φ)) times that of numbers that go on.
    #[test]
    fn half_widths_are_those_of_theory() {
        for (phi, count) in [(0.0_f64, 2000_u32), (0.9, 20_000)] {
            let widths = (1..=200).map(|seed| of(series(seed, phi, count as usize)).unwrap());
            let mean = widths.map(|found| found.half_width).sum::<f64>() / 200.0;
            // 2.491 σ_e/(1 − φ)/√n
            let theory = MEAN_WIDTH / (1.0 - phi) / f64::from(count).sqrt();
            assert!(
                (mean / theory - 1.0).abs() < 0.05,
                "{phi}: {mean}, {theory}"
            );
        }
    }

    /// Teeth and cams, whose periods fit into no batch, do not widen the interval by much.
    #[test]
    fn what_repeats_counts_little() {
        let (count, mut held, mut width) = (4000, 0, 0.0);
        for seed in 1..=200_u32 {
            let phase = f64::from(seed);
            let wave = |i: usize| 5.0 * (TAU * i as f64 / 61.7 + phase).sin();
            let noise = series(seed.into(), 0.5, count).enumerate();
            let found = of(noise.map(|(i, x)| x + wave(i))).unwrap();
            held += usize::from(found.mean.abs() < found.half_width);
            width += found.half_width / 200.0;
        }
        // 2.491 σ_e/(1 − φ)/√n of the noise alone
        let theory = MEAN_WIDTH / 0.5 / f64::sqrt(4000.0);
        assert!(held >= 176, "{held}");
        assert!(
            (0.95..1.15).contains(&(width / theory)),
            "{width}, {theory}"
        );
    }

    /// A motion that repeats, begun anywhere: what the ends of the record cut off is in the interval, which stays as narrow as that.
    #[test]
    fn what_ends_cut_off_a_period_is_told() {
        for periods in [2.3, 5.6, 17.4, 38.2, 77.7] {
            let (count, mut held, mut worst) = (4000, 0, 0.0_f64);
            for start in 0..200_u32 {
                let wave = |i: usize| {
                    let at = TAU * (periods * i as f64 / count as f64 + f64::from(start) / 200.0);
                    at.sin() + 0.3 * (2.0 * at).sin()
                };
                let noise = series(u64::from(start) + 1, 0.5, count).enumerate();
                let found = of(noise.map(|(i, x)| 1e-3 * x + wave(i))).unwrap();
                held += usize::from(found.mean.abs() <= found.half_width);
                worst = worst.max(found.half_width);
            }
            assert!(held >= 190, "{periods} periods: {held}");
            // A/(π m) of both waves. In shorter records the line through the spectrum meets the motion itself.
            let ends = 1.3 / (PI * periods);
            let room = if periods < 24.0 { 9.0 } else { 2.0 };
            assert!(worst < room * ends, "{periods} periods: {worst}, {ends}");
        }
    }

    #[test]
    fn students_t_is_that_of_tables() {
        for (freedom, t) in [(4.0, 2.776_445), (10.0, 2.228_139), (19.0, 2.093_024)] {
            assert!((students(freedom) / t - 1.0).abs() < 1e-3, "{freedom}");
        }
    }

    #[test]
    fn steady_noise_is_called_steady() {
        let steady = (1..=400).filter(|&seed| of(series(seed, 0.5, 3000)).unwrap().is_steady);
        assert!(steady.count() > 370);
    }

    #[test]
    fn a_transient_is_cut_off() {
        let mut steady = 0;
        for seed in 1..=100 {
            let noise = series(seed, 0.5, 4000).enumerate();
            let found = of(noise.map(|(i, x)| x + 60.0 * (-(i as f64) / 150.0).exp())).unwrap();
            steady += usize::from(found.is_steady);
            // It has decayed to the size of the noise after 4 time constants.
            assert!((0.08..0.5).contains(&found.before), "{seed}: {found:?}");
            assert!(
                found.mean.abs() < 2.0 * found.half_width,
                "{seed}: {found:?}"
            );
        }
        assert!(steady > 95);
    }

    #[test]
    fn a_drift_is_no_steady_state() {
        for seed in 1..=50 {
            let noise = series(seed, 0.5, 4000).enumerate();
            let found = of(noise.map(|(i, x)| x + 10.0 * i as f64 / 4000.0)).unwrap();
            assert!(!found.is_steady, "{seed}: {found:?}");
        }
    }

    #[test]
    fn what_is_constant_is_known() {
        let found = of((0..1000).map(|_| 17.25)).unwrap();
        assert_eq!(found.half_width.to_bits(), 0);
        assert!(found.is_steady && found.is_independent, "{found:?}");
        assert!((found.mean - 17.25).abs() < 1e-12);
    }

    #[test]
    fn few_samples_say_nothing() {
        assert_eq!(of(series(1, 0.0, 19)), None);
        assert!(of(series(1, 0.0, 20)).is_some());
    }

    /// A swing that lasts for a quarter of the run is not known from it, and one that fills it is not steady.
    #[test]
    fn batches_that_go_together_are_told() {
        let doubted = (1..=100).filter(|&seed| {
            let found = of(series(seed, 0.999, 4000)).unwrap();
            !found.is_independent || !found.is_steady
        });
        let doubted = doubted.count();
        assert!(doubted > 80, "{doubted}");
        let slow = |i: usize| (TAU * i as f64 / 3000.0).sin();
        let found = of((0..3000).map(slow)).unwrap();
        assert!(!found.is_steady, "{found:?}");
    }

    /// Memory stays what it is, and means of joined batches are those of their samples.
    #[test]
    fn batches_are_joined() {
        let mut batches = Batches::default();
        (0..100_000_u32).for_each(|i| batches.push(f64::from(i)));
        assert!(batches.means.len() < MOST);
        assert!((batches.means[0] - 0.5 * (batches.length - 1) as f64).abs() < 1e-9);
    }
}
