//! Request of a run: a scene, changes to it, and the settings of the command line.

use std::path::Path;

use chaindrive::scene::{Datum, SceneError, presets};
use chaindrive::{
    Channel, Request, RequestError, Scene, SettingValue, Settings, SimulationError, Stepping,
    patiently,
};
use clap::Args;

use crate::failure::Failure;
use crate::suggested_values::SuggestedValues;

/// A scene and what is changed in it.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// Scene file (TOML or JSON, `-` for stdin) or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    scene: String,

    #[command(flatten)]
    changes: Changes,
}

/// What is changed in a scene.
#[derive(Debug, Args)]
pub(crate) struct Changes {
    /// Replaces a value of the scene, such as chain.links=80 or "sprockets.crank.motion.speed=-90 rpm"; a number without a
    /// unit is in SI units, and a speed of rotation in rad/s; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
}

/// Settings of a run; absent ones are those of the scene.
#[derive(Debug, Default, Args)]
pub(crate) struct RunArguments {
    /// End of the run, such as "1 s" or 1
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    until: Option<String>,

    /// Time simulated before t = 0: seconds, turns of a sprocket such as "5 turns of camshaft", or auto, until the
    /// tensions are steady
    #[arg(long, value_name = "TIME|TURNS|auto", allow_hyphen_values = true)]
    run_in: Option<String>,

    /// Time between two samples, such as "0.1 ms"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    every: Option<String>,

    /// Method of time stepping; implicit-damping and generalized-alpha are for rigid links and free rollers
    #[arg(long, value_parser = Stepping::ALL.map(Stepping::name))]
    method: Option<String>,

    /// Step of a method with a fixed step, longest step of an adaptive one
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    step: Option<String>,

    /// Relative tolerance of an adaptive method
    #[arg(long, value_name = "RATIO")]
    tolerance: Option<String>,

    /// Deepest penetration at which a contact may begin, such as "1 um"; deeper steps are taken again, shorter
    #[arg(long, value_name = "LENGTH")]
    onset_depth: Option<String>,

    /// Largest relative error of the tension, such as 1%: method, step and onset depth are chosen for
    /// it, and the choice is printed. 1% unless one of them or a tolerance is given
    #[arg(long, value_name = "RATIO", conflicts_with_all = ["method", "step", "tolerance", "onset_depth"])]
    accuracy: Option<String>,

    /// Quantity that the accuracy is one of: the tension, the losses and with them the efficiency, or the impacts of rollers
    #[arg(long, value_name = "QUANTITY", value_parser = ["tension", "losses", "impacts"], conflicts_with_all = ["method", "step", "tolerance", "onset_depth"])]
    accuracy_of: Option<String>,

    /// Channels to record, separated by commas, or all; `chaindrive channels` lists them
    #[arg(long, value_name = "CHANNELS", value_delimiter = ',', value_parser = channels(), hide_possible_values = true)]
    record: Vec<String>,

    /// Contacts to log, separated by commas: teeth, guides, joints; they go into the result and the summary
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = SuggestedValues(vec!["teeth", "guides", "joints"]), hide_possible_values = true)]
    events: Vec<String>,
}

/// Reads a number of things, at least one.
pub(crate) fn some<T: TryFrom<u64>>(text: &str) -> Result<T, String> {
    counted(text, 1)
}

/// Reads a number of things, perhaps none.
pub(crate) fn any<T: TryFrom<u64>>(text: &str) -> Result<T, String> {
    counted(text, 0)
}

fn counted<T: TryFrom<u64>>(text: &str, least: u64) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| *number >= least);
    let number = number.and_then(|number| T::try_from(number).ok());
    number.ok_or_else(|| format!("must be a whole number, {least} or more"))
}

/// Channels as shells complete them.
pub(crate) fn channels() -> SuggestedValues {
    let names = Channel::ALL.iter().map(|channel| channel.name());
    SuggestedValues(names.chain(["all"]).collect())
}

/// Reads a scene file, stdin or an embedded scene; what comes through a pipe may be a long time in coming.
pub(crate) fn load(name: &str, interrupted: &dyn Fn() -> bool) -> Result<Scene, Failure> {
    let read = |work: Box<dyn FnOnce() -> Result<Scene, SceneError> + Send>| {
        Ok(Failure::or_interrupted(
            patiently(work, interrupted),
            name,
        )??)
    };
    if name == "-" {
        return read(Box::new(|| {
            Scene::read_from(std::io::stdin().lock(), "stdin")
        }));
    }
    let path = Path::new(name);
    let preset = presets().iter().any(|(known, _)| *known == name);
    let looks_like_a_file = path.extension().is_some() || path.components().count() > 1;
    // Whatever exists is to be read, pipes and devices too, but for a folder that is called like an embedded scene.
    if (path.exists() && !path.is_dir()) || ((path.exists() || looks_like_a_file) && !preset) {
        let path = path.to_owned();
        read(Box::new(|| Scene::read(path)))
    } else {
        Ok(Scene::preset(name)?)
    }
}

impl SceneArguments {
    /// The file, preset or result, as it was given.
    pub(crate) fn name(&self) -> &str {
        &self.scene
    }

    /// Paths that are changed, and how the command line says so.
    pub(crate) fn given(&self) -> Vec<(String, String)> {
        let paths = self
            .changes
            .set
            .iter()
            .filter_map(|change| change.split_once('='));
        paths
            .map(|(path, _)| (path.trim().to_owned(), format!("--set {}", path.trim())))
            .collect()
    }

    /// The scene with its changes.
    pub(crate) fn load(&self, interrupted: &dyn Fn() -> bool) -> Result<Scene, Failure> {
        self.changes.made_in(load(&self.scene, interrupted)?)
    }

    /// Numbers without a unit where a quantity has one: they are in SI units, and perhaps were not meant so.
    pub(crate) fn notes(&self, scene: &Scene) -> Vec<String> {
        self.changes.notes(scene)
    }
}

impl Changes {
    /// The scene with the changes.
    pub(crate) fn made_in(&self, mut scene: Scene) -> Result<Scene, Failure> {
        for change in &self.set {
            let Some((path, value)) = change.split_once('=') else {
                return Err(Failure::Argument(format!(
                    "--set {change}: a path and a value are needed, such as chain.links=80"
                )));
            };
            let (path, value) = (path.trim(), value.trim());
            let changed = scene.replace(path, value);
            scene = changed.map_err(|error| by_option(error, &format!("--set {path}")))?;
        }
        Ok(scene)
    }

    /// Numbers without a unit where a quantity has one: they are in SI units, and perhaps were not meant so.
    pub(crate) fn notes(&self, scene: &Scene) -> Vec<String> {
        let changes = self.set.iter().filter_map(|change| change.split_once('='));
        let bare = changes.filter(|(_, value)| {
            let number = value.trim().parse::<f64>();
            number.is_ok_and(|number| number.abs() > 0.0)
        });
        bare.filter_map(|(path, value)| match scene.datum(path.trim())? {
            Datum::Quantity(_, unit) if unit != "1" => Some(format!(
                "note: --set {}: {value} without a unit is {value} {unit}",
                path.trim()
            )),
            _ => None,
        })
        .collect()
    }
}

/// The mistake in a value that an option gave.
fn by_option(error: SceneError, option: &str) -> SceneError {
    SceneError {
        source_name: option.to_owned(),
        ..error.nowhere()
    }
}

impl RunArguments {
    /// Whether channels are asked for, other than by the scene.
    pub(crate) fn asks_for_channels(&self) -> bool {
        self.record.iter().any(|name| !name.trim().is_empty())
    }

    /// Contacts in an option, not in the scene alone.
    pub(crate) fn asks_for_contacts(&self) -> bool {
        self.events.iter().any(|name| !name.trim().is_empty())
    }

    /// Nothing but the end of the run.
    pub(crate) fn until(until: Option<&str>) -> Self {
        Self {
            until: until.map(str::to_owned),
            ..Self::default()
        }
    }

    /// Given values: paths in the scene, and the options of the command line.
    pub(crate) fn given(&self) -> Vec<(String, String)> {
        let named = [
            ("run.record", "--record", &self.record),
            ("run.events", "--events", &self.events),
        ];
        let named = named.map(|(path, option, names)| (path, option, !names.is_empty()));
        let settings = self.settings();
        let settings = settings.map(|(path, option, value)| (path, option, value.is_some()));
        let all = settings.into_iter().chain(named);
        all.filter(|(.., given)| *given)
            .map(|(path, option, _)| (path.to_owned(), option.to_owned()))
            .collect()
    }

    /// Path in the scene, option and value.
    fn settings(&self) -> [(&'static str, &'static str, &Option<String>); 9] {
        [
            ("run.until", "--until", &self.until),
            ("run.run_in", "--run-in", &self.run_in),
            ("run.every", "--every", &self.every),
            ("run.method", "--method", &self.method),
            ("run.step", "--step", &self.step),
            ("run.tolerance", "--tolerance", &self.tolerance),
            ("run.onset_depth", "--onset-depth", &self.onset_depth),
            ("run.accuracy", "--accuracy", &self.accuracy),
            ("run.accuracy_of", "--accuracy-of", &self.accuracy_of),
        ]
    }

    /// The run of a scene with these settings.
    ///
    /// The channels are names: which of them a chain has is known when it is assembled.
    pub(crate) fn apply(&self, scene: &Scene) -> Result<Request, Failure> {
        let mut settings = Settings::default();
        for (path, _, value) in self.settings() {
            if let Some(value) = value {
                settings = settings.with(key(path), SettingValue::written(value));
            }
        }
        for (path, names) in [("run.record", &self.record), ("run.events", &self.events)] {
            let names = names.iter().map(|name| name.trim().to_owned());
            let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
            if !names.is_empty() {
                settings = settings.with(key(path), SettingValue::Names(names));
            }
        }
        Request::new(scene, &settings).map_err(|error| self.refused(error, scene.name()))
    }

    /// The mistake in what was asked for, by the option that asked for it.
    fn refused(&self, error: RequestError, scene: &str) -> Failure {
        let settings = self.settings().into_iter();
        let given: Vec<_> = settings.filter(|(.., value)| value.is_some()).collect();
        let option = |path: &str| {
            let found = given.iter().find(|(known, ..)| *known == path);
            found.map(|(_, option, _)| *option)
        };
        match error {
            RequestError::Scene(mut error) => {
                let path = error.problems.first().map(|problem| problem.path.as_str());
                let Some(option) = path.and_then(option) else {
                    return error.into();
                };
                // The option says which setting it is.
                for problem in &mut error.problems {
                    problem.path.clear();
                }
                by_option(error, option).into()
            }
            RequestError::Setting(SimulationError::Setting {
                name,
                value,
                allowed,
            }) if option(&format!("run.{name}")).is_some() => Failure::Argument(format!(
                "{}: {value}, must be {allowed}",
                option(&format!("run.{name}")).unwrap_or_default()
            )),
            error => Failure::request(error, scene),
        }
    }
}

/// The key of a path in `[run]`.
fn key(path: &str) -> &str {
    path.trim_start_matches("run.")
}
