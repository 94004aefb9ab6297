//! The chaos horizon: how long two runs that start 1e-12 m apart stay together.

use chaindrive_mechanics::Assembled;

use super::Watch;
use super::compare::{Distance, Pair};
use super::short_runs::APART;
use super::trace::{Strands, Trace};
use super::window::{Window, pinned};
use crate::figure::duration;
use crate::{Run, SimulationError};

/// Difference of tensions, over the mean tension, at which waveforms no longer agree \[–\].
pub(super) const LIMIT: f64 = 0.01;

/// When the tensions of a run and of its twin differ by 1 % of the mean tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Of all spans, root mean square; of all links where [`Strands::Links`] are compared.
    pub all: Divergence,
    /// Of the tightest one alone.
    pub tight: Divergence,
    /// Time over which the twins were followed \[s\].
    pub window: f64,
}

/// Fate of a difference of 1e-12 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Divergence {
    /// It became 1 %.
    Measured {
        /// When \[s\].
        at: f64,
    },
    /// It grows exponentially and will become 1 %, if it goes on like that.
    Extrapolated {
        /// When \[s\].
        at: f64,
        /// Time in which it grows by e \[s\].
        lyapunov: f64,
    },
    /// It grew, and stays at a level below 1 %: no horizon.
    Saturated {
        /// Level \[–\].
        level: f64,
    },
    /// It did not grow by a factor of ten, or in no way that is told from its swing.
    None {
        /// Largest relative difference \[–\].
        largest: f64,
    },
}

impl Divergence {
    /// When the difference reaches 1 % \[s\]; none if it does not.
    pub fn time(&self) -> Option<f64> {
        match *self {
            Self::Measured { at } | Self::Extrapolated { at, .. } => Some(at),
            Self::Saturated { .. } | Self::None { .. } => None,
        }
    }

    fn of(time: &[f64], distance: &[f64]) -> Self {
        if let Some(first) = distance.iter().position(|d| *d >= LIMIT) {
            return Self::Measured { at: time[first] };
        }
        match growth(time, distance) {
            Growth::Exponential { rate, last } => Self::Extrapolated {
                // D = exp(last + λ (t − t_end)) = 1 %
                at: time[time.len() - 1] + ((LIMIT.ln() - last) / rate).max(0.0),
                lyapunov: 1.0 / rate,
            },
            Growth::Saturated(level) => Self::Saturated { level },
            Growth::None => Self::None {
                largest: distance.iter().copied().fold(0.0, f64::max),
            },
        }
    }

    /// In a sentence; `window`: time over which the twins were followed \[s\].
    fn sentence(&self, window: f64) -> String {
        let followed = duration(window);
        match *self {
            Self::Measured { at } => format!(
                "two runs that start 1e-12 m apart differ by 1 % after {}",
                duration(at)
            ),
            Self::Extrapolated { at, lyapunov } => format!(
                "two runs that start 1e-12 m apart will differ by 1 % after {}, if their difference goes on growing e-fold every {} (followed for {followed})",
                duration(at),
                duration(lyapunov)
            ),
            Self::Saturated { level } => format!(
                "two runs that start 1e-12 m apart come to differ by {level:.1e} and no more (followed for {followed})"
            ),
            Self::None { largest } => format!(
                "two runs that start 1e-12 m apart differ by {largest:.0e} at most (followed for {followed})"
            ),
        }
    }
}

/// The horizon of a run, found by following it and its twin for some time \[s\] instead of a
/// [`Window`]: the longer, the less is extrapolated.
///
/// # Errors
/// [`SimulationError`] when one of the two fails, [`SimulationError::Interrupted`] when `watch` says so.
pub fn horizon(
    start: &Assembled,
    run: &Run,
    follow: f64,
    watch: Watch<'_>,
) -> Result<Horizon, SimulationError> {
    let run = pinned(start, run);
    let window = Window::of(start, &run).with_end(follow);
    let own = Trace::take(start, &run, &window, watch)?;
    let twin = Trace::take(&start.nudged(APART), &run, &window, watch)?;
    Ok(Horizon::of(&own, &twin, Strands::of([&own, &twin])))
}

impl Horizon {
    /// The horizon of a run by its twin, found on some strands.
    pub(super) fn of(run: &Trace, twin: &Trace, strands: Strands) -> Self {
        let distances = Pair::of(twin, run, strands).distances();
        let divergence = |part: fn(&Distance) -> f64| {
            let distance: Vec<f64> = distances.iter().map(part).collect();
            Divergence::of(&run.time[..distance.len()], &distance)
        };
        Self {
            all: divergence(|distance| distance.all),
            tight: divergence(|distance| distance.tight),
            window: run.time.last().copied().unwrap_or(0.0),
        }
    }

    /// Fate of the distance of the twins, in a sentence.
    pub fn sentence(&self) -> String {
        self.all.sentence(self.window)
    }

    /// The same of the tightest span or link.
    pub fn tight_sentence(&self) -> String {
        self.tight.sentence(self.window)
    }
}

/// Growth of a distance over time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Growth {
    /// It grows: D(t) = exp(λ (t − t₀)).
    Exponential {
        /// λ \[1/s\].
        rate: f64,
        /// ln D at the end of the samples, by the fit.
        last: f64,
    },
    /// It has grown and stays at a level \[–\].
    Saturated(f64),
    /// Neither.
    None,
}

/// Parts of the window over which distances are averaged, since they swing with the tension.
const BLOCKS: usize = 16;
/// Blocks a fit needs.
const LEAST: usize = 5;
/// Standard errors by which a rate must exceed zero.
const SIGNIFICANT: f64 = 3.0;
/// Growth between the two ends of a fit below which it is not called growth: a factor of ten.
const LEAST_GROWTH: f64 = std::f64::consts::LN_10;
/// Factor above the least distance that something has to have reached before it may be called saturated.
const RISEN: f64 = 1e3;

/// Looks for growth.
///
/// ```text
/// ln D̄ₖ = λ tₖ + c,   least squares over the blocks from the least one in the first half to the last
/// ```
///
/// D̄ₖ is the root mean square of a sixteenth of the samples. The beginning is left out because the start of
/// a twin rings before anything unfolds.
fn growth(time: &[f64], distance: &[f64]) -> Growth {
    let blocks = blocks(time, distance);
    let Some(least) = (0..blocks.len() / 2).min_by(|a, b| blocks[*a].1.total_cmp(&blocks[*b].1))
    else {
        return Growth::None;
    };
    let blocks = &blocks[least..];
    if blocks.len() < LEAST {
        return Growth::None;
    }
    let late = &blocks[blocks.len() - (blocks.len() / 2).max(LEAST)..];
    let (rate, error) = line(late);
    let risen = mean(late) - blocks[0].1;
    if risen > RISEN.ln() && rate * span(late) < LEAST_GROWTH.max(SIGNIFICANT * error * span(late))
    {
        return Growth::Saturated(mean(late).exp());
    }
    let (rate, error) = line(blocks);
    if rate > SIGNIFICANT * error && rate * span(blocks) > LEAST_GROWTH {
        let middle = blocks.iter().map(|(t, _)| t).sum::<f64>() / blocks.len() as f64;
        let last = mean(blocks) + rate * (time[time.len() - 1] - middle);
        return Growth::Exponential { rate, last };
    }
    Growth::None
}

/// Mean time and ln of the root mean square distance of every block that has a distance.
fn blocks(time: &[f64], distance: &[f64]) -> Vec<(f64, f64)> {
    let size = time.len().div_ceil(BLOCKS).max(1);
    time.chunks(size)
        .zip(distance.chunks(size))
        .filter_map(|(time, distance)| {
            let count = time.len() as f64;
            let square = distance.iter().map(|d| d * d).sum::<f64>() / count;
            let middle = time.iter().sum::<f64>() / count;
            (square > 0.0 && square.is_finite()).then(|| (middle, 0.5 * square.ln()))
        })
        .collect()
}

fn mean(blocks: &[(f64, f64)]) -> f64 {
    blocks.iter().map(|(_, ln)| ln).sum::<f64>() / blocks.len() as f64
}

fn span(blocks: &[(f64, f64)]) -> f64 {
    blocks[blocks.len() - 1].0 - blocks[0].0
}

/// Slope of the line of least squares, and its standard error.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let t0 = points.iter().map(|(t, _)| t).sum::<f64>() / n;
    let y0 = mean(points);
    let tt: f64 = points.iter().map(|(t, _)| (t - t0).powi(2)).sum();
    let ty: f64 = points.iter().map(|(t, y)| (t - t0) * (y - y0)).sum();
    let slope = ty / tt;
    let left: f64 = points
        .iter()
        .map(|(t, y)| (y - y0 - slope * (t - t0)).powi(2))
        .sum();
    (slope, (left / (n - 2.0) / tt).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..=200).map(|i| f64::from(i) * 1e-3).collect();
        let distance = time.iter().map(|t| of(*t)).collect();
        (time, distance)
    }

    #[test]
    fn a_swinging_exponential_gives_its_rate() {
        let (time, distance) = samples(|t| 1e-9 * (t / 0.02).exp() * (t * 900.0).sin());
        let Growth::Exponential { rate, last } = growth(&time, &distance) else {
            panic!("no growth");
        };
        assert!((rate * 0.02 - 1.0).abs() < 0.05, "{rate}");
        let amplitude = (1e-9_f64 / 2.0_f64.sqrt()).ln() + 10.0;
        assert!((last - amplitude).abs() < 0.5, "{last}");
    }

    #[test]
    fn what_grows_and_stays_is_saturated() {
        let (time, distance) = samples(|t| (1e-9 * (t / 2e-3).exp()).min(2e-3));
        let found = growth(&time, &distance);
        assert!(
            matches!(found, Growth::Saturated(level) if (level / 2e-3 - 1.0).abs() < 0.1),
            "{found:?}"
        );
    }

    #[test]
    fn a_distance_that_stays_small_does_not_grow() {
        let (time, distance) = samples(|t| 1e-9 * (1.0 + 0.5 * (t * 700.0).sin()));
        assert_eq!(growth(&time, &distance), Growth::None);
        let (time, distance) = samples(|_| 0.0);
        assert_eq!(growth(&time, &distance), Growth::None);
        assert_eq!(growth(&[], &[]), Growth::None);
    }

    #[test]
    fn growth_with_time_to_the_first_power_is_not_chaos() {
        let (time, distance) = samples(|t| 1e-9 * (1.0 + t));
        assert_eq!(growth(&time, &distance), Growth::None);
    }
}
