//! How far two traces of one drive are apart: sample by sample, and in their statistics.

use super::trace::{Strands, Trace};

/// A statistic of two runs, and of two runs that differ by nothing but chance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Relative difference between the run and its shadow \[–\]; NaN where there is nothing to compare.
    pub difference: f64,
    /// Relative difference between the run and its twin, which started 1e-12 m apart \[–\].
    pub spread: f64,
}

impl Comparison {
    /// Whether the difference is no larger than what chance makes of equal runs.
    pub fn within_spread(&self) -> bool {
        self.difference <= self.spread
    }
}

/// Distance of two traces at one sample, over the mean tension of the samples that both have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Distance {
    /// Root mean square over the strands \[–\]; infinite where a tension is not a number.
    pub(super) all: f64,
    /// Of the tight strand alone \[–\].
    pub(super) tight: f64,
}

/// Distances at all samples that both traces have.
///
/// ```text
/// d = √(Σ (Tₖ − T′ₖ)² / n) / T̄′
/// ```
///
/// A tension that is not a number agrees with nothing, not even with another one: compare traces by [`Strands`]
/// that all of them have. The mean is that of the samples compared: the tension may rise a hundredfold behind them.
pub(super) fn distances(of: &Trace, from: &Trace, strands: Strands) -> Vec<Distance> {
    let samples = of.len().min(from.len());
    let scale = from.tensions(strands).mean_of_first(samples);
    distances_over(of, from, strands, scale)
}

/// The same over another scale \[N\].
pub(super) fn distances_over(
    of: &Trace,
    from: &Trace,
    strands: Strands,
    scale: f64,
) -> Vec<Distance> {
    let samples = of.len().min(from.len());
    let (of, from) = (of.tensions(strands), from.tensions(strands));
    let (n, tight) = (from.strands, from.tight());
    (0..samples)
        .map(|sample| {
            let apart = |strand: usize| {
                let place = sample * n + strand;
                let apart = (of.values[place] - from.values[place]).abs();
                if apart.is_finite() {
                    apart
                } else {
                    f64::INFINITY
                }
            };
            Distance {
                all: rms((0..n).map(apart)) / scale,
                tight: if n > 0 { apart(tight) / scale } else { 0.0 },
            }
        })
        .collect()
}

/// Root mean square difference of the tensions of two traces over their first samples \[N\].
pub(super) fn difference(of: &Trace, from: &Trace, strands: Strands, samples: usize) -> f64 {
    let (of, from) = (of.tensions(strands), from.tensions(strands));
    let count = samples * from.strands;
    let pairs = of.values.iter().zip(&from.values).take(count);
    rms(pairs.map(|(a, b)| a - b))
}

/// Root mean square of values.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// Statistics of one trace.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Account {
    /// Mean tension of every strand \[N\].
    pub(super) mean: Vec<f64>,
    /// Root mean square of the tension of every strand \[N\].
    pub(super) rms: Vec<f64>,
    /// 50th, 90th and 99th percentile of the forces of closed contacts \[N\]; NaN without contacts.
    pub(super) force: [f64; 3],
}

/// Percentiles of the contact forces that are compared.
pub(super) const PERCENTILES: [f64; 3] = [0.5, 0.9, 0.99];

impl Account {
    /// Of the first samples of a trace.
    pub(super) fn of(trace: &Trace, samples: usize, strands: Strands) -> Self {
        let samples = samples.min(trace.len());
        let tensions = trace.tensions(strands);
        let moment = |power: i32| -> Vec<f64> {
            let of = |strand: usize| {
                let values = tensions.of(strand).take(samples);
                values.map(|value| value.powi(power)).sum::<f64>() / samples.max(1) as f64
            };
            (0..tensions.strands).map(of).collect()
        };
        let rollers = trace.force.len() / trace.len().max(1);
        let mut forces: Vec<f64> = trace.force[..samples * rollers]
            .iter()
            .copied()
            .filter(|force| *force > 0.0)
            .collect();
        forces.sort_unstable_by(f64::total_cmp);
        Self {
            mean: moment(1),
            rms: moment(2).into_iter().map(f64::sqrt).collect(),
            force: PERCENTILES.map(|share| percentile(&forces, share)),
        }
    }

    /// Largest difference of the strands' means from those of another trace, over the mean of all \[–\].
    pub(super) fn mean_apart(&self, from: &Self) -> f64 {
        apart(&self.mean, &from.mean)
    }

    /// The same of the root mean squares.
    pub(super) fn rms_apart(&self, from: &Self) -> f64 {
        apart(&self.rms, &from.rms)
    }

    /// Relative differences of the percentiles.
    pub(super) fn force_apart(&self, from: &Self) -> [f64; 3] {
        [0, 1, 2].map(|k| (self.force[k] - from.force[k]).abs() / from.force[k])
    }
}

/// Standard deviation, 1st and 99th percentile of the tension of every strand of a trace \[N\].
pub(super) struct Scatter {
    values: [Vec<f64>; 3],
    /// Mean tension of all strands, which differences are relative to.
    scale: f64,
}

impl Scatter {
    /// Of the first samples of a trace.
    pub(super) fn of(trace: &Trace, samples: usize, strands: Strands) -> Self {
        let samples = samples.min(trace.len());
        let tensions = trace.tensions(strands);
        let mut scatter = Self {
            values: Default::default(),
            scale: tensions.mean_of_first(samples),
        };
        for strand in 0..tensions.strands {
            let mut sorted: Vec<f64> = tensions.of(strand).take(samples).collect();
            sorted.sort_unstable_by(f64::total_cmp);
            let mean = sorted.iter().sum::<f64>() / samples.max(1) as f64;
            let deviation = rms(sorted.iter().map(|value| value - mean));
            let found = [
                deviation,
                percentile(&sorted, 0.01),
                percentile(&sorted, 0.99),
            ];
            for (values, found) in scatter.values.iter_mut().zip(found) {
                values.push(found);
            }
        }
        scatter
    }

    /// Largest differences from another trace, of each, over the mean tension \[–\].
    pub(super) fn apart(&self, from: &Self) -> [f64; 3] {
        let largest = |k: usize| {
            let pairs = self.values[k].iter().zip(&from.values[k]);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / from.scale
        };
        [0, 1, 2].map(largest)
    }
}

fn apart(of: &[f64], from: &[f64]) -> f64 {
    let scale = from.iter().map(|value| value.abs()).sum::<f64>() / from.len() as f64;
    let apart = || of.iter().zip(from).map(|(a, b)| (a - b).abs());
    // `f64::max` forgets what is not a number.
    if apart().any(f64::is_nan) {
        return f64::INFINITY;
    }
    apart().fold(0.0, f64::max) / scale
}

/// The value below which a share of sorted values lies; NaN of none.
pub(super) fn percentile(sorted: &[f64], share: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in the list"
    )]
    let place = (share * sorted.len() as f64) as usize;
    let last = sorted.len().wrapping_sub(1);
    sorted.get(place.min(last)).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Defect A3: a span that no roller holds agreed with everything.
    #[test]
    fn what_is_not_a_number_agrees_with_nothing() {
        let trace = |values: [f64; 4]| {
            let mut trace = Trace {
                time: vec![0.0, 1.0],
                ..Trace::default()
            };
            trace.spans.values = values.into();
            trace.spans.strands = 2;
            trace
        };
        let whole = trace([1.0, 2.0, 1.0, 2.0]);
        let torn = trace([1.0, 2.0, f64::NAN, 2.0]);
        for (of, from) in [(&whole, &torn), (&torn, &whole), (&torn, &torn)] {
            let found = distances(of, from, Strands::Spans);
            assert!(found[0].all < 1e-12 && found[1].all.is_infinite());
            let account = |trace: &Trace| Account::of(trace, usize::MAX, Strands::Spans);
            assert!(account(of).mean_apart(&account(from)) > 1e12);
            assert!(account(of).rms_apart(&account(from)) > 1e12);
        }
    }

    /// Twice the swing about the same mean: σ of 0, …, 100 is √((101² − 1)/12) = 29.15.
    #[test]
    fn scatter_is_compared_over_the_mean_tension() {
        let trace = |swing: f64| {
            let mut trace = Trace {
                time: (0..101).map(f64::from).collect(),
                ..Trace::default()
            };
            trace.spans.values = (0..101)
                .map(|i| 1000.0 + swing * f64::from(i - 50))
                .collect();
            trace.spans.strands = 1;
            trace
        };
        let [one, two] = [1.0, 2.0].map(|it| Scatter::of(&trace(it), 101, Strands::Spans));
        let [deviation, p1, p99] = two.apart(&one);
        assert!((deviation - 0.029_15).abs() < 1e-5, "{deviation}");
        assert!((p1 - 0.049).abs() < 1e-9 && (p99 - 0.049).abs() < 1e-9);
    }

    #[test]
    fn percentiles_of_a_hundred_numbers() {
        let sorted: Vec<f64> = (0..100).map(f64::from).collect();
        let found = PERCENTILES.map(|share| percentile(&sorted, share));
        assert!(
            found
                .iter()
                .zip([50.0, 90.0, 99.0])
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        assert!(percentile(&[], 0.5).is_nan());
    }
}
