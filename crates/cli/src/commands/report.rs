//! `chaindrive report`: the report of a run, which the Python package makes.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::DrawingRequest;
use crate::failure::Failure;

/// Makes the report of a scene or a result, one HTML file that prints well, by the command of the Python package.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Scene file, name of an embedded scene, or result (.zarr)
    #[arg(value_name = "SCENE|PRESET|RESULT")]
    source: String,

    /// The report (.html)
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier report
    #[arg(long)]
    overwrite: bool,

    /// Prints errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Arguments {
    /// What the Python package is to make.
    pub(crate) fn report(self) -> DrawingRequest {
        let named = || Path::new(&self.source).with_extension("html");
        let beside = || named().file_name().map_or_else(named, PathBuf::from);
        DrawingRequest {
            output: self.output.clone().unwrap_or_else(beside),
            source: self.source.into(),
            frames: None,
            overwrite: self.overwrite,
            quiet: self.quiet,
        }
    }
}

pub(crate) fn report(arguments: &Arguments) -> Result<(), Failure> {
    let output = arguments
        .output
        .as_ref()
        .map(|it| format!(" -o {}", it.display()));
    let options = [
        (arguments.overwrite, " --overwrite"),
        (arguments.quiet, " -q"),
    ];
    let options = options
        .into_iter()
        .filter_map(|(given, option)| given.then_some(option));
    let source = &arguments.source;
    Err(Failure::Argument(format!(
        "{source}: the Python package draws reports; install chaindrive[plot,analysis] there, and give it the same command: chaindrive report {source}{}{}",
        output.unwrap_or_default(),
        options.collect::<String>()
    )))
}
