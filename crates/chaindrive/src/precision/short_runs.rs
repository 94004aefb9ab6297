//! The short runs of one drive, none of which is taken twice.

use chaindrive_mechanics::Assembled;

use super::Watch;
use super::trace::Trace;
use super::window::Window;
use crate::{Run, Simulation, SimulationError};

/// Distance of the twin's rollers or links from those of the run at the start \[m\], see `Assembled::nudged`.
pub(super) const APART: f64 = 1e-12;

/// Short runs from one start, and what they have shown so far.
///
/// Choice and estimate of a run look at the same beginning of it, with its step and with half of that: what the one has
/// run, the other goes on with.
#[derive(Debug, Default)]
pub(crate) struct ShortRuns {
    taken: Vec<ShortRun>,
    evaluations: u64,
}

/// Start of a short run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ShortRunStart {
    /// As assembled.
    Start,
    /// 1e-12 m apart from it: the twin.
    Apart,
}

#[derive(Debug)]
struct ShortRun {
    from: ShortRunStart,
    /// Its settings and the interval of its samples; how long it is makes no other run of it.
    run: Run,
    trace: Trace,
    /// None of a run that failed.
    simulation: Option<Simulation>,
}

impl ShortRuns {
    /// Takes a run over a window, or goes on with what there is of it; tells its place.
    ///
    /// # Errors
    /// The failure that ends it, and [`SimulationError::Interrupted`] when `watch` says so. A run that failed begins anew when it
    /// is asked for again.
    pub(super) fn take(
        &mut self,
        start: &Assembled,
        from: ShortRunStart,
        run: &Run,
        window: &Window,
        watch: Watch<'_>,
    ) -> Result<usize, SimulationError> {
        let run = window.of_run(run);
        let place = self.place(from, &run);
        let taken = &mut self.taken[place];
        let mut simulation = match (taken.simulation.take(), from) {
            (Some(simulation), _) => simulation,
            (None, ShortRunStart::Start) => Simulation::from_assembled(start.clone(), &run)?,
            (None, ShortRunStart::Apart) => Simulation::from_assembled(start.nudged(APART), &run)?,
        };
        let before = simulation.statistics().evaluations;
        let end = taken.trace.go_on(&mut simulation, window, watch);
        self.evaluations += simulation.statistics().evaluations - before;
        if end.is_ok() {
            taken.simulation = Some(simulation);
        } else {
            taken.trace = Trace::default();
        }
        end.map(|()| place)
    }

    /// Place of a run, begun or not.
    fn place(&mut self, from: ShortRunStart, run: &Run) -> usize {
        let run = Run {
            until: f64::INFINITY,
            ..run.clone()
        };
        let known = |it: &ShortRun| it.from == from && it.run == run;
        self.taken.iter().position(known).unwrap_or_else(|| {
            self.taken.push(ShortRun {
                from,
                run,
                trace: Trace::default(),
                simulation: None,
            });
            self.taken.len() - 1
        })
    }

    /// The trace at a place that was told.
    pub(super) fn trace(&self, place: usize) -> &Trace {
        &self.taken[place].trace
    }

    /// Evaluations of all of them, those included that failed.
    pub(super) fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Leaves the estimate of a run what it will ask for first, the run itself and that with half the step, and forgets the others: they
    /// are large, and the run may be long.
    pub(crate) fn keep_for(&mut self, run: &Run) {
        let half = run.step.map(|step| 0.5 * step);
        let wanted = |it: &ShortRun| {
            it.from == ShortRunStart::Start && (it.run.step == run.step || it.run.step == half)
        };
        self.taken.retain(wanted);
    }
}
