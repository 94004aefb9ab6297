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
use super::waves::WaveFit;

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

impl Steadiness {
    /// With what may be left of the start in the mean and in quantiles.
    #[must_use]
    pub(super) fn and_start(mut self, left: f64) -> Self {
        for known in [&mut self.mean, &mut self.p1, &mut self.p99] {
            known.half_width = known.half_width.hypot(left);
        }
        self
    }
}

impl Blocks {
    /// Statistics with their intervals; `scale`: of errors and drifts. None without a sample.
    pub(crate) fn steadiness(&self, scale: f64) -> Option<Steadiness> {
        let found = self.statistics()?;
        let (whole, length) = self.whole();
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
        let told = self.told(&all);
        let waves = all.waves(&told);
        let means = whole.iter().map(|it| it.mean_without(&waves));
        let cut = truncation(&means.collect::<Vec<_>>());
        let settled = self.values(&sum(&whole[cut..]), &told)[0];
        let range = self.range(&all);
        let spreads = [0, 1, 2, 3].map(|k| self.spread(&whole, &all, &told, found.values, k));
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
            from: cut as f64 * length,
            is_steady,
        })
    }

    fn values(&self, block: &Block, told: &WaveFit) -> [f64; 4] {
        let found = self.moments(block, told);
        found.map_or([f64::NAN; 4], |it| it.values)
    }

    /// Scatter of one statistic between blocks.
    fn spread(
        &self,
        whole: &[Block],
        all: &Block,
        told: &WaveFit,
        values: [f64; 4],
        k: usize,
    ) -> Spread {
        let g = whole.len() as f64;
        // yᵢ = g θ − (g − 1) θ₍ᵢ₎
        let without =
            |block: &Block| g * values[k] - (g - 1.0) * self.values(&all.without(block), told)[k];
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
mod tests;
