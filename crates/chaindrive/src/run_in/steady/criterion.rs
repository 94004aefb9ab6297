//! Whether the motion is steady from a block on.

use super::sums::Sums;
use crate::summary::drift;

/// Largest drift or remaining creep, over the mean tension. *Assumed*: half of what a verdict speaks against.
pub(super) const DRIFT: f64 = 0.005;
/// Largest drift of a standard deviation, over itself. *Assumed*.
const SWING_DRIFT: f64 = 0.02;
/// Least drift of a standard deviation that counts, over the mean tension: a swing that nobody sees needs not die out. *Assumed*.
const LEAST_SWING_DRIFT: f64 = 2e-4;
/// Largest drift with its chance after [`UNCERTAIN_AFTER`] teeth, over the mean tension, and over a standard deviation. *Assumed*, by the coverage
/// of intervals after run-ins: see `docs/precision.md`.
const UNCERTAIN: [f64; 2] = [0.02, 0.2];
/// Teeth \[–\] that [`UNCERTAIN`] belongs to; it is less by as much as fewer were examined.
const UNCERTAIN_AFTER: f64 = 100.0;
/// Least scale of a span, over the mean tension of the tightest: what a slack span does is seen against that.
const LEAST_SCALE: f64 = 0.1;

/// One number a block.
type Series = Vec<f64>;

/// Means and standard deviations of the blocks so far.
#[derive(Default)]
pub(super) struct BlockSeries {
    pub(super) count: usize,
    /// By span: means of the tension, and its standard deviations within a block.
    means: Vec<Series>,
    deviations: Vec<Series>,
    /// By state that creeps: means.
    states: Vec<Series>,
}

impl BlockSeries {
    /// Takes in a block.
    pub(super) fn push(&mut self, spans: &[Sums], states: &[Sums]) {
        self.count += 1;
        for (all, sums, of) in [
            (&mut self.means, spans, Sums::mean as fn(&Sums) -> f64),
            (&mut self.deviations, spans, Sums::deviation),
            (&mut self.states, states, Sums::mean),
        ] {
            all.resize_with(sums.len(), Vec::new);
            for (series, sums) in all.iter_mut().zip(sums) {
                series.push(of(sums));
            }
        }
    }

    /// Whether nothing that counts changes from a block on, over so many teeth.
    pub(super) fn is_steady_from(&self, first: usize, teeth: f64) -> bool {
        let means = self.means.iter().map(|it| average(&it[first..]).abs());
        let means: Vec<f64> = means.collect();
        let tight = means.iter().copied().fold(0.0, f64::max);
        let spans = self.means.iter().zip(&self.deviations).zip(means);
        spans.into_iter().all(|((tension, deviation), mean)| {
            // What is allowed without a reason: a share of the scale, and of the swing, which dies out unseen beside a mean that is many
            // times as large.
            let scale = mean.max(LEAST_SCALE * tight);
            let sigma = average(&deviation[first..]);
            let allowed = DRIFT * scale;
            let allowed_swing = (SWING_DRIFT * sigma).clamp(LEAST_SWING_DRIFT * scale, allowed);
            // What chance excuses grows with what was examined.
            let [of_scale, of_sigma] = UNCERTAIN.map(|share| share * teeth / UNCERTAIN_AFTER);
            is_level(&tension[first..], allowed, of_scale * scale)
                && is_level(&deviation[first..], allowed_swing, of_sigma * sigma)
                && self.states.iter().all(|state| {
                    // ∂T/∂s (s_∞ − s)
                    let creep = (slope(state, tension) * remainder(&state[first..])).abs();
                    creep <= allowed || creep.is_nan()
                })
        })
    }
}

/// Whether a series drifts no more than is allowed, or than chance may make of it as far as that is excused, and has no farther to go.
fn is_level(series: &[f64], allowed: f64, excused: f64) -> bool {
    let (drift, chance) = drift(series);
    // A span that no roller held in some block has no drift to speak of.
    drift.is_nan()
        || (drift.abs() <= chance.max(allowed)
            && drift.abs() + chance <= excused.max(allowed)
            && remainder(series).abs() <= allowed)
}

fn average(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len() as f64
}

/// How far a series still goes that dies out like an exponential, s_∞ − s; 0 where its drift is no more than chance.
///
/// ```text
/// s_∞ − C = (C − B) r/(1 − r),   r = (C − B)/(B − A),   A, B, C: means over thirds
/// ```
fn remainder(series: &[f64]) -> f64 {
    let (drift, chance) = drift(series);
    let third = series.len() / 3;
    if drift.abs() <= chance || third == 0 {
        return 0.0;
    }
    let mean = |part: usize| average(&series[series.len() - (3 - part) * third..][..third]);
    let [a, b, c] = [0, 1, 2].map(mean);
    let ratio = (c - b) / (b - a);
    if (0.0..1.0).contains(&ratio) {
        (c - b) * ratio / (1.0 - ratio)
    } else {
        // It does not die out: all of it may come again.
        c - a
    }
}

/// Slope of the line through values over another quantity.
fn slope(over: &[f64], values: &[f64]) -> f64 {
    let (x, y) = (average(over), average(values));
    let pairs = over.iter().zip(values);
    let products: f64 = pairs.map(|(a, b)| (a - x) * (b - y)).sum();
    products / over.iter().map(|a| (a - x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dying(from: f64, blocks: usize) -> Vec<f64> {
        (0..blocks)
            .map(|i| from * (-(i as f64) / 4.0).exp())
            .collect()
    }

    /// s = 8 exp(−i/4) at the end of 12 blocks: means of thirds of 4 blocks fall by 1/e, and what is left is C/(e − 1) · (e − 1)/1.
    #[test]
    fn what_is_left_to_creep_is_that_of_the_exponential() {
        let state = dying(8.0, 12);
        let last: f64 = state[8..].iter().sum::<f64>() / 4.0;
        assert!(
            (remainder(&state) + last).abs() < 1e-9,
            "{}",
            remainder(&state)
        );
        assert!(remainder(&[1.0; 12]).abs() < 1e-12);
    }

    /// Tension that follows a state which creeps is not steady while it does.
    #[test]
    fn a_state_that_creeps_is_waited_for() {
        let blocks = |blocks: usize| {
            let state = dying(1.0, blocks);
            let tension: Vec<f64> = state.iter().map(|s| 100.0 + 20.0 * s).collect();
            BlockSeries {
                count: blocks,
                deviations: vec![vec![5.0; blocks]],
                means: vec![tension],
                states: vec![state],
            }
        };
        assert!(!blocks(12).is_steady_from(0, 30.0) && !blocks(12).is_steady_from(6, 15.0));
        assert!(blocks(40).is_steady_from(20, 50.0));
    }

    /// Swings that beat while they die out, by a quarter within a hundred teeth, are not steady, however much of it may be chance; beats alone are, once
    /// they have been seen often enough.
    #[test]
    fn chance_excuses_no_more_than_was_examined() {
        let beating = |dying: f64| {
            let beat =
                |i: usize| 10.0 * (1.0 - dying * i as f64) * (1.0 + 0.2 * (1.2 * i as f64).sin());
            BlockSeries {
                count: 40,
                means: vec![vec![400.0; 40]],
                deviations: vec![(0..40).map(beat).collect()],
                states: Vec::new(),
            }
        };
        let (dying, steady) = (beating(0.25 / 40.0), beating(0.0));
        let (drift, chance) = drift(&dying.deviations[0]);
        assert!(
            drift.abs() < chance,
            "{drift}, {chance}: else nothing is excused"
        );
        assert!(!dying.is_steady_from(0, 100.0) && !steady.is_steady_from(32, 20.0));
        assert!(steady.is_steady_from(0, 100.0));
    }
}
