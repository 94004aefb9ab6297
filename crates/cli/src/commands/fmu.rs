//! `chaindrive fmu`: a drive as a functional mock-up unit for other simulators.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

use chaindrive_couple::{Export, LIBRARY, Model, PackageError, Standard, package, read_library};
use clap::Args;

use super::output::{beside_program, new_file};
use super::run::{Terminal, not_run};
use crate::failure::Failure;
use crate::request::{RunArguments, SceneArguments};
use crate::terminal::say;

const INTERFACE: &str = "\
Inputs and outputs:
  Every shaft takes set_torque, set_speed or set_angle, which its parameter input chooses; tensioners take
  set_force, and fixed centres set_centre_x and set_centre_y. Parameters that the scene lists under `tunable`
  can be changed under way. Outputs are the entries of channels, such as span_tension[crank-camshaft]; --record
  names other channels. at_export holds the verdict on a run of the scene without inputs.";

/// Writes a functional mock-up unit (FMU) of a drive, for co-simulation in other programs.
#[derive(Debug, Args)]
#[command(after_help = INTERFACE)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    #[command(flatten)]
    run: RunArguments,

    /// The unit to write
    #[arg(short, long, value_name = "OUT.fmu")]
    output: PathBuf,

    /// Version of the standard
    #[arg(long, value_name = "VERSION", default_value = "3", value_parser = ["2", "3"])]
    fmi: String,

    /// Leaves out the run that says the verdict and the horizon
    #[arg(long)]
    no_run: bool,

    /// Library of the unit; the one beside the program where it is absent
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,

    /// Replaces an earlier file of the same name
    #[arg(long)]
    overwrite: bool,

    /// Prints errors only
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn fmu(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let output = &arguments.output;
    let path = output.display().to_string();
    if output.extension().is_none_or(|it| it != "fmu") {
        return Err(Failure::Argument(format!(
            "{path}: the name must end in .fmu"
        )));
    }
    let place = new_file(output, arguments.overwrite)?;
    let refused = |error: PackageError| Failure::Argument(error.to_string());
    let library = match &arguments.library {
        Some(library) => library.clone(),
        None => beside_program(
            &format!("{DLL_PREFIX}{LIBRARY}{DLL_SUFFIX}"),
            "--library",
            "name the library of units, or build it beside the program: cargo build --release",
        )?,
    };
    let library = read_library(&library).map_err(refused)?;
    let standard = match arguments.fmi.as_str() {
        "2" => Standard::Two,
        _ => Standard::Three,
    };
    let request = arguments.run.apply(&arguments.scene.load(interrupted)?)?;
    let scene = request.scene.name().to_owned();
    let name = output.file_stem().unwrap_or_default().to_string_lossy();
    let mut export = Export::new(&request, &name);
    if !arguments.no_run {
        let terminal = Terminal::new(arguments.quiet, interrupted);
        let told = export.tell_run(&request, &terminal);
        told.map_err(|error| not_run(error, &scene))?;
    }
    let model =
        Model::new(export).map_err(|error| Failure::Argument(format!("{scene}: {error}")))?;
    let unit = package(&model, standard, &library).map_err(refused)?;
    place.write(&unit)?;
    if !arguments.quiet {
        let variables = model.variables().len();
        say(format_args!(
            "{}: FMI {}, {variables} variables, {} kB",
            output.display(),
            arguments.fmi,
            unit.len() / 1000
        ));
    }
    Ok(())
}
