//! `chaindrive bench`: what do methods and steps cost, and how exact are they?

use std::path::{Path, PathBuf};

use chaindrive::precision::{Study, Variant, work_precision};
use chaindrive::scene::RunDefaults;
use chaindrive::{Request, Scene, Stepping, assemble};
use clap::Args;

use super::output::new_file;
use crate::DrawingRequest;
use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::{RunArguments, SceneArguments, any, some};
use crate::terminal::print;

/// Measures work and precision of methods and steps on a scene; prints a table and saves it.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Time over which to compare, from the start; absent: four teeth, less for short steps
    #[arg(long, value_name = "TIME")]
    until: Option<String>,

    /// Methods to compare, separated by commas; absent: the usual ones with the usual steps
    #[arg(long, value_delimiter = ',', value_parser = Stepping::ALL.map(Stepping::name))]
    methods: Vec<String>,

    /// Steps of the methods with fixed steps, such as "1 us,2 us"; absent: the method's own
    #[arg(long, value_name = "TIMES", value_delimiter = ',')]
    steps: Vec<String>,

    /// Tolerances of dormand-prince, separated by commas; absent: that of the scene
    #[arg(long, value_name = "RATIOS", value_delimiter = ',')]
    tolerances: Vec<String>,

    /// Deepest first penetration in all runs, such as "1 um"; absent: none
    #[arg(long, value_name = "LENGTH")]
    onset_depth: Option<String>,

    /// Timed runs of which the median is taken
    #[arg(long, default_value_t = Study::default().repeats, value_parser = some::<usize>)]
    repeats: usize,

    /// Runs of the reference that start 1e-12 m apart, for the spread of the statistics
    #[arg(long, default_value_t = Study::default().replicates, value_parser = any::<usize>)]
    replicates: usize,

    /// Name of the table, to which .csv is added; absent: work-precision. The command of the Python package adds a
    /// diagram (.svg)
    #[arg(short, long, value_name = "NAME", default_value = "work-precision")]
    output: PathBuf,

    /// Replaces earlier files of this name
    #[arg(long)]
    overwrite: bool,
}

impl Arguments {
    /// The diagram that the Python package draws of the table.
    pub(crate) fn diagram(self) -> DrawingRequest {
        DrawingRequest {
            source: named(&self.output, "csv"),
            output: named(&self.output, "svg"),
            frames: None,
            overwrite: self.overwrite,
            quiet: false,
        }
    }
}

pub(crate) fn bench(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let settings = RunArguments::until(arguments.until.as_deref());
    let Request { scene, run, .. } = settings.apply(&arguments.scene.load(interrupted)?)?;
    let variants = variants(arguments, &scene)?;
    let drive = scene.drive()?;
    let place = new_file(&named(&arguments.output, "csv"), arguments.overwrite)?;
    let start = waiting("assembling", interrupted, |stop| assemble(&drive, stop));
    let start = Failure::or_interrupted(start, scene.name())?;
    let study = Study {
        variants,
        until: arguments.until.is_some().then_some(run.until),
        repeats: arguments.repeats,
        replicates: arguments.replicates,
    };
    let table = waiting("comparing methods", interrupted, |stop| {
        work_precision(&start, &run, &study, stop)
    });
    let table = Failure::or_interrupted(table, scene.name())?;
    print(&table)?;
    let mut text = Vec::new();
    let written = table.write_csv(&mut text);
    written.map_err(|error| Failure::File {
        path: place.path().display().to_string(),
        source: error.into(),
    })?;
    Ok(place.write(&text)?)
}

/// A value of an option, read as the scene reads the same setting, units included.
fn read(
    scene: &Scene,
    (option, path): (&str, &str),
    text: &str,
    of: fn(&RunDefaults) -> Option<f64>,
) -> Result<Option<f64>, Failure> {
    let changed = scene.replace(path, text).map_err(|error| {
        let problems = error.problems.iter();
        let said = problems.map(|problem| match &problem.hint {
            Some(hint) => format!("{}; {hint}", problem.message),
            None => problem.message.clone(),
        });
        Failure::Argument(format!("{option}: {}", said.collect::<Vec<_>>().join("; ")))
    })?;
    Ok(of(&changed.run_defaults()))
}

fn named(base: &Path, extension: &str) -> PathBuf {
    let mut name = base.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

/// Every method with every step or tolerance.
fn variants(arguments: &Arguments, scene: &Scene) -> Result<Vec<Variant>, Failure> {
    let read_all = |names, texts: &[String], of| {
        let values = texts.iter().map(|text| read(scene, names, text, of));
        values.collect::<Result<Vec<_>, _>>()
    };
    let steps = read_all(("--steps", "run.step"), &arguments.steps, |run| run.step)?;
    let tolerances = read_all(
        ("--tolerances", "run.tolerance"),
        &arguments.tolerances,
        |run| run.tolerance,
    )?;
    let onset_depth = read_all(
        ("--onset-depth", "run.onset_depth"),
        arguments.onset_depth.as_slice(),
        |run| run.onset_depth,
    )?;
    let onset_depth = onset_depth.first().copied().flatten();
    if arguments.methods.is_empty() {
        let given = [
            ("--steps", !arguments.steps.is_empty()),
            ("--tolerances", !arguments.tolerances.is_empty()),
            ("--onset-depth", arguments.onset_depth.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
            let message = format!("{name} belongs to methods: name them with --methods");
            return Err(Failure::Argument(message));
        }
    }
    let adaptive = |name: &String| Stepping::from_name(name).is_some_and(Stepping::is_adaptive);
    let with_tolerance = Stepping::ALL
        .into_iter()
        .filter(|stepping| stepping.is_adaptive());
    let with_tolerance: Vec<_> = with_tolerance.map(Stepping::name).collect();
    let with_tolerance = with_tolerance.join(" or ");
    let idle = [
        (
            "--steps",
            &steps,
            "a method with fixed steps",
            arguments.methods.iter().all(adaptive),
        ),
        (
            "--tolerances",
            &tolerances,
            &with_tolerance,
            !arguments.methods.iter().any(adaptive),
        ),
    ];
    if let Some((name, _, of, _)) = idle
        .iter()
        .find(|(_, values, _, idle)| *idle && !values.is_empty())
    {
        let message = format!("{name} is for {of}, and there is none among --methods");
        return Err(Failure::Argument(message));
    }
    let methods = arguments
        .methods
        .iter()
        .filter_map(|name| Stepping::from_name(name));
    let mut list = Vec::new();
    for stepping in methods {
        let adaptive = stepping.is_adaptive();
        let of = |value: Option<f64>| Variant {
            stepping,
            step: value.filter(|_| !adaptive),
            tolerance: value.filter(|_| adaptive),
            onset_depth,
        };
        let values = if adaptive { &tolerances } else { &steps };
        if values.is_empty() {
            list.push(of(None));
        }
        list.extend(values.iter().map(|value| of(*value)));
    }
    Ok(list)
}
