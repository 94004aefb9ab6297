//! `chaindrive check-data`, `compare`, `calibrate`, `predict`, `next-measurement`: a measurement and a drive, which the Python package holds
//! against each other; `uncertainty`, `tornado`: what is not known of a drive, which it varies.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::request::some;

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

/// Length, store and number of the runs behind an answer.
#[derive(Debug, Args, Serialize)]
struct Runs {
    /// End of the runs, such as "0.5 s"
    #[arg(long, value_name = "TIME")]
    until: Option<String>,

    /// Folder in which every run is kept: the same command goes on there after Ctrl-C
    #[arg(long, value_name = "FOLDER")]
    store: Option<PathBuf>,

    /// Runs at a time; as many as there are cores unless given
    #[arg(short, long, value_name = "N", value_parser = some::<usize>)]
    jobs: Option<usize>,

    /// Prints JSON in place of the page
    #[arg(long)]
    json: bool,
}

/// Diagram of an answer.
#[derive(Debug, Args, Serialize)]
struct Diagram {
    /// Diagram (.png, .svg, .pdf)
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier diagram
    #[arg(long)]
    overwrite: bool,
}

/// Outputs of a drive.
#[derive(Debug, Args, Serialize)]
struct Outputs {
    /// A statistic of a sweep, such as "span_tension_std[driven-driver]", or loss_share; may be repeated
    #[arg(long, value_name = "OUTPUT")]
    of: Vec<String>,
}

/// Fits values of a scene to a measurement, with intervals of all errors, or refuses with a reason; by the command of the Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct Calibrate {
    /// Scene file or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    source: String,

    #[command(flatten)]
    #[serde(flatten)]
    record: Record,

    /// A value that is fitted, between two bounds, such as "chain.stiffness=10 MN/m..40 MN/m"; may be repeated
    #[arg(long, value_name = "PATH=LOW..HIGH", required = true)]
    free: Vec<String>,

    /// Prior of a fitted value: mean and standard deviation, such as "chain.stiffness=20 MN/m±1 MN/m"; may be repeated
    #[arg(long, value_name = "PATH=MEAN±DEVIATION")]
    prior: Vec<String>,

    /// Starts over the ranges; 5 unless given
    #[arg(long, value_name = "N", value_parser = some::<usize>)]
    starts: Option<usize>,

    /// The fitted drive (.toml) or the report of the fit (.html); may be repeated
    #[arg(short, long, value_name = "OUT")]
    output: Vec<PathBuf>,

    /// Replaces earlier files
    #[arg(long)]
    overwrite: bool,

    #[command(flatten)]
    #[serde(flatten)]
    runs: Runs,
}

/// Foretells outputs of a calibrated drive, here or at another operating point, with the band of all errors; by the command of the
/// Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct Predict {
    /// The fit: what `chaindrive calibrate --json` printed
    fit: PathBuf,

    /// A value of the scene that is another operating point, such as "sprockets.crank.motion.speed=600 rpm"; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    at: Vec<String>,

    /// Largest factor, up or down, between a value there and in the fit; 3 unless given
    #[arg(long, value_name = "N")]
    reach: Option<f64>,

    #[command(flatten)]
    #[serde(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    #[serde(flatten)]
    runs: Runs,
}

/// Tells which channel, at which operating point and how long, would settle most of what is not known of a drive; by the command of the
/// Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct NextMeasurement {
    /// Scene file or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    source: String,

    /// A value that is not known, between two bounds, such as "chain.stiffness=10 MN/m..40 MN/m"; may be repeated
    #[arg(long, value_name = "PATH=LOW..HIGH", required = true)]
    free: Vec<String>,

    /// A quantity that could be measured, such as "span_tension[driven-driver]"; may be repeated
    #[arg(long, value_name = "QUANTITY")]
    candidate: Vec<String>,

    /// Sensors that could be mounted: a TOML file with channels as `chaindrive.measured` takes them
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,

    /// A value of an operating point that the rig can run, such as "slow:sprockets.driver.motion.speed=150 rpm"; may be repeated, also of one
    /// name
    #[arg(long, value_name = "NAME:PATH=VALUE")]
    excitation: Vec<String>,

    /// The value that is to be settled, of those that are not known; all of them unless given
    #[arg(long, value_name = "PATH")]
    settle: Option<String>,

    /// A fit from which errors shrink: what `chaindrive calibrate --json` printed
    #[arg(long, value_name = "FIT")]
    known: Option<PathBuf>,

    /// Sampling rate of the record, such as "2 kHz"; 1 kHz unless given
    #[arg(long, value_name = "RATE")]
    rate: Option<String>,

    /// Length of the record, such as "5 s"; 1 s unless given
    #[arg(long, value_name = "TIME")]
    record: Option<String>,

    /// Length of the runs; 0.2 s unless given
    #[arg(long, value_name = "TIME")]
    until: Option<String>,

    /// Prints JSON in place of the page
    #[arg(long)]
    json: bool,
}

/// Carries distributions of values through a drive: the spread of outputs, and whose it is (indices of Sobol); by the command of the
/// Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct Uncertainty {
    /// Scene file or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    source: String,

    /// The distribution of a value: "route.pretension=1 kN..2 kN" (all alike), or normal(mean, deviation), uniform(low, high),
    /// triangular(low, mode, high), lognormal(median, factor); may be repeated
    #[arg(long, value_name = "PATH=DISTRIBUTION", required = true)]
    draw: Vec<String>,

    /// Samples, a power of two: each is as many variants as there are values, and three; 64 unless given
    #[arg(long, value_name = "N", value_parser = some::<usize>)]
    samples: Option<usize>,

    /// Seed of the samples; 1 unless given
    #[arg(long, value_name = "N")]
    seed: Option<u32>,

    #[command(flatten)]
    #[serde(flatten)]
    diagram: Diagram,

    #[command(flatten)]
    #[serde(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    #[serde(flatten)]
    runs: Runs,
}

/// Ranks values that nobody has measured by what the ends of their ranges move; by the command of the Python package.
#[derive(Debug, Args, Serialize)]
pub(crate) struct Tornado {
    /// Scene file or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    source: String,

    /// The range of a value, such as "route.pretension=1 kN..2 kN"; may be repeated
    #[arg(long, value_name = "PATH=LOW..HIGH", required = true)]
    range: Vec<String>,

    #[command(flatten)]
    #[serde(flatten)]
    diagram: Diagram,

    #[command(flatten)]
    #[serde(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    #[serde(flatten)]
    runs: Runs,
}

/// The options of a verb, as the Python package takes them; none that are no text.
pub(crate) fn options(arguments: &impl Serialize) -> Option<Value> {
    serde_json::to_value(arguments).ok()
}

/// Names the command that can do it.
pub(crate) fn elsewhere(verb: &str) -> Failure {
    Failure::Argument(format!(
        "{verb}: the Python package does it; install chaindrive[analysis] there, and give its command the same arguments"
    ))
}
