//! A short run, kept as what is compared: tensions, contact forces, angles.

use chaindrive_integrate::Statistics;
use chaindrive_mechanics::Assembled;

use super::Watch;
use super::window::Window;
use crate::{Run, Simulation, SimulationError};

/// The samples of a short run.
#[derive(Clone, Debug, Default)]
pub(super) struct Trace {
    /// Sample times \[s\], (samples,).
    pub(super) time: Vec<f64>,
    /// Tension of the spans, or of the links of a chain without spans \[N\], (samples, strands).
    pub(super) tension: Vec<f64>,
    /// Entries of `tension` a sample.
    pub(super) strands: usize,
    /// Force between rollers and teeth \[N\], (samples, rollers).
    pub(super) force: Vec<f64>,
    /// Rotation of the sprockets since the start \[rad\], (samples, sprockets).
    pub(super) angle: Vec<f64>,
    /// Speed of the sprockets \[rad/s\], (samples, sprockets).
    pub(super) speed: Vec<f64>,
    /// Counts of the time stepping.
    pub(super) statistics: Statistics,
}

impl Trace {
    /// Runs a drive over a window.
    pub(super) fn take(
        start: &Assembled,
        run: &Run,
        window: &Window,
        watch: Watch<'_>,
    ) -> Result<Self, SimulationError> {
        let run = Run {
            until: window.until,
            every: window.every,
            events: chaindrive_mechanics::EventKinds::default(),
            ..run.clone()
        };
        let mut simulation = Simulation::from_assembled(start.clone(), &run)?;
        let mut trace = Self::default();
        while let Some(sample) = simulation.next_sample()? {
            trace.time.push(sample.time);
            let tension = if sample.span_tension.is_empty() {
                &sample.link_tension
            } else {
                &sample.span_tension
            };
            trace.strands = tension.len();
            trace.tension.extend_from_slice(tension);
            trace.force.extend_from_slice(&sample.contact_force);
            trace.angle.extend_from_slice(&sample.sprocket_angle);
            trace.speed.extend_from_slice(&sample.sprocket_speed);
            if watch() {
                return Err(SimulationError::Interrupted);
            }
        }
        trace.statistics = *simulation.statistics();
        Ok(trace)
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.time.len()
    }

    /// Mean magnitude of the tension over samples and strands \[N\]; what relative errors are relative to.
    pub(super) fn mean_tension(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for tension in self.tension.iter().filter(|tension| tension.is_finite()) {
            sum += tension.abs();
            count += 1.0;
        }
        sum / f64::max(count, 1.0)
    }

    /// The strand with the largest mean tension.
    pub(super) fn tight(&self) -> usize {
        let mean = |strand: usize| -> f64 {
            let values = self.tension.iter().skip(strand).step_by(self.strands);
            values.filter(|value| value.is_finite()).sum()
        };
        (0..self.strands)
            .max_by(|a, b| mean(*a).total_cmp(&mean(*b)))
            .unwrap_or(0)
    }
}
