//! `chaindrive run`: simulate a scene, write the samples, end with a summary.

use std::path::PathBuf;
use std::time::Duration;

use chaindrive::describe::spans_at_rest;
use chaindrive::precision::choose;
use chaindrive::record::{Ending, Existing, Provenance};
use chaindrive::{Channel, Drive, Judgement, Run, Simulation, SimulationError, Summary};
use clap::Args;

use super::output::{Output, Target};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::request::{Request, RunArguments, SceneArguments};
use crate::stdout::print;

/// Simulates a scene and ends with a summary.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    #[command(flatten)]
    run: RunArguments,

    /// Where the samples go: a Zarr store (.zarr), readable while the run goes on, or a table (.csv)
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier result of the same name
    #[arg(long)]
    overwrite: bool,

    /// Leaves out the estimate of the numerical error that ends the run; it takes the time of some
    /// 24 000 steps of the default length, whatever the length of the run
    #[arg(long)]
    no_error: bool,

    /// Prints errors only
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let target = Target::of(arguments.output.as_deref())?;
    let Request {
        scene,
        run,
        record,
        accuracy,
    } = arguments.run.apply(arguments.scene.load()?)?;
    let drive = scene.drive()?;
    let failed = |source| Failure::Start {
        scene: scene.name().to_owned(),
        source,
    };
    let start = drive.assemble().map_err(|error| failed(error.into()))?;
    let choice = match accuracy.map(|accuracy| choose(&start, &run, accuracy, interrupted)) {
        None => None,
        Some(Ok(choice)) => Some(choice),
        Some(Err(SimulationError::Interrupted)) => return Err(Failure::Interrupted),
        Some(Err(error)) => return Err(failed(error)),
    };
    let run = choice.as_ref().map_or(run, |choice| choice.run.clone());
    let mut simulation = Simulation::from_assembled(start, &run).map_err(failed)?;
    let channels = Channel::chosen(&record, simulation.system()).map_err(failed)?;
    let existing = if arguments.overwrite {
        Existing::Replace
    } else {
        Existing::Keep
    };
    let output = target.begin(
        &simulation,
        &channels,
        Provenance {
            choice: choice.clone(),
            ..Provenance::of(&scene, &run)
        },
        existing,
    )?;

    let mut summary = Summary::new(&simulation);
    let mut output = output;
    let mut ending = drive_to_the_end(
        &mut simulation,
        &mut output,
        &mut summary,
        arguments.quiet,
        interrupted,
    )?;
    let judgement = judge(&simulation, &run, &ending, arguments.no_error, interrupted);
    if let Some(judgement) = &judgement {
        output.judge(judgement);
    }
    output.finish(&simulation, &ending.of_the_result())?;
    if !arguments.quiet && summary.samples > 0 {
        let said = judgement
            .iter()
            .filter(|judgement| **judgement != Judgement::SwitchedOff)
            .map(|judgement| format!("\n{judgement}"));
        let chosen = choice.map_or_else(String::new, |choice| format!("\n{choice}"));
        let report = summary.report(&simulation).to_string();
        print(at_rest(&drive, &simulation) + &report + &chosen + &said.collect::<String>())?;
    }
    if judgement == Some(Judgement::Interrupted) {
        ending = Stop::Interrupted;
    }
    match ending {
        Stop::End => Ok(()),
        Stop::Interrupted => Err(Failure::Interrupted),
        Stop::Failed(source) => Err(Failure::Simulation {
            scene: scene.name().to_owned(),
            source,
        }),
    }
}

/// Why the loop stopped.
enum Stop {
    End,
    Interrupted,
    Failed(SimulationError),
}

impl Stop {
    /// What the result says of it.
    fn of_the_result(&self) -> Ending {
        match self {
            Self::End => Ending::Complete,
            Self::Interrupted => Ending::Interrupted,
            Self::Failed(error) => Ending::Failed(error.to_string()),
        }
    }
}

/// How exact the run is; nothing is said of one that failed.
fn judge(
    simulation: &Simulation,
    run: &Run,
    ending: &Stop,
    switched_off: bool,
    interrupted: &dyn Fn() -> bool,
) -> Option<Judgement> {
    match ending {
        Stop::Failed(_) => None,
        _ if switched_off => Some(Judgement::SwitchedOff),
        Stop::Interrupted => Some(Judgement::Interrupted),
        Stop::End => Some(Judgement::of(simulation, run, interrupted)),
    }
}

/// Wall time between two looks at progress and interrupts while no sample is due.
const LOOK: Duration = Duration::from_millis(100);

/// Samples until the end.
fn drive_to_the_end(
    simulation: &mut Simulation,
    output: &mut Output,
    summary: &mut Summary,
    quiet: bool,
    interrupted: &dyn Fn() -> bool,
) -> Result<Stop, Failure> {
    let mut progress = Progress::new(quiet);
    let stop = loop {
        match simulation.advance(LOOK) {
            Ok(true) => {}
            Ok(false) => {
                progress.show(simulation);
                if interrupted() {
                    break Stop::Interrupted;
                }
                continue;
            }
            Err(error) => break Stop::Failed(error),
        }
        match simulation.next_sample() {
            Ok(Some(sample)) => summary.push(sample),
            Ok(None) => break Stop::End,
            Err(error) => break Stop::Failed(error),
        }
        summary.count(simulation.events());
        output.push(simulation)?;
        progress.show(simulation);
        if interrupted() {
            break Stop::Interrupted;
        }
    };
    Ok(stop)
}

/// The span tensions before the start, as the first lines of the summary.
fn at_rest(drive: &Drive, simulation: &Simulation) -> String {
    let assembled = simulation.assembled();
    if assembled.statics.is_empty() {
        return String::new();
    }
    let spans = spans_at_rest(drive, assembled);
    let line = |(name, tension): (String, f64)| format!("  {name:22} {tension:>9.1}\n");
    let lines = spans
        .into_iter()
        .map(|span| line((span.name, span.tension)));
    let lines: String = lines.collect();
    if lines.is_empty() {
        lines
    } else {
        format!("span tension at rest [N]\n{lines}")
    }
}
