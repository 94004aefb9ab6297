//! `chaindrive check-data`, `compare`: a measurement and a drive, which the Python package holds against each other.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;

/// A measurement, and what its channels are.
#[derive(Debug, Args, Serialize)]
struct Record {
    /// The measurement: .csv, .parquet, .nc, .h5, .tdms, .mf4 or .wav
    data: PathBuf,

    /// What the channels are: a TOML file with the arguments of `chaindrive.measured`, such as [channels.torque] with
    /// quantity, unit and uncertainty
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
}

/// Tells what a measurement can say of a drive, before any fit; by the command of the Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct CheckData {
    /// Scene file or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    source: String,

    #[command(flatten)]
    #[serde(flatten)]
    record: Record,

    /// A value of the scene that is to be fitted, between two bounds, such as "chain.stiffness=10 MN/m..40 MN/m"; may be
    /// repeated
    #[arg(long, value_name = "PATH=LOW..HIGH")]
    free: Vec<String>,

    /// Prints JSON in place of the page
    #[arg(long)]
    json: bool,
}

/// Compares a run with a measurement: per quantity whether they agree, by how much they miss, or that nobody can tell; by the
/// command of the Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct Compare {
    /// Scene file or name of an embedded scene, which is run as long as the measurement, or result (.zarr)
    #[arg(value_name = "SCENE|PRESET|RESULT")]
    source: String,

    #[command(flatten)]
    #[serde(flatten)]
    record: Record,

    /// The report of the run (.html) with the comparison in it; absent: none
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier report
    #[arg(long)]
    overwrite: bool,

    /// Prints JSON in place of the page
    #[arg(long)]
    json: bool,
}

/// The options of a verb, as the Python package takes them; none that are no text.
pub(crate) fn options(arguments: &impl Serialize) -> Option<Value> {
    serde_json::to_value(arguments).ok()
}

/// Names the command that can do it.
pub(crate) fn elsewhere(verb: &str) -> Failure {
    Failure::Argument(format!(
        "{verb}: the Python package reads measurements; install chaindrive[analysis] there, and give its command the same arguments"
    ))
}
