//! Intervals of statistics over time, and their drift.
//!
//! Samples follow one another and are not independent, so their scatter says little about their mean. What counts is how much whole
//! [blocks](super::blocks) of periods differ. Each of g blocks is left out in turn (the jackknife; Künsch, *Annals of Statistics* **17**, 1989),
//! which serves the mean, the standard deviation and quantiles alike:
//!
//! ```text
//! yᵢ = g θ − (g − 1) θ₍ᵢ₎,   s² = Σ (yᵢ − ȳ)²/(g − 1),   half width² = (κ t s)² τ/g + Δ² + (grain)² + (start)² + (least)²
//! τ = (1 + ρ)/(1 − ρ),   ρ: correlation of neighbours yᵢ, yᵢ₊₁, less its bias of −1/g
//! ```
//!
//! t is Student's of (g − 1)/√τ degrees of freedom. What repeats makes all blocks alike, whatever part of a period the record ends with. κ is 1, and
//! 1.5 for quantiles, whose few blocks scatter less than they err. Δ is the drift of yᵢ from one half of the record to the other: what dies out goes
//! on by about as much after it. The grain is what one sample more or less makes of a quantile. The start, of the mean alone, is what it
//! moves by when the start of the run is cut off. The least is a share of the scale.
//!
//! A block or two may hold all that lies beyond a quantile. To leave one of a few blocks out then moves the quantile far, g − 1 times as far its yᵢ, and
//! t is 4 for three blocks and up to 13 for what is correlated: the interval would be wider than all samples lie apart. It tells nothing then, and the
//! half width of the quantile is unknown. Of a tension that hardly changes the least counts instead, however near its samples lie.
//!
//! The start of a run, before the steady state, is cut off where the standard error of the rest is least (MSER: White, *Simulation* **69**,
//! 1997):
//!
//! ```text
//! d = argmin Σ_{j>d} (b_j − x̄_d)²/(n − d)²,   d < n/2
//! ```
//!
//! The motion is not steady where mean or standard deviation drift, by more than chance and by more than counts.

use super::blocks::{Block, Blocks, LEAST, sum};

/// Times the 95 % interval of a drift that is taken for chance: 1 of 300 steady runs drifts by more.
const BY_CHANCE: f64 = 1.5;
/// Share of the scale that may drift between both halves, whatever its error. *Assumed*: what nobody reads off a tension.
pub(crate) const DRIFT: f64 = 0.01;
/// Least half widths of mean, standard deviation and quantiles, as shares of the scale. *Assumed*, by coverage: see the tests, and
/// `docs/precision.md`. Drives that are locked to their forcing keep such differences of their start, and free vibrations of a chain that die out over
/// hundreds of teeth move extremes more than means.
const LEAST_WIDTH: [f64; 4] = [2e-4, 1e-3, 5e-3, 5e-3];
/// Factor of quantiles. *Assumed*, by coverage.
const OF_QUANTILES: f64 = 1.5;
/// Bounds of the correlation of neighbours; below 0 only where there are blocks enough to see it.
const CORRELATION: [f64; 2] = [-0.5, 0.9];
const MANY: usize = 8;

/// A statistic with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfidenceInterval {
    /// Its value.
    pub value: f64,
    /// Half width of its 95 % interval; NaN below three periods, and of a quantile whose interval would be wider than all samples lie apart.
    pub half_width: f64,
}

/// Statistics over time, of whole periods of the slowest forcing, and whether the motion was steady.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Mean.
    pub mean: ConfidenceInterval,
    /// Standard deviation.
    pub deviation: ConfidenceInterval,
    /// Value below which 1 % of the time is.
    pub p1: ConfidenceInterval,
    /// The same of 99 %.
    pub p99: ConfidenceInterval,
    /// Mean without what comes before the steady state.
    pub settled: f64,
    /// When that ends \[s\].
    pub from: f64,
    /// Steady: neither mean nor standard deviation drifts.
    pub is_steady: bool,
}

impl Blocks {
    /// Statistics with their intervals; `scale`: of errors and drifts. None without a sample.
    pub(crate) fn steadiness(&self, scale: f64) -> Option<Steadiness> {
        let found = self.statistics()?;
        let whole = self.whole();
        if whole.len() < LEAST {
            let known = |k: usize| ConfidenceInterval {
                value: found.values[k],
                half_width: f64::NAN,
            };
            return Some(Steadiness {
                mean: known(0),
                deviation: known(1),
                p1: known(2),
                p99: known(3),
                settled: found.values[0],
                from: 0.0,
                is_steady: true,
            });
        }
        let all = sum(&whole);
        let means: Vec<f64> = whole.iter().map(|it| self.values(it)[0]).collect();
        let cut = truncation(&means);
        let settled = self.values(&sum(&whole[cut..]))[0];
        let range = self.range(&all);
        let spreads = [0, 1, 2, 3].map(|k| self.spread(&whole, &all, found.values, k));
        let steady = |it: &Spread| it.drift.abs() <= it.doubt.max(DRIFT * scale);
        let is_steady = spreads[..2].iter().all(steady);
        let known = |k: usize| {
            let factor = if k < 2 { 1.0 } else { OF_QUANTILES };
            let grain = if k < 2 { 0.0 } else { found.grain[k - 2] };
            let start = if k == 0 {
                found.values[0] - settled
            } else {
                0.0
            };
            let of_chance = factor * students(spreads[k].freedom) * spreads[k].error;
            let parts = [of_chance, spreads[k].drift, grain, start];
            let of_record = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            let least = LEAST_WIDTH[k] * scale;
            let tells_nothing = k >= 2 && of_record > range.max(least);
            ConfidenceInterval {
                value: found.values[k],
                half_width: if tells_nothing {
                    f64::NAN
                } else {
                    of_record.hypot(least)
                },
            }
        };
        Some(Steadiness {
            mean: known(0),
            deviation: known(1),
            p1: known(2),
            p99: known(3),
            settled,
            from: cut as f64 * self.length(),
            is_steady,
        })
    }

    fn values(&self, block: &Block) -> [f64; 4] {
        self.moments(block).map_or([f64::NAN; 4], |it| it.values)
    }

    /// Scatter of one statistic between blocks.
    fn spread(&self, whole: &[&Block], all: &Block, values: [f64; 4], k: usize) -> Spread {
        let g = whole.len() as f64;
        // yᵢ = g θ − (g − 1) θ₍ᵢ₎
        let without =
            |block: &&Block| g * values[k] - (g - 1.0) * self.values(&all.without(block))[k];
        let pseudo: Vec<f64> = whole.iter().map(without).collect();
        let [least, most] = CORRELATION;
        let least = if whole.len() >= MANY { least } else { 0.0 };
        let (error, inflation) = scatter(&pseudo, [least, most]);
        let (drift, doubt) = drift(&pseudo);
        Spread {
            error,
            freedom: (g - 1.0) / inflation.max(1.0).sqrt(),
            drift,
            doubt,
        }
    }
}

/// Standard error of the mean of values that follow one another, and τ; `bounds` of the correlation of neighbours.
fn scatter(values: &[f64], [least, most]: [f64; 2]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|y| (y - mean).powi(2)).sum();
    let neighbours = values.windows(2).map(|y| (y[0] - mean) * (y[1] - mean));
    let correlation = neighbours.sum::<f64>() / squares + 1.0 / n;
    // Nothing scatters: nothing is correlated.
    let correlation = if correlation.is_nan() {
        0.0
    } else {
        correlation
    };
    let correlation = correlation.clamp(least, most);
    let inflation = (1.0 + correlation) / (1.0 - correlation);
    ((squares / (n - 1.0) * inflation / n).sqrt(), inflation)
}

/// Change from one half of the values to the other along their straight line, and what of it may be chance.
///
/// ```text
/// Δ = ½ n β,   β = Σ xᵢ yᵢ/Σ xᵢ²,   xᵢ = i − ī,   σ_β² = Σ rᵢ² τ/((n − 2) Σ xᵢ²),   r: what the line leaves
/// ```
pub(crate) fn drift(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let along = || (0..values.len()).map(|i| i as f64 - middle);
    let spread: f64 = along().map(|x| x * x).sum();
    let slope = along().zip(values).map(|(x, y)| x * y).sum::<f64>() / spread;
    let left: Vec<f64> = along()
        .zip(values)
        .map(|(x, y)| y - mean - slope * x)
        .collect();
    let (error, _) = scatter(&left, [0.0, CORRELATION[1]]);
    // The line takes two freedoms, the mean one.
    let freedom = n - 2.0;
    let sigma = error * (n * (n - 1.0) / (freedom * spread)).sqrt();
    let certain = BY_CHANCE * students(freedom) * sigma;
    (0.5 * n * slope, 0.5 * n * certain)
}

/// Uncertainty of a statistic.
struct Spread {
    /// Its standard error, and degrees of freedom.
    error: f64,
    freedom: f64,
    /// Change from one half of the record to the other, and what of it may be chance.
    drift: f64,
    doubt: f64,
}

/// Blocks before the steady state, fewer than half of them.
fn truncation(means: &[f64]) -> usize {
    let n = means.len();
    // Sums over what is left, from the end, about the last mean, so that nothing is lost where scatter is small.
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut best = (f64::INFINITY, 0);
    for d in (0..n).rev() {
        let x = means[d] - means[n - 1];
        sum += x;
        squares += x * x;
        if 2 * d >= n {
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

/// Student's t that is exceeded in 2.5 % of cases, of some degrees of freedom, at least one.
///
/// # Source
/// G. W. Hill, Algorithm 396, *Communications of the ACM* **13**, 1970, 619–620; to 1e-3 from 2 degrees on.
fn students(freedom: f64) -> f64 {
    const TWO_TAILS: f64 = 0.05;
    /// The normal variate that is exceeded in 2.5 % of cases.
    const NORMAL: f64 = 1.959_964;
    let n = freedom.max(1.0);
    let a = 1.0 / (n - 0.5);
    let b = 48.0 / (a * a);
    let mut c = ((20_700.0 * a / b - 98.0) * a - 16.0) * a + 96.36;
    let d = ((94.5 / (b + c) - 3.0) / b + 1.0) * (a * std::f64::consts::FRAC_PI_2).sqrt() * n;
    let mut y = (d * TWO_TAILS).powf(2.0 / n);
    if y > 0.05 + a {
        let x = -NORMAL;
        y = x * x;
        if n < 5.0 {
            c += 0.3 * (n - 4.5) * (x + 0.6);
        }
        c += (((0.05 * d * x - 5.0) * x - 7.0) * x - 2.0) * x + b;
        y = (((((0.4 * y + 6.3) * y + 36.0) * y + 94.5) / c - y - 3.0) / b + 1.0) * x;
        y = (a * y * y).exp_m1();
    } else {
        let z = 1.0 / (((n + 6.0) / (n * y) - 0.089 * d - 0.822) * (n + 2.0) * 3.0);
        y = ((z + 0.5 / (n + 4.0)) * y - 1.0) * (n + 1.0) / (n + 2.0) + 1.0 / y;
    }
    (n * y).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

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

    /// x ← φ x + e, which has the mean 0, in the steady state from the first one on.
    fn series(seed: u64, phi: f64, count: usize) -> impl Iterator<Item = f64> {
        let mut noise = Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let mut x = noise.normal() / (1.0 - phi * phi).sqrt();
        (0..count).map(move |_| {
            x = phi * x + noise.normal();
            x
        })
    }

    /// Of values that are one apart; what repeats has a period of so many.
    fn of(values: impl Iterator<Item = f64>, period: f64, scale: f64) -> Steadiness {
        let mut blocks = Blocks::new(1.0, period);
        values.enumerate().for_each(|(i, value)| {
            let i = i as f64;
            blocks.push([(i - 0.5).max(0.0), i + 0.5], value);
        });
        blocks.steadiness(scale).unwrap()
    }

    const STATISTICS: [fn(&Steadiness) -> ConfidenceInterval; 4] =
        [|it| it.mean, |it| it.deviation, |it| it.p1, |it| it.p99];

    /// Shares of the intervals that hold what is true, their median half widths, and the 95 % quantiles of the true errors.
    fn judged(true_values: [f64; 4], found: impl Iterator<Item = Steadiness>) -> [[f64; 3]; 4] {
        let found: Vec<Steadiness> = found.collect();
        std::array::from_fn(|k| {
            let known: Vec<ConfidenceInterval> = found.iter().map(STATISTICS[k]).collect();
            let mut errors: Vec<f64> = known
                .iter()
                .map(|it| (it.value - true_values[k]).abs())
                .collect();
            let held = known
                .iter()
                .zip(&errors)
                .filter(|(it, error)| **error <= it.half_width);
            let share = held.count() as f64 / known.len() as f64;
            let mut widths: Vec<f64> = known.iter().map(|it| it.half_width).collect();
            widths.sort_by(f64::total_cmp);
            errors.sort_by(f64::total_cmp);
            [
                share,
                widths[widths.len() / 2],
                errors[errors.len() * 95 / 100],
            ]
        })
    }

    /// Noise of any correlation: intervals hold the true statistics as often as they say, and are no wider than they need be. The 2.326 σ of a
    /// normal distribution are its quantiles. Intervals ten times as wide, or a third, fail.
    #[test]
    fn intervals_hold_as_often_as_they_say() {
        for (phi, count) in [(0.0_f64, 600), (0.5, 1500), (0.9, 5000), (0.98, 25_000)] {
            let sigma = 1.0 / (1.0 - phi * phi).sqrt();
            let quantile = 2.326_348 * sigma;
            let true_values = [0.0, sigma, -quantile, quantile];
            let seeds = 1..=(1_500_000 / count as u64).min(300);
            let found = judged(
                true_values,
                seeds.map(|seed| of(series(seed, phi, count), 25.0, 1e-9)),
            );
            for (k, [share, width, error]) in found.into_iter().enumerate() {
                // Of noise they hold more than of drives, whose drifts they are made for; that they are not too wide, the ratio tells.
                assert!(share > 0.88, "φ {phi}, {k}: {share}");
                let ratio = width / error;
                assert!((0.6..2.0).contains(&ratio), "φ {phi}, {k}: {ratio}");
            }
        }
    }

    /// A motion that repeats, with the teeth upon it, begun anywhere and ended anywhere: statistics are those of whole periods, and intervals no
    /// wider than a few times what is true, however few periods there are.
    #[test]
    fn what_repeats_is_known_from_three_periods_on() {
        for (periods, widest) in [(3.4, 3.0), (7.77, 3.0), (38.2, 1.5), (120.6, 1.5)] {
            let period = 61.7;
            let wave = |i: usize, phase: f64| {
                let turn = TAU * i as f64 / period + phase;
                20.0 + 5.0 * turn.sin() + 2.0 * (7.0 * turn).cos()
            };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a count"
            )]
            let count = (periods * period) as usize;
            // σ² = ½ Σ A²
            let sigma = f64::sqrt(0.5 * (25.0 + 4.0));
            let of_phase = |phase: f64| of((0..count).map(|i| wave(i, phase)), period, 20.0);
            let phases = || (0..100_u32).map(f64::from);
            let means = phases()
                .map(of_phase)
                .map(|it| (it.mean.value - 20.0).abs());
            let worst = means.fold(0.0, f64::max);
            // The mean of all samples errs by up to A/(π m).
            assert!(worst < 0.02 * 5.0 / (PI * periods), "{periods}: {worst}");
            let found = judged([20.0, sigma, f64::NAN, f64::NAN], phases().map(of_phase));
            for ([share, width, error], least) in found.into_iter().zip(LEAST_WIDTH).take(2) {
                assert!(share >= 0.88, "{periods} periods: {share}");
                let least = least * 20.0;
                assert!(width < widest * error.max(least), "{width}, {error}");
            }
        }
    }

    #[test]
    fn fewer_than_three_periods_say_nothing() {
        let found = of(series(3, 0.5, 299), 100.0, 1.0);
        assert!(STATISTICS.iter().all(|it| it(&found).half_width.is_nan()));
        assert!(found.mean.value.is_finite() && found.p99.value > found.mean.value);
        let found = of(series(3, 0.5, 301), 100.0, 1.0);
        assert!(STATISTICS.iter().all(|it| it(&found).half_width > 0.0));
    }

    /// One of three periods dips: whether 1 % of the time lies in such dips or none does, three periods do not tell, and the interval of p1 is not said to
    /// be wider than all samples. Twenty periods tell. What hardly changes is known by the least width, which is wider than its samples lie apart.
    #[test]
    fn an_interval_is_unknown_where_it_would_be_wider_than_all_samples() {
        let dips = |i: usize, every: usize, by: f64| {
            let wave = (TAU * i as f64 / 100.0).sin();
            100.0 + wave
                - if i / 100 % every == 1 && i % 100 > 90 {
                    by
                } else {
                    0.0
                }
        };
        let short = of((0..301).map(|i| dips(i, 3, 20.0)), 100.0, 100.0);
        assert!(short.p1.half_width.is_nan(), "{short:?}");
        assert!(
            short.mean.half_width > 0.0 && short.p99.half_width < 22.0,
            "{short:?}"
        );
        let long = of((0..2101).map(|i| dips(i, 3, 20.0)), 100.0, 100.0);
        assert!(long.p1.half_width < 22.0, "{long:?}");
        let nearly = of(
            (0..301).map(|i| dips(i, 3, 0.0) * 1e-3 + 99.9),
            100.0,
            100.0,
        );
        assert!((nearly.p1.half_width - 0.5).abs() < 1e-3, "{nearly:?}");
    }

    /// A drift that counts is told, one that nobody would read is not, however sure it is.
    #[test]
    fn drifts_that_count_are_told() {
        let settling = |size: f64| {
            let drift =
                move |(i, x): (usize, f64)| 100.0 + 0.01 * x + size * (-(i as f64) / 3000.0).exp();
            of(series(5, 0.5, 4000).enumerate().map(drift), 50.0, 100.0)
        };
        assert!(settling(0.0).is_steady && settling(1.0).is_steady);
        assert!(!settling(20.0).is_steady);
        let growing =
            (0..4000).map(|i| (1.0 + f64::from(i) / 4000.0) * (TAU * f64::from(i) / 50.0).sin());
        assert!(!of(growing, 50.0, 1.0).is_steady, "its deviation grows");
    }

    /// A start that dies away is cut off, and what it does to the mean is in the interval.
    #[test]
    fn the_start_is_cut_off() {
        let start = |i: usize| 30.0 * (-(i as f64) / 150.0).exp();
        let noise = series(11, 0.5, 6000).enumerate();
        let found = of(noise.map(|(i, x)| 100.0 + x + start(i)), 50.0, 100.0);
        assert!(found.from > 200.0 && found.from < 3000.0, "{found:?}");
        assert!((found.settled - 100.0).abs() < 0.2, "{found:?}");
        assert!((found.mean.value - 100.0).abs() < found.mean.half_width);
    }

    #[test]
    fn a_constant_is_known() {
        let found = of(std::iter::repeat_n(5.0, 1000), 10.0, 0.0);
        assert!(found.is_steady && found.mean.half_width.abs() < 1e-9);
        assert!((found.mean.value - 5.0).abs() < 1e-12 && found.deviation.value < 1e-9);
    }

    /// Published: Abramowitz and Stegun, *Handbook of Mathematical Functions*, table 26.10.
    #[test]
    fn students_t_is_that_of_the_tables() {
        for (freedom, t) in [
            (2.0, 4.303),
            (3.0, 3.182),
            (5.0, 2.571),
            (10.0, 2.228),
            (30.0, 2.042),
        ] {
            assert!(
                (students(freedom) - t).abs() < 2e-3,
                "{freedom}: {}",
                students(freedom)
            );
        }
    }
}
