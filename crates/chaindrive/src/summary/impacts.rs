//! Impacts of rollers that came to a sprocket.

use chaindrive_mechanics::Impact;
use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

use super::{COUNTS_PER_NEWTON, histogram, value_counts};
use crate::Simulation;

/// Impacts on one sprocket: the first contacts of rollers that came to it, each once a passage.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ImpactStatistics {
    /// The sprocket.
    pub sprocket: String,
    /// Their number.
    pub count: u64,
    /// Largest force of all \[N\].
    pub greatest: f64,
    #[serde(with = "value_counts")]
    forces: Histogram<u64>,
    #[serde(with = "value_counts")]
    impulses: Histogram<u64>,
    #[serde(with = "value_counts")]
    speeds: Histogram<u64>,
}

/// Impulses are counted in µN s, speeds in µm/s.
const COUNTS_PER_NEWTON_SECOND: f64 = 1e6;
const COUNTS_PER_METRE_A_SECOND: f64 = 1e6;

impl ImpactStatistics {
    /// Nothing yet, for every sprocket.
    pub(super) fn of(simulation: &Simulation) -> Vec<Self> {
        let names = simulation.system().sprocket_names().into_iter();
        let none = |sprocket| Self {
            sprocket,
            count: 0,
            greatest: 0.0,
            forces: histogram(),
            impulses: histogram(),
            speeds: histogram(),
        };
        names.map(none).collect()
    }

    pub(super) fn push(&mut self, impact: &Impact) {
        self.count += 1;
        self.greatest = self.greatest.max(impact.peak_force);
        for (histogram, value) in [
            (&mut self.forces, impact.peak_force * COUNTS_PER_NEWTON),
            (
                &mut self.impulses,
                impact.impulse * COUNTS_PER_NEWTON_SECOND,
            ),
            (&mut self.speeds, impact.speed * COUNTS_PER_METRE_A_SECOND),
        ] {
            value_counts::note(histogram, value);
        }
    }

    /// A number of the impacts; NaN where nothing struck.
    pub(crate) fn of_any(&self, value: f64) -> f64 {
        if self.count > 0 { value } else { f64::NAN }
    }

    /// 99th percentile of the largest forces \[N\]; NaN where the impacts are too few to [tell](Self::tells) it.
    pub fn p99(&self) -> f64 {
        if self.tells(0.99) {
            self.force(0.99)
        } else {
            f64::NAN
        }
    }

    /// Whether there are impacts enough for a quantile above the median: at least one lies beyond it.
    ///
    /// ```text
    /// n (1 − q) ≥ 1
    /// ```
    ///
    /// Of fewer than 100 impacts the 99th percentile would be the greatest force of all, whatever their distribution.
    pub fn tells(&self, quantile: f64) -> bool {
        // 1 − q has its rounding.
        self.count as f64 * (1.0 - quantile) >= 1.0 - 1e-9
    }

    /// A quantile of the largest forces \[N\]; the greatest where the impacts are too few to [tell](Self::tells) it.
    pub fn force(&self, quantile: f64) -> f64 {
        // A class of the histogram reaches beyond the values that it counts.
        (self.forces.value_at_quantile(quantile) as f64 / COUNTS_PER_NEWTON).min(self.greatest)
    }

    /// A quantile of the impulses \[N s\].
    pub fn impulse(&self, quantile: f64) -> f64 {
        self.impulses.value_at_quantile(quantile) as f64 / COUNTS_PER_NEWTON_SECOND
    }

    /// A quantile of the closing speeds at touch, along the normal of the tooth \[m/s\].
    pub fn speed(&self, quantile: f64) -> f64 {
        self.speeds.value_at_quantile(quantile) as f64 / COUNTS_PER_METRE_A_SECOND
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 99 forces none lies beyond their 99th percentile but the greatest; of 100 one does.
    #[test]
    fn a_percentile_takes_as_many_impacts_as_it_leaves_one_beyond() {
        let mut statistics = ImpactStatistics {
            sprocket: "a".to_owned(),
            count: 0,
            greatest: 0.0,
            forces: histogram(),
            impulses: histogram(),
            speeds: histogram(),
        };
        for n in 1..=100 {
            statistics.push(&Impact {
                sprocket: 0,
                roller: n,
                time: 0.0,
                speed: 1.0,
                peak_force: n as f64,
                impulse: 1.0,
            });
            let (p99, greatest) = (statistics.p99(), statistics.greatest);
            assert!((greatest - n as f64).abs() < 1e-9);
            assert_eq!(p99.is_finite(), n == 100, "{n}: {p99}");
        }
        let p99 = statistics.p99();
        assert!((p99 - 99.0).abs() < 0.1, "{p99}");
    }
}
