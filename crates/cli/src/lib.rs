//! The `chaindrive` command as a library, so that the Python package runs the same one.
//!
//! Data goes to stdout, everything else to stderr.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the simulation failed, or some variants of a sweep; a result keeps the rest and says so |
//! | 2 | bad input; nothing was written |
//! | 3 | the result could not be written |
//! | 4 | `--strict` was asked for, and the verdict on the result is `distrusted` |
//! | 5 | `--strict=chain` or `--strict=all` was asked for, and the verdict on the chain is `fail` |
//! | 70 | a mistake of the program; what is to be reported is told |
//! | 130 | interrupted; a result keeps the samples or variants so far and says so |

mod answer;
mod commands;
mod complaint;
mod csv;
mod failure;
mod progress;
mod request;
mod stream;
mod suggested_values;
mod terminal;

use std::ffi::OsString;
use std::path::PathBuf;

use chaindrive::caught;
use clap::{CommandFactory, Parser, Subcommand};
use serde_json::Value;

use complaint::{Complaint, Trouble};
use failure::Failure;
use terminal::{say, tell};

use commands::{
    bench, check, describe, design, draw, fmu, lab, lists, measurement, replay, report, resume,
    run as run_command, scenes, schemas, shell, sweep,
};

/// Exit code of a run that was stopped by Ctrl-C.
pub const INTERRUPTED: u8 = 130;

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    the simulation failed, or some variants of a sweep; a result keeps the rest and says so
  2    bad input; nothing was written
  3    the result could not be written
  4    --strict was asked for, and the verdict on the result is distrusted
  5    --strict=chain was asked for, and the verdict on the chain is fail
  70   a mistake of chaindrive itself; what to report is told
  130  interrupted; a result keeps the samples or variants so far and says so";

/// Simulates roller chain drives that are described in scene files.
#[derive(Debug, Parser)]
#[command(
    name = "chaindrive",
    disable_version_flag = true,
    arg_required_else_help = true,
    args_conflicts_with_subcommands = true,
    after_help = EXIT_CODES
)]
struct Command {
    /// Prints the version
    #[arg(short = 'V', long)]
    version: bool,
    /// Beside the version: the identity of the build, and the instruction sets that it has and uses
    #[arg(long, requires = "version")]
    verbose: bool,
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Run(run_command::Arguments),
    Resume(resume::Arguments),
    Replay(replay::Arguments),
    Report(report::Arguments),
    CheckData(measurement::CheckData),
    Compare(measurement::Compare),
    Calibrate(measurement::Calibrate),
    Predict(measurement::Predict),
    NextMeasurement(measurement::NextMeasurement),
    Uncertainty(measurement::Uncertainty),
    Tornado(measurement::Tornado),
    Sweep(sweep::Arguments),
    Bench(bench::Arguments),
    Check(check::Arguments),
    Describe(describe::Arguments),
    Design(design::Arguments),
    Draw(draw::Arguments),
    Lab(lab::Arguments),
    Fmu(fmu::Arguments),
    Resolve(scenes::Resolve),
    Diff(scenes::Diff),
    Scenes(lists::Scenes),
    Schema(schemas::Arguments),
    Channels(lists::Channels),
    Catalogue(lists::Catalogue),
    Completion(shell::Completion),
    Man(shell::Man),
}

/// A movie, report or diagram: the Python package draws it.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingRequest {
    /// Result, or, for a report, also a scene file or the name of an embedded scene; for a diagram, the table that [`run`] writes.
    pub source: PathBuf,
    /// The file to make.
    pub output: PathBuf,
    /// Number of pictures, where it is given.
    pub frames: Option<usize>,
    /// Whether an earlier file of this name is replaced.
    pub overwrite: bool,
    /// Whether only errors are told.
    pub quiet: bool,
}

/// The movie, report or diagram that a command line asks of the Python package; none if it asks for anything else, or is wrong: [`run`] tells then.
pub fn drawn<A>(arguments: impl IntoIterator<Item = A>) -> Option<DrawingRequest>
where
    A: Into<OsString> + Clone,
{
    let parsed = caught(|| Command::try_parse_from(arguments).ok()).ok()??;
    match parsed.verb? {
        Verb::Replay(arguments) => arguments.movie(),
        Verb::Report(arguments) => Some(arguments.report()),
        Verb::Bench(arguments) => Some(arguments.diagram()),
        _ => None,
    }
}

/// What a command line asks of the Python package about a measurement: the verb, and its options by name; none if it asks for anything else,
/// or is wrong: [`run`] tells then.
pub fn of_measurement<A>(arguments: impl IntoIterator<Item = A>) -> Option<(&'static str, Value)>
where
    A: Into<OsString> + Clone,
{
    let parsed = caught(|| Command::try_parse_from(arguments).ok()).ok()??;
    match parsed.verb? {
        Verb::CheckData(arguments) => Some(("check-data", measurement::options(&arguments)?)),
        Verb::Compare(arguments) => Some(("compare", measurement::options(&arguments)?)),
        Verb::Calibrate(arguments) => Some(("calibrate", measurement::options(&arguments)?)),
        Verb::Predict(arguments) => Some(("predict", measurement::options(&arguments)?)),
        Verb::NextMeasurement(arguments) => {
            Some(("next-measurement", measurement::options(&arguments)?))
        }
        Verb::Uncertainty(arguments) => Some(("uncertainty", measurement::options(&arguments)?)),
        Verb::Tornado(arguments) => Some(("tornado", measurement::options(&arguments)?)),
        _ => None,
    }
}

/// Runs the command with its arguments, the program's name first, and returns the exit code.
///
/// `interrupted` is asked after every sample whether the user wants the run to stop; the
/// samples so far are then kept.
///
/// # Example
///
/// ```
/// let code = chaindrive_cli::run(["chaindrive", "check", "spinning_ring"], &|| false);
/// assert_eq!(code, 0);
/// ```
pub fn run<A>(arguments: impl IntoIterator<Item = A>, interrupted: &dyn Fn() -> bool) -> u8
where
    A: Into<OsString> + Clone,
{
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let json = arguments.iter().any(|argument| argument == "--json");
    let failed = |failure: &Failure| {
        if json {
            complained(Trouble::of(failure))
        } else {
            told(failure)
        }
    };
    match caught(|| carry_out(arguments, json, interrupted)) {
        Ok(Ok(code)) => code,
        Ok(Err(failure)) => failed(&failure),
        Err(fault) => failed(&Failure::Program(fault)),
    }
}

/// Runs the command; the exit code where it is done, or its failure is told.
fn carry_out(
    arguments: Vec<OsString>,
    json: bool,
    interrupted: &dyn Fn() -> bool,
) -> Result<u8, Failure> {
    let command = match Command::try_parse_from(arguments) {
        Ok(command) => command,
        Err(error) if json && error.use_stderr() => {
            let code = u8::try_from(error.exit_code()).unwrap_or(failure::BAD_INPUT);
            return Ok(complained(Trouble::of_arguments(&error, code)));
        }
        Err(error) => {
            // Complaints go to stderr, and repeat what was typed; help goes to stdout, and a closed pipe is nobody's problem.
            if error.use_stderr() {
                say(error.render().to_string().trim_end());
            } else {
                let _ = error.print();
            }
            return Ok(u8::try_from(error.exit_code()).unwrap_or(failure::BAD_INPUT));
        }
    };
    let Some(verb) = &command.verb else {
        return lists::version(command.verbose).map(|()| 0);
    };
    match verb {
        Verb::Run(arguments) => run_command::run(arguments, interrupted),
        Verb::Resume(arguments) => resume::resume(arguments, interrupted),
        Verb::Replay(arguments) => replay::replay(arguments, interrupted),
        Verb::Report(arguments) => report::report(arguments),
        Verb::CheckData(_) => Err(measurement::elsewhere("check-data")),
        Verb::Compare(_) => Err(measurement::elsewhere("compare")),
        Verb::Calibrate(_) => Err(measurement::elsewhere("calibrate")),
        Verb::Predict(_) => Err(measurement::elsewhere("predict")),
        Verb::NextMeasurement(_) => Err(measurement::elsewhere("next-measurement")),
        Verb::Uncertainty(_) => Err(measurement::elsewhere("uncertainty")),
        Verb::Tornado(_) => Err(measurement::elsewhere("tornado")),
        Verb::Sweep(arguments) => sweep::sweep(arguments, interrupted),
        Verb::Bench(arguments) => bench::bench(arguments, interrupted),
        Verb::Check(arguments) => check::check(arguments, interrupted),
        Verb::Describe(arguments) => describe::describe(arguments, interrupted),
        Verb::Design(arguments) => design::design(arguments, interrupted),
        Verb::Draw(arguments) => draw::draw(arguments, interrupted),
        Verb::Lab(arguments) => lab::lab(arguments, interrupted),
        Verb::Fmu(arguments) => fmu::fmu(arguments, interrupted),
        Verb::Resolve(arguments) => scenes::resolve(arguments, interrupted),
        Verb::Diff(arguments) => scenes::diff(arguments, interrupted),
        Verb::Scenes(arguments) => lists::scenes(arguments),
        Verb::Schema(arguments) => schemas::schema(arguments),
        Verb::Channels(arguments) => lists::channels(arguments),
        Verb::Catalogue(arguments) => lists::catalogue(arguments),
        Verb::Completion(arguments) => shell::completion(arguments, Command::command()),
        Verb::Man(arguments) => shell::man(arguments, Command::command()),
    }
    .map(|()| 0)
}

/// Writes a failure as JSON.
fn complained(error: Trouble) -> u8 {
    let code = error.exit_code;
    let text = serde_json::to_string_pretty(&Complaint { error });
    say(chaindrive::plain_json(&text.unwrap_or_default()));
    code
}

fn told(failure: &Failure) -> u8 {
    tell(failure);
    failure.exit_code()
}
