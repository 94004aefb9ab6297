//! How far two traces of one drive are apart: sample by sample, and in their statistics.

use super::trace::Trace;

/// A statistic of two runs, and of two runs that differ by nothing but chance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compared {
    /// Relative difference between the run and its shadow \[–\]; NaN where there is nothing to compare.
    pub difference: f64,
    /// Relative difference between the run and its twin, which started 1e-12 m apart \[–\].
    pub spread: f64,
}

impl Compared {
    /// Whether the difference is no larger than what chance makes of equal runs.
    pub fn within_spread(&self) -> bool {
        self.difference <= self.spread
    }
}

/// Distance of two traces at one sample, over the mean tension.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Distance {
    /// Root mean square over the strands \[–\].
    pub(super) all: f64,
    /// Of the tight strand alone \[–\].
    pub(super) tight: f64,
}

/// Distances at all samples that both traces have.
pub(super) fn distances(of: &Trace, from: &Trace) -> Vec<Distance> {
    let (n, tight) = (from.strands, from.tight());
    let scale = from.mean_tension();
    (0..of.len().min(from.len()))
        .map(|sample| {
            let (mut sum, mut count) = (0.0, 0.0);
            for k in sample * n..(sample + 1) * n {
                let apart = of.tension[k] - from.tension[k];
                if apart.is_finite() {
                    sum += apart * apart;
                    count += 1.0;
                }
            }
            let apart = of.tension[sample * n + tight] - from.tension[sample * n + tight];
            Distance {
                all: f64::sqrt(sum / f64::max(count, 1.0)) / scale,
                tight: if apart.is_finite() {
                    apart.abs() / scale
                } else {
                    0.0
                },
            }
        })
        .collect()
}

/// Root mean square of distances \[–\].
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
    pub(super) fn of(trace: &Trace, samples: usize) -> Self {
        let n = trace.strands;
        let samples = samples.min(trace.len());
        let moment = |power: i32| -> Vec<f64> {
            let of = |strand: usize| {
                let values = (0..samples).map(|i| trace.tension[i * n + strand]);
                let values = values.filter(|value| value.is_finite());
                let (mut sum, mut count) = (0.0, 0.0);
                for value in values {
                    sum += value.powi(power);
                    count += 1.0;
                }
                sum / f64::max(count, 1.0)
            };
            (0..n).map(of).collect()
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

fn apart(of: &[f64], from: &[f64]) -> f64 {
    let scale = from.iter().map(|value| value.abs()).sum::<f64>() / from.len() as f64;
    let largest = of
        .iter()
        .zip(from)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    largest / scale
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
