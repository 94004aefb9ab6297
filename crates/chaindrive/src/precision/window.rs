//! The window of a run that is examined, and its step: long enough for a few teeth, short enough to cost little.

use chaindrive_integrate::{Moment, SecondOrderSystem};
use chaindrive_mechanics::{Assembled, EventKinds, Observation};

use crate::{Run, Stepping};

/// Teeth that pass in a window.
const TEETH: f64 = 8.0;
/// Default steps of the drive that a window has at most: what bounds the cost of drives that turn slowly or
/// not at all.
const STEPS: f64 = 8000.0;
/// Steps of the run itself that a window has at most, however short somebody wants them.
const OWN_STEPS: f64 = 64_000.0;
/// Samples of a window.
const SAMPLES: f64 = 256.0;
/// Samples of a window that is looked at for the first moment of an error: blows last a few default steps, and between
/// fewer samples they pass unseen.
const FINE_SAMPLES: f64 = 1024.0;

/// A short stretch at the beginning of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// End \[s\].
    pub until: f64,
    /// Interval between samples \[s\].
    pub every: f64,
    /// Time in which a tooth passes \[s\]; none without a chain that runs over sprockets.
    pub period: Option<f64>,
    /// End of the window of a run without an end \[s\].
    longest: f64,
}

impl Window {
    /// The window of a run.
    ///
    /// ```text
    /// min(until, 8 p/v, 8000 h₀, 64 000 h),   p/v: time in which a tooth passes, h₀: default step, h: step
    /// ```
    ///
    /// A shorter step does not make the window shorter, until it is an eighth of the default one: errors are
    /// compared over the same time.
    pub(super) fn of(start: &Assembled, run: &Run) -> Self {
        let period = period(start);
        let steps = (STEPS * default_step(start, run)).min(OWN_STEPS * typical_step(start, run));
        let teeth = period.map_or(f64::INFINITY, |period| TEETH * period);
        let longest = teeth.min(steps);
        let until = run.until.min(longest);
        Self {
            until,
            every: until / SAMPLES,
            period,
            longest,
        }
    }

    /// The same with samples so close that hardly a blow falls between two of them, but no closer than default steps.
    pub(super) fn finely(&self, start: &Assembled, run: &Run) -> Self {
        let steps = (self.until / default_step(start, run)).round();
        Self {
            every: self.until / steps.clamp(SAMPLES, FINE_SAMPLES),
            ..*self
        }
    }

    /// A run over the window, sampled as it says, without events.
    pub(super) fn of_run(&self, run: &Run) -> Run {
        Run {
            until: self.until,
            every: self.every,
            events: EventKinds::default(),
            watched: false,
            ..run.clone()
        }
    }

    /// Number of its samples, the one at its beginning included.
    pub(super) fn samples(&self) -> usize {
        self.samples_of(self.until) + 1
    }

    /// Number of whole intervals between samples in some time \[s\].
    pub(super) fn samples_of(&self, time: f64) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few thousand"
        )]
        let samples = (time / self.every) as usize;
        samples
    }

    /// Another end \[s\], with as many samples.
    pub(super) fn with_end(&self, until: f64) -> Self {
        Self {
            until,
            every: until / (self.until / self.every).round(),
            ..*self
        }
    }

    /// As much of it as a share of the longest window, with the same samples: a run that is shorter than that is
    /// looked at to its end.
    pub(super) fn first(&self, share: f64) -> Self {
        Self {
            until: self.until.min(share * self.longest),
            ..*self
        }
    }

    /// Its first half, with the same samples.
    pub(super) fn first_half(&self) -> Self {
        Self {
            until: 0.5 * self.until,
            ..*self
        }
    }
}

/// The step that a run will take \[s\]; under error control, that of the stiffest mode.
fn typical_step(start: &Assembled, run: &Run) -> f64 {
    let method = run.method(&start.system);
    if method.is_adaptive() {
        method.step().min(start.system.time_scale())
    } else {
        method.step()
    }
}

/// The step that a run takes where nobody asks for another \[s\].
fn default_step(start: &Assembled, run: &Run) -> f64 {
    typical_step(start, &automatic(run))
}

/// p/v at the start \[s\]; none without spans, or for a chain at rest.
fn period(start: &Assembled) -> Option<f64> {
    let system = &start.system;
    let mut record = system.new_record();
    let mut observation = Observation::default();
    let at = Moment {
        t: 0.0,
        q: &start.q,
        v: &start.v,
        z: &start.z,
    };
    let flows = vec![0.0; system.quadratures()];
    system.observe(at, &flows, &mut record, &mut observation);
    let speeds = observation
        .roller_vx
        .iter()
        .zip(&observation.roller_vy)
        .map(|(x, y)| x.hypot(*y));
    let speed = speeds.sum::<f64>() / observation.roller_vx.len() as f64;
    let period = system.pitch() / speed;
    (!system.span_names().is_empty() && period.is_finite()).then_some(period)
}

/// The run without the method that is to be chosen.
pub(super) fn automatic(run: &Run) -> Run {
    Run {
        stepping: Stepping::Auto,
        step: None,
        onset_depth: None,
        ..run.clone()
    }
}

/// The run with the step that it would choose for itself, so that other samples do not change it.
pub(super) fn pinned(start: &Assembled, run: &Run) -> Run {
    Run {
        step: Some(run.method(&start.system).step()),
        ..run.clone()
    }
}

/// The same run, sharper, and in what.
pub(super) fn sharper(start: &Assembled, run: &Run) -> (Run, &'static str) {
    let mut better = run.clone();
    better.onset_depth = run.onset_depth.map(|depth| 0.1 * depth);
    let words = if run.method(&start.system).is_adaptive() {
        better.tolerance = 0.1 * run.tolerance;
        [
            "a tenth of the tolerance",
            "a tenth of the tolerance and of the onset depth",
        ]
    } else {
        better.step = run.step.map(|step| 0.5 * step);
        [
            "half the step",
            "half the step and a tenth of the onset depth",
        ]
    };
    let words = words[usize::from(run.onset_depth.is_some())];
    (better, words)
}
