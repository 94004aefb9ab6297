//! `chaindrive run`: simulate a scene, write the samples, end with a summary.

use std::cell::RefCell;
use std::path::PathBuf;

use chaindrive::{
    CheckOutcome, Onlooker, Report, RunError, SettingValue, Simulation, Stop, execute,
};
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use super::output::{ONE_DOCUMENT, OutputArguments, Page, Target};
use crate::answer::answer;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::request::{RunArguments, SceneArguments};
use crate::terminal::say;

/// Simulates a scene and ends with a summary.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    #[command(flatten)]
    run: RunArguments,

    #[command(flatten)]
    place: OutputArguments,

    /// Simulated time between two checkpoints in a Zarr result, such as "10 ms": killed at any moment, the run goes on
    /// from the last one by `chaindrive resume`. The samples are the same as without, to the last bit
    #[arg(long, value_name = "TIME")]
    checkpoint_every: Option<String>,

    /// Leaves out the estimate of the numerical error that ends the run; it takes the time of some
    /// 40 000 steps of the default length, whatever the length of the run
    #[arg(long)]
    no_error: bool,

    #[command(flatten)]
    telling: ReportOptions,

    /// Prints JSON in place of the page: how the run ended, warnings, and the attributes of the result
    #[arg(long, conflicts_with_all = ["quiet", "numerics"])]
    json: bool,
}

/// Answer of `chaindrive run --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Answer {
    /// File or embedded scene.
    scene: String,
    /// How it ended; of a run that is not complete, stderr says why.
    status: Status,
    /// Where the samples are; absent where they were not kept.
    output: Option<PathBuf>,
    /// How far the result can be trusted, and whatever else was noticed; empty where there is nothing to say.
    warnings: Vec<String>,
    /// All that the result says of itself, as in a store: numbers in SI units, texts, and lists of them.
    attributes: Map<String, Value>,
}

/// How a run or a sweep ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Status {
    /// It reached its end.
    Complete,
    /// It was stopped; what there is was kept.
    Interrupted,
    /// It failed, or some variants did; what there is was kept.
    Failed,
}

/// Amount of text about a result, and strictness of the exit code.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct ReportOptions {
    /// Prints errors only, and a line if the result is not to be trusted
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// Adds steps, contacts, energy and errors of the run to its page
    #[arg(long)]
    pub(super) numerics: bool,

    /// Exits with 4 if the verdict is `distrusted`, with `chain` with 5 if the verdict on the chain is `fail`, with `all` with either; the result
    /// is kept all the same
    #[arg(long, value_name = "WHAT", num_args = 0..=1, require_equals = true, default_missing_value = "numbers")]
    strict: Option<Strictness>,
}

/// Verdicts that decide on the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Strictness {
    /// That on the numbers
    Numbers,
    /// That on the chain
    Chain,
    /// Both
    All,
}

pub(crate) fn run(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let target = Target::of(&arguments.place)?;
    let page = target.page();
    if arguments.json && page == Page::Aside {
        return Err(Failure::Argument(ONE_DOCUMENT.to_owned()));
    }
    if arguments.run.asks_for_contacts() {
        target.for_contacts()?;
    }
    let mut request = arguments.run.apply(&arguments.scene.load(interrupted)?)?;
    let scene = request.scene.name().to_owned();
    let notes = arguments.scene.notes(&request.scene);
    for note in notes
        .iter()
        .filter(|_| !arguments.telling.quiet && !arguments.json)
    {
        say(note);
    }
    if let Some(every) = &arguments.checkpoint_every {
        target.for_checkpoints()?;
        let every = SettingValue::written(every);
        let wanted = request.with_checkpoints(&every);
        request = wanted.map_err(|error| Failure::request(error, &scene))?;
    }
    if arguments.no_error {
        request = request.without_estimate();
    }
    let mut result = target.output(arguments.place.existing()?)?;
    let terminal = if arguments.json {
        Terminal::listening(interrupted)
    } else {
        Terminal::new(arguments.telling.quiet, interrupted)
    };
    let report = execute(&request, &mut result, &terminal);
    let report = report.map_err(|error| not_run(error, &scene))?;
    let foretold = terminal.foretold.into_inner();
    if arguments.json {
        let clashes = report.simulation.assembled().warnings.iter();
        let clashes = clashes.map(ToString::to_string);
        let warnings = notes.into_iter().chain(foretold).chain(clashes);
        answer(&Answer {
            scene: scene.clone(),
            status: match report.stop {
                Stop::End => Status::Complete,
                Stop::Interrupted => Status::Interrupted,
                Stop::Failed(_) => Status::Failed,
            },
            output: arguments.place.output.clone(),
            warnings: warnings.chain(report.verdict.warning()).collect(),
            attributes: report.attributes.clone(),
        })?;
        return ended(report, &scene, arguments.telling.strict);
    }
    concluded(report, &scene, arguments.telling, page)
}

/// Why there is no report.
pub(super) fn not_run<E: std::error::Error + Into<Failure>>(
    error: RunError<E>,
    scene: &str,
) -> Failure {
    match error {
        RunError::Scene(error) => error.into(),
        RunError::Interrupted => Failure::Interrupted,
        RunError::Sink(failure) => failure.into(),
        RunError::Snapshot(error) => Failure::Argument(format!("{scene}: {error}")),
        RunError::Start(source) => Failure::Start {
            scene: scene.to_owned(),
            source,
        },
    }
}

/// Says what came of a run.
pub(super) fn concluded(
    report: Report,
    scene: &str,
    telling: ReportOptions,
    page: Page,
) -> Result<(), Failure> {
    let ReportOptions {
        quiet,
        numerics,
        strict,
    } = telling;
    if !quiet {
        for clash in &report.simulation.assembled().warnings {
            say(format_args!("warning: {scene}: {clash}"));
        }
    }
    if let Some(warning) = report.verdict.warning() {
        say(format_args!("{scene}: {warning}"));
    }
    if !quiet && report.summary.samples > 0 {
        page.tell(told(&report, numerics))?;
    }
    ended(report, scene, strict)
}

/// Exit code of a run.
fn ended(report: Report, scene: &str, strict: Option<Strictness>) -> Result<(), Failure> {
    let of = |what: Strictness| strict.is_some_and(|it| it == what || it == Strictness::All);
    let chain_fails = report.verdict.chains.outcome() == CheckOutcome::Fail;
    match report.stop {
        Stop::End if of(Strictness::Numbers) && report.verdict.is_distrusted() => {
            Err(Failure::Distrusted {
                scene: scene.to_owned(),
            })
        }
        Stop::End if of(Strictness::Chain) && chain_fails => Err(Failure::Overloaded {
            scene: scene.to_owned(),
        }),
        Stop::End => Ok(()),
        Stop::Interrupted => Err(Failure::Interrupted),
        Stop::Failed(source) => Err(Failure::Simulation {
            scene: scene.to_owned(),
            source,
        }),
    }
}

/// Somebody at a terminal: sees the bar and notes, may press Ctrl-C.
pub(super) struct Terminal<'a> {
    progress: RefCell<Progress>,
    interrupted: &'a dyn Fn() -> bool,
    /// Notes go to stderr as they come.
    tells: bool,
    /// Notes so far.
    foretold: RefCell<Vec<String>>,
}

impl<'a> Terminal<'a> {
    pub(super) fn new(quiet: bool, interrupted: &'a dyn Fn() -> bool) -> Self {
        Self {
            progress: RefCell::new(Progress::new(quiet)),
            interrupted,
            tells: !quiet,
            foretold: RefCell::default(),
        }
    }

    /// A reader of JSON: notes stand in the answer.
    fn listening(interrupted: &'a dyn Fn() -> bool) -> Self {
        Self {
            tells: false,
            ..Self::new(false, interrupted)
        }
    }
}

impl Onlooker for Terminal<'_> {
    fn stop(&self) -> bool {
        self.progress.borrow_mut().rest();
        (self.interrupted)()
    }

    fn see(&self, simulation: &Simulation) {
        self.progress.borrow_mut().show(simulation);
    }

    fn see_run_in(&self, share: f64) {
        self.progress.borrow_mut().run_in(share);
    }

    fn asks_for_time(&self) -> bool {
        true
    }

    fn foretell(&self, sentence: &str) {
        let note = format!("note: {sentence}");
        if self.tells {
            say(&note);
        }
        self.foretold.borrow_mut().push(note);
    }
}

/// The page that ends the run, and its numerics where they are asked for.
fn told(report: &Report, numerics: bool) -> String {
    let text = |name: &str| report.attributes.get(name).and_then(|it| it.as_str());
    let page = text("summary").unwrap_or_default();
    match text("numerics").filter(|_| numerics) {
        Some(numerics) => format!("{page}\n\nnumerics\n{numerics}"),
        None => page.to_owned(),
    }
}
