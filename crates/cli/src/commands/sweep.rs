//! `chaindrive sweep`: simulate variants of a scene on all cores, write what sums them up.

mod output;
mod vary;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use chaindrive::Request;
use chaindrive::record::{Ending, Existing};
use chaindrive::sweep::{Go, Outcome, Sweep};
use clap::Args;

use super::output::Target;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::request::{RunArguments, SceneArguments};
use crate::stdout::print;
use output::Output;

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

Method and step:
  Without a named method `chaindrive run` chooses its step for an accuracy of 1%.
  There a sweep takes the default step: trials in every variant would double the cost of short ones.
  With --accuracy 1% every variant chooses for itself, as its run would; accuracy_error and
  accuracy_kept in the result say what came of it.

Exit codes:
  0    done
  1    some variants failed; they are listed, and the result keeps all others
  2    bad input; nothing was written
  3    the result could not be written
  130  interrupted; the result keeps the variants that were finished and says so";

/// Unlike a run, a sweep has none unless it is asked for.
const ACCURACY: &str = "\
Largest relative error of the tension, such as 1%: every variant chooses method, step and onset depth for it, as its \
run would. None unless given here or in the scene: then every variant takes the method and step of the scene, or the \
default ones";

/// Simulates variants of a scene on all cores; keeps statistics of each, and channels where asked for.
#[derive(Debug, Args)]
#[command(after_help = VALUES, mut_arg("accuracy", |it| it.help(ACCURACY)))]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Values for a place in the scene, such as "route.pretension=10 kN,20 kN"; may be repeated
    #[arg(long, value_name = "PATH=VALUES", required = true)]
    vary: Vec<String>,

    #[command(flatten)]
    run: RunArguments,

    /// Variants at a time; as many as there are cores unless given
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Where the result goes: a Zarr store (.zarr), or a table with a row a variant (.csv)
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier result of the same name
    #[arg(long)]
    overwrite: bool,

    /// Prints errors only, and a line if variants are not to be trusted
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn sweep(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let target = Target::of(arguments.output.as_deref())?;
    let Request { scene, record, .. } = arguments.run.apply(&arguments.scene.load(interrupted)?)?;
    // A scene suggests channels for a run; times the number of variants they are only kept on demand.
    let asked = arguments.run.asks_for_channels();
    let record = if asked { record } else { Vec::new() };
    let varied = arguments.vary.iter().map(|text| vary::read(&scene, text));
    let varied = varied.collect::<Result<Vec<_>, _>>()?;
    let sweep = Sweep::new(&scene, &varied, &record)?;
    sweep.check_given(&[arguments.run.given(), arguments.scene.given()].concat())?;
    let existing = if arguments.overwrite {
        Existing::Replace
    } else {
        Existing::Keep
    };
    let mut output = Output::begin(target, &sweep, existing)?;

    let mut progress = Progress::new(arguments.quiet);
    let mut refused = None;
    let mut stopped = false;
    let outcomes = sweep.run(arguments.jobs.map(NonZeroUsize::get), |state| {
        progress.count(state.finished, sweep.len());
        if let Err(error) = output.keep(&sweep, state) {
            refused = Some(error);
        }
        stopped = stopped || interrupted();
        if stopped || refused.is_some() {
            Go::NoFurther
        } else {
            Go::On
        }
    })?;
    drop(progress);
    if let Some(error) = refused {
        return Err(error);
    }
    let open = outcomes.contains(&Outcome::Open);
    output.write(&sweep, &outcomes, &Ending::of(&outcomes))?;
    if !arguments.quiet {
        print(sweep.report(&outcomes))?;
    }
    if let Some(warning) = sweep.warning(&outcomes) {
        eprintln!("{warning}");
    }
    for failure in sweep.failures(&outcomes) {
        eprintln!("{failure}");
    }
    let failed = outcomes.iter();
    let failed = failed.filter(|outcome| matches!(outcome, Outcome::Failed(_)));
    match failed.count() {
        _ if open => Err(Failure::Interrupted),
        0 => Ok(()),
        failed => Err(Failure::Variants {
            failed,
            variants: sweep.len(),
        }),
    }
}
