//! `chaindrive sweep`: simulate variants of a scene on all cores, write what sums them up.

mod design;
mod output;
mod vary;

use std::io;
use std::path::{Path, PathBuf};

use chaindrive::Request;
use chaindrive::sweep::{Coordinator, Go, Sweep, SweepMemory, SweepStore, Tally};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::output::{ONE_DOCUMENT, OutputArguments, Page, Target};
use super::run::Status;
use crate::answer::answer;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::request::{RunArguments, SceneArguments, some};
use crate::stream;
use crate::terminal::say;
use output::{Table, fill, refuse_channels};

const VALUES: &str = "\
Values of --vary:
  Every combination of the values of all --vary is a variant; the last path varies fastest.
  Values are separated by commas and written as in a scene, with units or in SI units:
    --vary \"route.pretension=10 kN,15 kN,20 kN\"
    --vary run.method=verlet,rk4
  FIRST..LAST/COUNT stands for COUNT values at equal distances, both ends among them:
    --vary \"sprockets.crank.motion.speed=-80 rpm..-140 rpm/20\"
    --vary sprockets.camshaft.teeth=40..48/5
  Commas and dots in quotes or brackets belong to a value: --vary \"gravity=[0, 0],[0, -9.81]\"

Table of --design:
  A row a variant and a column a path, written as the values of --vary:
    route.pretension,sprockets.crank.motion.speed
    10 kN,-80 rpm
    15 kN,-120 rpm

Method and step:
  Without a named method they are chosen for an accuracy, as in a run: of 1% unless --accuracy says otherwise.
  Steps are tried once for up to 32 variants that differ in numbers only; each takes the step that suits its own
  time scale. accuracy_error, accuracy_kept and step_chosen in the result say what came of it.
  --method auto takes the default step instead.

Results in a store:
  Every task of about a second writes its part of the store. A sweep that was stopped or killed goes on
  with what it lacks when the same command is given again.

Exit codes:
  0    done
  1    some variants failed; they are listed, and the result keeps all others
  2    bad input; nothing was written
  3    the result could not be written
  130  interrupted; the result keeps the variants that were finished and says so";

/// Simulates variants of a scene on all cores; keeps statistics of each, and channels where asked for.
#[derive(Debug, Args)]
#[command(after_help = VALUES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Values for a place in the scene, such as "route.pretension=10 kN,20 kN"; may be repeated
    #[arg(
        long,
        value_name = "PATH=VALUES",
        required_unless_present = "design",
        conflicts_with = "design"
    )]
    vary: Vec<String>,

    /// A table instead (.csv): paths in its first line, and a variant in each of the others
    #[arg(long, value_name = "TABLE")]
    design: Option<PathBuf>,

    #[command(flatten)]
    run: RunArguments,

    /// Variants at a time; as many as there are cores unless given
    #[arg(short, long, value_name = "N", value_parser = some::<usize>)]
    jobs: Option<usize>,

    #[command(flatten)]
    place: OutputArguments,

    /// Prints errors only, and a line if variants are not to be trusted
    #[arg(short, long)]
    quiet: bool,

    /// Prints JSON in place of the report
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

/// Answer of `chaindrive sweep --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Answer {
    /// File or embedded scene.
    scene: String,
    /// How it ended.
    status: Status,
    /// Where the result is; absent where it was not kept.
    output: Option<PathBuf>,
    /// Paths that were varied, in the order of their dimensions.
    swept: Vec<String>,
    /// Number of variants.
    variants: usize,
    /// Variants that reached their end.
    finished: usize,
    /// Variants that failed.
    failed: usize,
    /// Variants that were not carried out.
    open: usize,
    /// Variants that contradict themselves, among those that reached their end.
    distrusted: usize,
    /// The first failures, with their variants.
    failures: Vec<String>,
    /// What speaks against the result; empty where nothing does.
    warnings: Vec<String>,
}

impl Answer {
    fn of(arguments: &Arguments, sweep: &Sweep, tally: &Tally) -> Self {
        Self {
            scene: sweep.scene().name().to_owned(),
            status: match tally.failed {
                _ if tally.open > 0 => Status::Interrupted,
                0 => Status::Complete,
                _ => Status::Failed,
            },
            output: arguments.place.output.clone(),
            swept: sweep
                .dimensions()
                .iter()
                .map(|it| it.path.clone())
                .collect(),
            variants: sweep.len(),
            finished: tally.finished,
            failed: tally.failed,
            open: tally.open,
            distrusted: tally.distrusted,
            failures: tally.failures(sweep),
            warnings: tally.warning(sweep).into_iter().collect(),
        }
    }
}

pub(crate) fn sweep(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let target = Target::of(&arguments.place)?;
    let page = target.page();
    if arguments.json && page == Page::Aside {
        return Err(Failure::Argument(ONE_DOCUMENT.to_owned()));
    }
    let Request { scene, record, .. } = arguments.run.apply(&arguments.scene.load(interrupted)?)?;
    // A scene suggests channels for a run; times the number of variants they are only kept on demand.
    let asked = arguments.run.asks_for_channels();
    let record = if asked { record } else { Vec::new() };
    let sweep = if let Some(table) = &arguments.design {
        Sweep::of_table(&scene, &design::read(table)?, &record)?
    } else {
        let varied = arguments.vary.iter().map(|text| vary::read(&scene, text));
        Sweep::new(&scene, &varied.collect::<Result<Vec<_>, _>>()?, &record)?
    };
    sweep.check_given(&[arguments.run.given(), arguments.scene.given()].concat())?;
    let existing = arguments.place.existing()?;
    let jobs = arguments.jobs;
    let mut progress = Progress::new(arguments.quiet);
    let (mut table, mut on_stdout) = (None, false);
    let mut coordinator: Box<dyn Coordinator> = match target {
        Target::Zarr(path) => {
            let go = || {
                if interrupted() { Go::NoFurther } else { Go::On }
            };
            let store = SweepStore::open(path.as_path(), &sweep, existing, jobs, go)?;
            Box::new(store.ok_or(Failure::Interrupted)?)
        }
        Target::Csv(path) => {
            table = Some(Table::begin(&path, &sweep, existing)?);
            Box::new(SweepMemory::new(&sweep, 1))
        }
        Target::Stream => {
            refuse_channels(Path::new("-"), &sweep)?;
            on_stdout = true;
            Box::new(SweepMemory::new(&sweep, 1))
        }
        Target::Nowhere => Box::new(SweepMemory::new(&sweep, 1)),
    };
    let (mut refused, mut stopped) = (None, false);
    coordinator.run(jobs, &mut |state| {
        progress.count(state.finished, state.variants);
        if let Some(table) = &mut table {
            refused = table.keep(&sweep, state).err();
        }
        stopped = stopped || interrupted();
        if stopped || refused.is_some() {
            Go::NoFurther
        } else {
            Go::On
        }
    })?;
    drop(progress);
    refused.map_or(Ok(()), Err)?;
    let (tally, report) = coordinator.finish()?;
    // With nothing to put in its place, an earlier table stays.
    if let Some(table) = table.as_mut().filter(|_| tally.open < sweep.len()) {
        table.write(&sweep, coordinator.progress().outcomes, &tally.ending())?;
    }
    if on_stdout {
        let stacked = sweep.stack(coordinator.progress().outcomes);
        let filled = fill(io::stdout(), &sweep, &stacked, &tally.ending());
        filled.map_err(stream::refused)?;
    }
    conclude(arguments, &sweep, &tally, (page, report))
}

/// Says what came of a sweep.
fn conclude(
    arguments: &Arguments,
    sweep: &Sweep,
    tally: &Tally,
    (page, report): (Page, String),
) -> Result<(), Failure> {
    if arguments.json {
        answer(&Answer::of(arguments, sweep, tally))?;
    } else {
        if !arguments.quiet {
            page.tell(report)?;
        }
        if let Some(warning) = tally.warning(sweep) {
            say(warning);
        }
        for failure in tally.failures(sweep) {
            say(failure);
        }
    }
    match tally.failed {
        _ if tally.open > 0 => Err(Failure::Interrupted),
        0 => Ok(()),
        failed => Err(Failure::Variants {
            failed,
            variants: sweep.len(),
        }),
    }
}
