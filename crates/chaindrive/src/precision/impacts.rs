//! Errors of the impacts of rollers, by the same impacts of a sharper run.
//!
//! A blow that lasts a few steps is not resolved by them: its force errs by a share that belongs to the step, and by one that belongs to where
//! within a step it began. Both runs have the same impacts, one a roller and passage, so that what chance makes of the sample cancels:
//!
//! ```text
//! xᵢ = ln (F of the run / F of the sharper run),   i: impacts that both have,   c: error over difference
//! b = c x̄,   s = σ/√n                              of one sprocket; σ: scatter about the means of the sprockets, of all of them
//! p50: |exp(−b) − 1| ⊕ s
//! p99: the same with x̄ + z (σ_run − σ_sharper),   z = 2.326,   σ_run: scatter of ln F
//! ```

use chaindrive_mechanics::Impact;

use super::trace::Trace;

/// The normal variate that 1 % exceed.
const OF_P99: f64 = 2.326_348;

/// Relative errors of the impacts on one sprocket \[–\], of what the run says.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpactErrors {
    /// Name of the sprocket.
    pub sprocket: String,
    /// Impacts that run and sharper run both had.
    pub compared: usize,
    /// Of the median of the largest forces.
    pub p50: f64,
    /// Of their 99th percentile, and of the greatest.
    pub p99: f64,
    /// Of the median of the impulses.
    pub impulse: f64,
    /// Of the median of the closing speeds.
    pub speed: f64,
}

impl ImpactErrors {
    /// Of a run, by a sharper one, of all sprockets with impacts that both have; `factor`: error over difference.
    pub(super) fn of(run: &Trace, sharper: &Trace, names: &[String], factor: f64) -> Vec<Self> {
        let pairs = pairs(run, sharper);
        let force = Spread::of(&pairs, names.len(), |it| it.peak_force);
        let impulse = Spread::of(&pairs, names.len(), |it| it.impulse);
        let speed = Spread::of(&pairs, names.len(), |it| it.speed);
        let of = |(index, name): (usize, &String)| Self {
            sprocket: name.clone(),
            compared: force.places[index].0,
            p50: force.error(index, 0.0, factor),
            p99: force.error(index, OF_P99, factor),
            impulse: impulse.error(index, 0.0, factor),
            speed: speed.error(index, 0.0, factor),
        };
        let all = names.iter().enumerate().map(of);
        all.filter(|errors| errors.compared > 0).collect()
    }

    /// Names as those of statistics in results, and errors.
    pub fn columns(&self) -> [(&'static str, f64); 4] {
        [
            ("impact_force_p50", self.p50),
            ("impact_force_p99", self.p99),
            ("impact_impulse", self.impulse),
            ("impact_speed", self.speed),
        ]
    }

    /// The largest of forces and impulses, of some sprockets.
    pub(super) fn largest_of(errors: &[Self]) -> Option<f64> {
        let largest = errors.iter().map(|it| it.p50.max(it.p99).max(it.impulse));
        largest.reduce(f64::max)
    }
}

/// Impacts of the same roller on the same sprocket, in the same passage.
fn pairs<'a>(run: &'a Trace, sharper: &'a Trace) -> Vec<[&'a Impact; 2]> {
    let end = run.end().min(sharper.end());
    let within = |it: &&Impact| it.time < end;
    let mut pairs = Vec::new();
    for one in run.impacts.iter().filter(within) {
        let same = |it: &&Impact| (it.sprocket, it.roller) == (one.sprocket, one.roller);
        let mut found = sharper.impacts.iter().filter(within).filter(same);
        // Within a window of some teeth a roller comes once; what came twice is not told apart.
        if let (Some(other), None) = (found.next(), found.next()) {
            pairs.push([one, other]);
        }
    }
    pairs
}

/// Differences of the logarithms of one quantity.
struct Spread {
    /// Number of impacts, and mean difference, by sprocket.
    places: Vec<(usize, f64)>,
    /// Scatter of the difference about that.
    scatter: f64,
    /// Scatter in the run less that in the sharper run.
    wider: f64,
    /// Impacts on all sprockets.
    count: f64,
}

impl Spread {
    fn of(pairs: &[[&Impact; 2]], sprockets: usize, quantity: fn(&Impact) -> f64) -> Self {
        let mut logs: Vec<Vec<[f64; 2]>> = vec![Vec::new(); sprockets];
        for pair in pairs {
            let log = pair.map(|it| quantity(it).ln());
            if log.iter().all(|it| it.is_finite()) {
                logs[pair[0].sprocket].push(log);
            }
        }
        let apart = |log: &[f64; 2]| log[0] - log[1];
        let of = |values: &[[f64; 2]], part: fn(&[f64; 2]) -> f64| {
            let count = values.len().max(1) as f64;
            let mean = values.iter().map(part).sum::<f64>() / count;
            let squares: f64 = values.iter().map(|it| (part(it) - mean).powi(2)).sum();
            (mean, squares)
        };
        // One freedom a sprocket goes into its mean.
        let freedoms: usize = logs.iter().map(|it| it.len().saturating_sub(1)).sum();
        let scatter = |part: fn(&[f64; 2]) -> f64| {
            let squares: f64 = logs.iter().map(|values| of(values, part).1).sum();
            (squares / freedoms.max(1) as f64).sqrt()
        };
        Self {
            places: logs
                .iter()
                .map(|values| (values.len(), of(values, apart).0))
                .collect(),
            scatter: scatter(apart),
            wider: scatter(|log| log[0]) - scatter(|log| log[1]),
            count: logs.iter().map(Vec::len).sum::<usize>().max(1) as f64,
        }
    }

    /// Error of a quantile of one sprocket, `z`: the normal variate of the quantile.
    fn error(&self, sprocket: usize, z: f64, factor: f64) -> f64 {
        let (count, mean) = self.places[sprocket];
        if count == 0 {
            return f64::NAN;
        }
        // Var of x̄ = σ²/n, and of a difference of two scatters at most σ²/2N
        let doubt = self.scatter * (1.0 / count as f64 + z * z / (2.0 * self.count)).sqrt();
        let bias = factor * (mean + z * self.wider);
        ((-bias).exp() - 1.0).hypot(doubt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impact(roller: usize, peak_force: f64) -> Impact {
        Impact {
            sprocket: roller % 2,
            roller,
            time: 1e-3 * roller as f64,
            speed: 1.0,
            peak_force,
            impulse: 2.0,
        }
    }

    fn trace(impacts: Vec<Impact>) -> Trace {
        Trace {
            time: vec![0.0, 1.0],
            impacts,
            ..Trace::default()
        }
    }

    /// Forces that are a tenth too large, everywhere, with a factor of 4/3: e^(4/3 ln 1.1) − 1 = 13.5 % too large, 11.9 % of what is said.
    #[test]
    fn a_share_that_all_have_is_the_error() {
        let sharper = (0..20).map(|i| impact(i, 100.0 + i as f64));
        let sharper: Vec<_> = sharper.collect();
        let run = sharper.iter().map(|it| Impact {
            peak_force: 1.1 * it.peak_force,
            ..*it
        });
        let (run, sharper) = (trace(run.collect()), trace(sharper));
        let names = ["a", "b", "c"].map(str::to_owned);
        let found = ImpactErrors::of(&run, &sharper, &names, 4.0 / 3.0);
        assert_eq!(found.len(), 2, "{found:?}");
        for errors in found {
            assert_eq!(errors.compared, 10);
            assert!((errors.p50 - 0.119_34).abs() < 1e-4, "{errors:?}");
            assert!((errors.p99 - errors.p50).abs() < 1e-9, "{errors:?}");
            assert!(errors.impulse < 1e-12 && errors.speed < 1e-12);
        }
    }

    /// Errors that scatter leave the median alone, but for its standard error, and spread the largest.
    #[test]
    fn scatter_counts_for_the_largest() {
        let swing = |i: usize| if i % 4 < 2 { 0.2_f64 } else { -0.2 };
        let sharper: Vec<_> = (0..80).map(|i| impact(i, 100.0)).collect();
        let run = (0..80).map(|i| impact(i, 100.0 * swing(i).exp()));
        let (run, sharper) = (trace(run.collect()), trace(sharper));
        let names = ["a", "b"].map(str::to_owned);
        for errors in ImpactErrors::of(&run, &sharper, &names, 1.0) {
            // σ = 0.2 √(80/78), over √40
            assert!((errors.p50 - 0.032).abs() < 1e-3, "{errors:?}");
            // 1 − exp(−2.326 · 0.2)
            assert!((errors.p99 - 0.39).abs() < 0.02, "{errors:?}");
        }
    }

    #[test]
    fn impacts_that_one_run_lacks_are_left_out() {
        let run = trace(vec![impact(0, 1.0), impact(2, 2.0)]);
        let sharper = trace(vec![impact(0, 1.0), impact(4, 3.0)]);
        let names = ["a".to_owned()];
        let found = ImpactErrors::of(&run, &sharper, &names, 1.0);
        assert_eq!(found[0].compared, 1);
        assert!(ImpactErrors::of(&run, &trace(Vec::new()), &names, 1.0).is_empty());
    }
}
