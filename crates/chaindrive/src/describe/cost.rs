//! Cost of a run, found by taking its first steps.

use std::time::{Duration, Instant};

use chaindrive_integrate::SecondOrderSystem;
use chaindrive_mechanics::Assembled;
use schemars::JsonSchema;
use serde::Serialize;

use crate::run_in::bounds;
use crate::{Run, Simulation, SimulationError};

/// Method, steps and run time.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cost {
    /// Name of the method.
    pub method: &'static str,
    /// Step \[s\]: the fixed one, or the mean one measured.
    pub step: f64,
    /// Whether the step follows the error.
    pub adaptive: bool,
    /// Simulated time \[s\].
    pub until: f64,
    /// Samples, the first and the last included.
    pub samples: f64,
    /// Steps expected.
    pub steps: f64,
    /// Wall time of a step \[s\], measured.
    pub time_per_step: f64,
    /// Wall time expected, recording not counted \[s\].
    pub run_time: f64,
    /// Wall time over simulated time \[–\]: below 1 is faster than real time.
    pub real_time_ratio: f64,
    /// Steps measured.
    pub measured: u64,
    /// Simulated time before the record \[s\], at most; zero without a run-in, and not a number where torques bring the drive up to speed before.
    pub run_in: f64,
    /// The same at least \[s\]: less where a run-in ends by itself.
    pub run_in_least: f64,
    /// Wall time expected for it, at most \[s\].
    pub run_in_time: f64,
    /// The same at least \[s\].
    pub run_in_least_time: f64,
    /// Accuracy \[–\] that a run chooses another method or step for; absent where it takes these.
    pub unless_chosen_for: Option<f64>,
}

/// Steps to warm up with, and to measure, at most.
const WARM_UP: f64 = 100.0;
const MEASURED: f64 = 400.0;

/// Wall time \[s\] that the same may take: a step of a thousand links with clearance takes a tenth of a second.
const PATIENCE: [Duration; 2] = [Duration::from_millis(100), Duration::from_millis(400)];

/// Goes on to the end of a run, or until patience ends.
fn take_steps(simulation: &mut Simulation, patience: Duration) -> Result<(), SimulationError> {
    let begin = Instant::now();
    // A sample may be many steps away.
    while begin.elapsed() < patience && simulation.advance(patience)? {
        if simulation.next_sample()?.is_none() {
            break;
        }
    }
    Ok(())
}

pub(super) fn measure(assembled: &Assembled, run: &Run) -> Result<Cost, SimulationError> {
    let method = run.method(&assembled.system);
    let adaptive = method.is_adaptive();
    let step = if adaptive {
        method.step().min(assembled.system.time_scale())
    } else {
        method.step()
    };
    // Never beyond the end of the run: what comes later may not even be defined.
    let measured = (MEASURED * step).min(0.8 * run.until);
    let warm_up = (WARM_UP * step).min(0.2 * run.until);
    let trial = |until: f64| Run {
        until,
        // A sample a step, to look at the clock between them.
        every: step.min(until),
        ..run.clone()
    };
    let mut warming = Simulation::from_assembled(assembled.clone(), &trial(warm_up))?;
    take_steps(&mut warming, PATIENCE[0])?;
    let mut simulation = Simulation::from_assembled(assembled.clone(), &trial(measured))?;
    take_steps(&mut simulation, PATIENCE[1])?;

    let taken = simulation.statistics().steps.max(1);
    let time_per_step = simulation.stepping_time() / taken as f64;
    let mean_step = simulation.time() / taken as f64;
    let step = if adaptive { mean_step } else { step };
    let steps = (run.until / step).ceil();
    let run_time = steps * time_per_step;
    let [run_in_least, run_in] = bounds(assembled, run)?;
    Ok(Cost {
        method: method.name(),
        step,
        adaptive,
        until: run.until,
        samples: (run.until / run.every * (1.0 + 1e-12)).floor() + 1.0,
        steps,
        time_per_step,
        run_time,
        real_time_ratio: run_time / run.until,
        measured: taken,
        run_in,
        run_in_least,
        run_in_time: run_in / step * time_per_step,
        run_in_least_time: run_in_least / step * time_per_step,
        unless_chosen_for: None,
    })
}
