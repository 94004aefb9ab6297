//! The chaos horizon: how long two runs that start 1e-12 m apart stay together.

use chaindrive_mechanics::Assembled;

use super::Watch;
use super::compare::{Distance, distances};
use super::growth::{Growth, growth};
use super::sharper::pinned;
use super::short_runs::APART;
use super::trace::{Strands, Trace};
use super::window::Window;
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
        let distances = distances(twin, run, strands);
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
}
