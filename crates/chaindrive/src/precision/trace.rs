//! A short run, kept as what is compared: tensions, contact forces, angles.

use std::fmt;

use chaindrive_integrate::Statistics;
use chaindrive_mechanics::{Assembled, Flow, Impact, Observation, Sights};
use serde::{Deserialize, Serialize};

use super::Watch;
use super::window::Window;
use crate::figure::duration;
use crate::interruptible::LOOK;
use crate::{Run, Simulation, SimulationError};

/// Share of the energy moved below which losses are not told from none: 0.01 points of efficiency, finer than any is measured.
/// *Assumed*.
pub(crate) const LEAST_LOSSES: f64 = 1e-4;

/// The samples of a short run.
#[derive(Clone, Debug, Default)]
pub(super) struct Trace {
    /// Sample times \[s\], (samples,).
    pub(super) time: Vec<f64>,
    /// Tension of the spans \[N\]; empty for a chain without spans, NaN where no roller holds a span.
    pub(super) spans: Tensions,
    /// Tension of the links \[N\].
    pub(super) links: Tensions,
    /// The first span that no roller held for some time.
    pub(super) gap: Option<Gap>,
    /// Force between rollers and teeth \[N\], (samples, rollers).
    pub(super) force: Vec<f64>,
    /// Rotation of the sprockets since the start \[rad\], (samples, sprockets).
    pub(super) angle: Vec<f64>,
    /// Speed of the sprockets \[rad/s\], (samples, sprockets).
    pub(super) speed: Vec<f64>,
    /// Impacts of rollers that came to a sprocket.
    pub(super) impacts: Vec<Impact>,
    /// The energy of the run.
    pub(super) energy: LossTotals,
    /// Counts of the time stepping.
    pub(super) statistics: Statistics,
}

/// Losses of a run, and the part of its energy that is unaccounted for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LossTotals {
    /// Energy lost \[J\].
    pub(super) losses: f64,
    /// Energy unaccounted for at the end, in magnitude \[J\].
    pub(super) residual: f64,
    /// Energy that has come in \[J\].
    pub(super) supplied: f64,
}

/// Tensions of parallel strands, sample by sample.
#[derive(Clone, Debug, Default)]
pub(super) struct Tensions {
    /// Values \[N\], (samples, strands).
    pub(super) values: Vec<f64>,
    /// Entries a sample.
    pub(super) strands: usize,
}

/// The tensions that two runs are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strands {
    /// Of the spans.
    Spans,
    /// Of the links: the chain has no spans, or no roller holds one of them for some time, and then its tension
    /// is not defined.
    Links,
}

/// A span whose tension is not defined for some time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Name of the span.
    pub span: String,
    /// First and last sample without a tension \[s\].
    pub from: f64,
    /// See `from`.
    pub until: f64,
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (span, from) = (&self.span, duration(self.from));
        let until = duration(self.until);
        write!(f, "no roller holds span {span} from {from} to {until}")
    }
}

impl LossTotals {
    fn of(simulation: &Simulation) -> Self {
        let now = simulation.observation().energy;
        let start = simulation.start_energy().unwrap_or(now);
        let outside = Flow::ALL.iter().filter(|flow| !flow.is_loss());
        let came = outside.map(|&flow| now.flow(flow) - start.flow(flow));
        Self {
            losses: now.dissipated() - start.dissipated(),
            residual: simulation.energy_residual().abs(),
            supplied: came.filter(|work| *work > 0.0).sum(),
        }
    }

    /// Share of what was moved that is unaccounted for.
    pub(super) fn open(&self) -> f64 {
        let moved = self.supplied.max(self.losses);
        if moved > 0.0 {
            self.residual / moved
        } else {
            0.0
        }
    }

    /// Scale of relative errors of losses \[J\]: the losses, or the least that can be told from none.
    pub(super) fn scale(&self) -> f64 {
        self.losses.max(LEAST_LOSSES * self.supplied)
    }
}

impl Trace {
    /// Runs a drive over a window.
    ///
    /// This is no `execute`: that begins with a scene and ends with a judgement of its own, which is made of traces. A trace
    /// begins with a drive that stands assembled, such as a twin that no scene describes, and nobody is told of it.
    pub(super) fn take(
        start: &Assembled,
        run: &Run,
        window: &Window,
        watch: Watch<'_>,
    ) -> Result<Self, SimulationError> {
        let mut simulation = Simulation::from_assembled(start.clone(), &window.of_run(run))?;
        let mut trace = Self::default();
        trace.go_on(&mut simulation, window, watch)?;
        Ok(trace)
    }

    /// Goes on to the end of a window with the samples of the simulation that has come so far.
    pub(super) fn go_on(
        &mut self,
        simulation: &mut Simulation,
        window: &Window,
        watch: Watch<'_>,
    ) -> Result<(), SimulationError> {
        simulation.go_on_until(window.until);
        let more = window.samples().saturating_sub(self.len());
        loop {
            // A sample may be many steps away.
            while !simulation.advance(LOOK)? {
                if watch() {
                    return Err(SimulationError::Interrupted);
                }
            }
            // Energies are compared over the whole run: those of its ends are read.
            let ends = if self.time.is_empty() {
                Sights::ENERGIES
            } else {
                Sights::default()
            };
            simulation.sample_only(Sights::SPANS.and(ends));
            let Some(sample) = simulation.next_sample()? else {
                break;
            };
            self.push(sample, more);
            self.impacts.extend_from_slice(simulation.impacts());
            if watch() {
                return Err(SimulationError::Interrupted);
            }
        }
        self.energy = LossTotals::of(simulation);
        self.statistics = *simulation.statistics();
        self.gap = self.first_gap(&simulation.system().span_names());
        Ok(())
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.time.len()
    }

    /// Time of the last sample \[s\].
    pub(super) fn end(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0)
    }

    /// Cost in evaluations a simulated second: clocks would not choose the same twice.
    ///
    /// A solution with implicit damping takes about as long as the evaluation it follows (bicycle drive: 12 µs each).
    pub(super) fn work(&self) -> f64 {
        let counts = &self.statistics;
        (counts.evaluations + counts.solves) as f64 / self.time.last().copied().unwrap_or(1.0)
    }

    /// Keeps a sample; makes room for all that will come where there is none: traces are long, and are not to be moved.
    fn push(&mut self, sample: &Observation, samples: usize) {
        let Self {
            time,
            spans,
            links,
            force,
            angle,
            speed,
            ..
        } = self;
        let lists = [
            (time, std::slice::from_ref(&sample.time)),
            (&mut spans.values, &sample.span_tension),
            (&mut links.values, &sample.link_tension),
            (force, &sample.contact_force),
            (angle, &sample.sprocket_angle),
            (speed, &sample.sprocket_speed),
        ];
        for (list, values) in lists {
            if list.len() == list.capacity() {
                list.reserve_exact(samples.max(1) * values.len());
            }
            list.extend_from_slice(values);
        }
        spans.strands = sample.span_tension.len();
        links.strands = sample.link_tension.len();
    }

    /// The tensions of some strands.
    pub(super) fn tensions(&self, strands: Strands) -> &Tensions {
        match strands {
            Strands::Spans => &self.spans,
            Strands::Links => &self.links,
        }
    }

    /// The first span, in the order of the route, that lacks a tension.
    fn first_gap(&self, names: &[String]) -> Option<Gap> {
        names.iter().enumerate().find_map(|(span, name)| {
            let values = self.spans.of(span).zip(&self.time);
            let mut missing = values.filter(|(value, _)| !value.is_finite());
            let (_, from) = missing.next()?;
            let until = missing.last().map_or(*from, |(_, time)| *time);
            Some(Gap {
                span: name.clone(),
                from: *from,
                until,
            })
        })
    }
}

impl Strands {
    /// Quantity by which several traces can be compared: the spans if every trace has all their tensions.
    pub(super) fn of<'a>(traces: impl IntoIterator<Item = &'a Trace>) -> Self {
        let has_spans = |trace: &Trace| trace.gap.is_none() && trace.spans.strands > 0;
        if traces.into_iter().all(has_spans) {
            Self::Spans
        } else {
            Self::Links
        }
    }
}

impl Tensions {
    /// Tensions of one strand \[N\].
    pub(super) fn of(&self, strand: usize) -> impl Iterator<Item = f64> {
        let values = self.values.iter().skip(strand);
        values.step_by(self.strands.max(1)).copied()
    }

    /// Mean magnitude over samples and strands \[N\].
    pub(super) fn mean(&self) -> f64 {
        self.mean_of_first(usize::MAX)
    }

    /// The same over the first samples; what relative errors are relative to.
    pub(super) fn mean_of_first(&self, samples: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        let values = self
            .values
            .iter()
            .take(samples.saturating_mul(self.strands));
        for tension in values.filter(|tension| tension.is_finite()) {
            sum += tension.abs();
            count += 1.0;
        }
        sum / f64::max(count, 1.0)
    }

    /// The strand with the largest mean tension.
    pub(super) fn tight(&self) -> usize {
        let mean =
            |strand: usize| -> f64 { self.of(strand).filter(|value| value.is_finite()).sum() };
        (0..self.strands)
            .max_by(|a, b| mean(*a).total_cmp(&mean(*b)))
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_without_a_tension_is_named_with_its_times() {
        let mut trace = Trace {
            time: vec![0.0, 1e-3, 2e-3, 3e-3],
            ..Trace::default()
        };
        trace.spans.strands = 2;
        for sample in [[1.0, 2.0], [1.0, f64::NAN], [1.0, 2.0], [1.0, f64::NAN]] {
            trace.spans.values.extend(sample);
        }
        let names = ["a-b".to_owned(), "b-a".to_owned()];
        trace.gap = trace.first_gap(&names);
        let told = trace.gap.as_ref().map(Gap::to_string);
        let told = told.as_deref();
        assert_eq!(told, Some("no roller holds span b-a from 1 ms to 3 ms"));
        assert_eq!(Strands::of([&trace]), Strands::Links);
        trace.gap = None;
        assert_eq!(Strands::of([&trace]), Strands::Spans);
    }
}
