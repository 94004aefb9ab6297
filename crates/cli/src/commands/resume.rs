//! `chaindrive resume`: carry a run on that was stopped or killed.

use std::path::PathBuf;

use chaindrive::SettingValue;
use chaindrive::record::{StoppedRun, take_over};
use clap::Args;

use super::output::Page;
use super::run::{ReportOptions, Terminal, concluded, not_run};
use crate::failure::Failure;
use crate::terminal::say;

const CHECKPOINTS: &str = "\
What there is to go on from:
  Ctrl-C and SIGTERM leave a checkpoint in a Zarr result, and a run with --checkpoint-every leaves one at
  its beginning, under way and at its end. What the result holds after the checkpoint is simulated again:
  in the end it is that of a run that was never stopped, to the last bit, but for the wall times.
  Only the version that wrote a checkpoint reads it.";

/// Carries on a run that was stopped or killed, or a complete one to a later end.
#[derive(Debug, Args)]
#[command(after_help = CHECKPOINTS)]
pub(crate) struct Arguments {
    /// The Zarr result of the run
    #[arg(value_name = "RESULT")]
    result: PathBuf,

    /// Another end of the run than was asked for, such as "2 s"
    #[arg(long, value_name = "TIME")]
    until: Option<String>,

    /// Takes over where another user, or a process that died, left the folder of a writer
    #[arg(long)]
    take_over: bool,

    #[command(flatten)]
    telling: ReportOptions,
}

pub(crate) fn resume(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let until = arguments
        .until
        .clone()
        .map(|until| SettingValue::written(&until));
    if arguments.take_over {
        take_over(&arguments.result)?;
    }
    let stopped = StoppedRun::open(&arguments.result, until.as_ref())?;
    let checkpoint = stopped.checkpoint();
    if !arguments.telling.quiet {
        let (time, until) = (checkpoint.time(), checkpoint.until());
        let samples = checkpoint.samples();
        say(format_args!(
            "going on from t = {time:.6} s of {until} s, after {samples} samples"
        ));
    }
    let scene = checkpoint.scene_name().to_owned();
    let terminal = Terminal::new(arguments.telling.quiet, interrupted);
    let report = stopped.resume(&terminal);
    let report = report.map_err(|error| not_run(error, &scene))?;
    drop(terminal);
    concluded(report, &scene, arguments.telling, Page::Out)
}
