//! Settings that a caller gives for a run, and what they take precedence over.

use serde_json::Value as Json;

use super::NUMBERS;
use crate::scene::{STEPPING_KEYS, Scene, SceneError};
use crate::{RequestError, SimulationError, Stepping};

/// A value that a caller gives for a key of `[run]`.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingValue {
    /// As a scene writes it, with a unit: `1 ms`. A number without one is refused where the setting has a unit.
    Text(String),
    /// In SI units.
    Number(f64),
    /// Names, such as those of channels.
    Names(Vec<String>),
}

/// Settings of a run that a caller gives; what is absent is that of the scene.
///
/// They are written into the scene, where they are checked with their units like everything else; the text that a
/// result carries then reproduces the run. One rule for the command line, Python, Rust and sweeps:
///
/// | goes before | what |
/// |---|---|
/// | what is given | what the scene's `[run]` says |
/// | the scene's `[run]` | the defaults |
/// | a method, step, tolerance or onset depth that is given | the scene's accuracy |
/// | an accuracy that is given | the scene's method, step, tolerance and onset depth |
/// | a method that is given and is not the scene's | the scene's step, which belongs to the scene's method |
///
/// # Example
///
/// ```
/// use chaindrive::{SettingValue, Request, Scene, Settings, Stepping};
///
/// let scene = Scene::preset("spinning_ring")?.replace("run.step", "10 us")?;
/// let settings = Settings::default().with("until", SettingValue::Text("2 ms".into()));
/// assert_eq!(Request::new(&scene, &settings)?.run.step, Some(1e-5));
///
/// let settings = settings.with("method", SettingValue::Text("rk4".into()));
/// let request = Request::new(&scene, &settings)?;
/// assert_eq!((request.run.stepping, request.run.step), (Stepping::Rk4, None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(Vec<(String, SettingValue)>);

impl Settings {
    /// The settings with one more, by its key in `[run]`.
    #[must_use]
    pub fn with(mut self, key: &str, value: SettingValue) -> Self {
        self.0.retain(|(known, _)| known != key);
        self.0.push((key.to_owned(), value));
        self
    }

    fn get(&self, key: &str) -> Option<&SettingValue> {
        self.0
            .iter()
            .find_map(|(known, value)| (known == key).then_some(value))
    }

    /// The scene with the settings in its `[run]`.
    pub(crate) fn put(&self, scene: &Scene) -> Result<Scene, RequestError> {
        self.check()?;
        let mut scene = scene.clone();
        for key in self.replaced(&scene) {
            scene = scene.without(&format!("run.{key}"))?;
        }
        for (key, value) in &self.0 {
            scene = value.put(&scene, &format!("run.{key}"))?;
        }
        Ok(scene)
    }

    /// Keys of the scene that cease to hold.
    fn replaced(&self, scene: &Scene) -> Vec<&'static str> {
        let mut keys = Vec::new();
        if STEPPING_KEYS.iter().any(|key| self.get(key).is_some()) {
            keys.push("accuracy");
        }
        if self.get("accuracy").is_some() {
            keys.extend(STEPPING_KEYS);
        }
        if let Some(SettingValue::Text(method)) = self.get("method")
            && method != scene.run_defaults().method.unwrap_or_default().name()
        {
            keys.push("step");
        }
        keys
    }

    /// Refuses what no scene could be asked about: numbers out of range, unknown methods, two that exclude each other.
    fn check(&self) -> Result<(), SimulationError> {
        for name in NUMBERS {
            let Some(&SettingValue::Number(value)) = self.get(name) else {
                continue;
            };
            let (allowed, fits) = match name {
                "accuracy" => ("between 0 and 1, such as 0.01", value < 1.0),
                _ => ("positive", value.is_finite()),
            };
            if !(value > 0.0 && fits) {
                return Err(SimulationError::Setting {
                    name,
                    value,
                    allowed,
                });
            }
        }
        if let Some(SettingValue::Text(method)) = self.get("method")
            && Stepping::from_name(method).is_none()
        {
            return Err(unknown(
                "method",
                method,
                &Stepping::ALL.map(Stepping::name),
            ));
        }
        if let Some(SettingValue::Names(kinds)) = self.get("events") {
            let known = ["teeth", "guides", "joints"];
            if let Some(kind) = kinds.iter().find(|kind| !known.contains(&kind.as_str())) {
                return Err(unknown("events", kind, &known));
            }
        }
        let stepping = STEPPING_KEYS
            .into_iter()
            .find(|key| self.get(key).is_some());
        match (self.get("accuracy"), stepping) {
            (Some(_), Some(given)) => Err(SimulationError::Conflict { given }),
            _ => Ok(()),
        }
    }
}

fn unknown(setting: &'static str, name: &str, known: &[&'static str]) -> SimulationError {
    SimulationError::UnknownName {
        setting,
        name: name.to_owned(),
        known: known.join(", "),
    }
}

impl SettingValue {
    /// As a command line has it, where everything is a text: a number alone is one in SI units.
    pub fn written(text: &str) -> Self {
        match text.trim().parse() {
            Ok(number) => Self::Number(number),
            Err(_) => Self::Text(text.to_owned()),
        }
    }

    /// A time \[s\] that is no setting of the scene, but written as one; `name` is what messages call it.
    pub(crate) fn time(&self, scene: &Scene, name: &str) -> Result<f64, SceneError> {
        if let Self::Number(time) = self {
            return Ok(*time);
        }
        let read = self.put(scene, "run.every").map_err(|error| {
            let mut error = error.nowhere();
            for problem in &mut error.problems {
                name.clone_into(&mut problem.path);
            }
            error
        })?;
        Ok(read.run_defaults().every.unwrap_or(f64::NAN))
    }

    pub(crate) fn put(&self, scene: &Scene, path: &str) -> Result<Scene, SceneError> {
        match self {
            // `replace` would read it as a number of TOML.
            Self::Text(text) if text.trim().parse::<f64>().is_ok() => {
                scene.replace_json(path, &Json::from(text.as_str()))
            }
            Self::Text(text) => scene.replace(path, text),
            Self::Number(number) => scene.replace_json(path, &Json::from(*number)),
            Self::Names(names) => scene.replace_json(path, &Json::from(names.as_slice())),
        }
    }
}
