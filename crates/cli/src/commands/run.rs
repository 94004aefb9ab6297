//! `chaindrive run`: simulate a scene, write the samples, end with a summary.

use std::cell::RefCell;
use std::path::PathBuf;

use chaindrive::describe::spans_at_rest;
use chaindrive::record::{Existing, Provenance, figures};
use chaindrive::{Channel, End, Onlooker, Report, RunError, Simulation, Sink, Stop, execute};
use clap::Args;

use super::output::{Output, Target};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::request::{RunArguments, SceneArguments};
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
    /// 32 000 steps of the default length, whatever the length of the run
    #[arg(long)]
    no_error: bool,

    /// Prints errors only, and a line if the result is not to be trusted
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let target = Target::of(arguments.output.as_deref())?;
    let mut request = arguments.run.apply(&arguments.scene.load()?)?;
    if arguments.no_error {
        request = request.without_estimate();
    }
    let existing = if arguments.overwrite {
        Existing::Replace
    } else {
        Existing::Keep
    };
    let mut result = Written::Asked(target, existing);
    let terminal = Terminal {
        progress: RefCell::new(Progress::new(arguments.quiet)),
        interrupted,
    };
    let scene = || request.scene.name().to_owned();
    let report = execute(&request, &mut result, &terminal).map_err(|error| match error {
        RunError::Scene(error) => error.into(),
        RunError::Interrupted => Failure::Interrupted,
        RunError::Sink(failure) => failure,
        RunError::Start(source) => Failure::Start {
            scene: scene(),
            source,
        },
    })?;
    drop(terminal);
    if let Some(warning) = report.verdict.warning() {
        eprintln!("{}: {warning}", scene());
    }
    if !arguments.quiet && report.summary.samples > 0 {
        print(told(&report))?;
    }
    match report.stop {
        Stop::End => Ok(()),
        Stop::Interrupted => Err(Failure::Interrupted),
        Stop::Failed(source) => Err(Failure::Simulation {
            scene: scene(),
            source,
        }),
    }
}

/// Somebody at a terminal: sees the bar, may press Ctrl-C.
struct Terminal<'a> {
    progress: RefCell<Progress>,
    interrupted: &'a dyn Fn() -> bool,
}

impl Onlooker for Terminal<'_> {
    fn stop(&self) -> bool {
        (self.interrupted)()
    }

    fn see(&self, simulation: &Simulation) {
        self.progress.borrow_mut().show(simulation);
    }
}

/// The result: a place, and once the run has begun what is written there.
enum Written {
    Asked(Target, Existing),
    Begun(Output),
    Closed,
}

impl Sink for Written {
    type Error = Failure;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        if let Self::Asked(target, existing) = std::mem::replace(self, Self::Closed) {
            let output = target.begin(simulation, channels, provenance.clone(), existing)?;
            *self = Self::Begun(output);
        }
        Ok(())
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        match self {
            Self::Begun(output) => output.push(simulation),
            Self::Asked(..) | Self::Closed => Ok(()),
        }
    }

    fn end(&mut self, end: &End<'_>) -> Result<(), Failure> {
        let Self::Begun(mut output) = std::mem::replace(self, Self::Closed) else {
            return Ok(());
        };
        if let Some(judgement) = end.judgement {
            output.judge(judgement);
        }
        output.tell(end.attributes);
        output.finish(end.simulation, end.ending)
    }
}

/// The account that ends the run.
fn told(report: &Report) -> String {
    let (choice, judgement) = (report.choice.as_ref(), report.judgement.as_ref());
    let figures = figures(&report.summary, &report.simulation, choice, judgement);
    format!("{}\n{}{figures}", report.verdict, at_rest(report))
}

/// The span tensions before the start, as the first figures of the summary.
fn at_rest(report: &Report) -> String {
    let assembled = report.simulation.assembled();
    if assembled.statics.is_empty() {
        return String::new();
    }
    let spans = spans_at_rest(&report.drive, assembled);
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
