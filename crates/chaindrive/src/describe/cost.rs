//! Cost of a run, found by taking its first steps.

use std::time::Duration;

use chaindrive_integrate::SecondOrderSystem;
use chaindrive_mechanics::Assembled;
use schemars::JsonSchema;
use serde::Serialize;

use crate::clock::Instant;
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

impl Cost {
    /// Wall time expected for the run and the least run-in before it \[s\].
    pub fn whole_time(&self) -> f64 {
        self.run_time + self.run_in_least_time.max(0.0)
    }
}

/// Steps of a run from which on those that are measured are no more than one in a hundred.
const MANY_STEPS: f64 = 5e4;
/// Wall time of a step for every coordinate \[s\] above which no chain is known. *Assumed*: clearance joints take a tenth of it.
const SLOWEST: f64 = 5e-5;

/// Wall time that a run is foretold to take \[s\]: by its first steps, which are taken for that where it has so many that they cost nothing, or so
/// many coordinates that it could take `long` \[s\]. None where it cannot.
///
/// # Errors
/// As [`Simulation::from_assembled`].
pub fn foretold(
    assembled: &Assembled,
    run: &Run,
    long: f64,
) -> Result<Option<f64>, SimulationError> {
    let method = run.method(&assembled.system);
    let steps = run.until / method.step().min(run.until);
    let longest = steps * assembled.system.free_dofs() as f64 * SLOWEST;
    if steps < MANY_STEPS && longest < long {
        return Ok(None);
    }
    Ok(Some(measure(assembled, run)?.whole_time()))
}

/// Notice before a run of a foretold time \[s\].
pub fn foretelling(seconds: f64) -> String {
    let told = if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    };
    format!(
        "the run will take about {told}; a shorter `until`, softer links and contacts or a larger accuracy make it shorter: `describe` tells steps and run time"
    )
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
