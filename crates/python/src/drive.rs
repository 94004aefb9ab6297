//! Drives: from text, changed, assembled.

use std::path::PathBuf;

use chaindrive::catalogue::{CatalogueChain, Number};
use chaindrive::describe::{spans_at_rest, static_stages};
use chaindrive::scene::{self, Scene};
use chaindrive::{Channel, Description, Mode, Run, rating};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::drawing;
use crate::errors::{OrRaise, parameter};
use crate::law::Law;
use crate::profile::Profile;
use crate::signals::{SETTLING, patiently};

/// Name, link tensions, span tensions and closed contacts of a static stage.
type StaticStage<'py> = (
    &'static str,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<usize>,
);

/// A scene and the drive it describes.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Drive {
    pub(crate) scene: Scene,
    pub(crate) drive: chaindrive::Drive,
}

impl Drive {
    fn new(scene: Scene) -> PyResult<Self> {
        let drive = scene.drive().or_raise()?;
        Ok(Self { scene, drive })
    }

    /// The run the scene suggests.
    fn run(&self) -> Run {
        Run::suggested(&self.scene.run_defaults())
    }
}

#[pymethods]
impl Drive {
    /// Reads a scene file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        // A pipe may be a long time in coming.
        Self::new(patiently(py, "the scene is read", || Scene::read(path))?.or_raise()?)
    }

    /// Reads TOML, or JSON when the text begins with a brace.
    #[staticmethod]
    fn from_text(text: &str, name: &str) -> PyResult<Self> {
        Self::new(Scene::from_text(text, name).or_raise()?)
    }

    /// Takes JSON that nobody sees: mistakes in it have no lines.
    #[staticmethod]
    fn from_data(json: &str, name: &str) -> PyResult<Self> {
        Self::new(Scene::from_data(json, name).or_raise()?)
    }

    /// Reads TOML.
    #[staticmethod]
    fn from_toml(text: &str, name: &str) -> PyResult<Self> {
        Self::new(Scene::from_toml(text, name).or_raise()?)
    }

    /// The embedded scene of this name.
    #[staticmethod]
    fn preset(name: &str) -> PyResult<Self> {
        Self::new(Scene::preset(name).or_raise()?)
    }

    /// A new drive with values replaced: pairs of a dotted path and a JSON text.
    fn replace(&self, changes: Vec<(String, String)>) -> PyResult<Self> {
        let mut scene = self.scene.clone();
        for (path, json) in changes {
            let value = serde_json::from_str(&json)
                .map_err(|error| parameter(format!("{path}: {error}"), &path, "a value of JSON"))?;
            scene = scene.replace_json(&path, &value).or_raise()?;
        }
        Self::new(scene)
    }

    /// The drive with every default written out.
    fn resolved(&self) -> PyResult<Self> {
        Self::new(self.scene.resolved().or_raise()?)
    }

    /// The text that reproduces the drive.
    #[getter]
    fn text(&self) -> &str {
        self.scene.text()
    }

    /// Its name in messages: its file or preset.
    #[getter]
    fn name(&self) -> &str {
        self.scene.name()
    }

    /// Its title, in a line.
    #[getter]
    fn title(&self) -> &str {
        self.scene.title()
    }

    /// Number of links of all chains.
    #[getter]
    fn links(&self) -> usize {
        let chains = self.drive.chains.iter();
        chains.map(|placed| placed.chain.links()).sum()
    }

    /// Names of the chains, where there are several, with their numbers of links.
    #[getter]
    fn chains(&self) -> Vec<(String, usize)> {
        let chains = self.drive.chains.iter();
        let named = chains.filter_map(|it| Some((it.name.clone()?, it.chain.links())));
        named.collect()
    }

    /// Names of the shafts.
    #[getter]
    fn shafts(&self) -> Vec<String> {
        let shafts = self.drive.shafts.iter();
        shafts.filter_map(|shaft| shaft.name.clone()).collect()
    }

    /// Names of the couplings.
    #[getter]
    fn couplings(&self) -> Vec<String> {
        let couplings = self.drive.couplings.iter();
        couplings.map(|coupling| coupling.name.clone()).collect()
    }

    /// Names of the sprockets.
    #[getter]
    fn sprockets(&self) -> Vec<String> {
        self.drive
            .sprockets
            .iter()
            .map(|sprocket| sprocket.name.clone())
            .collect()
    }

    /// Names of the guides.
    #[getter]
    fn guides(&self) -> Vec<String> {
        self.drive
            .guides
            .iter()
            .map(|guide| guide.name.clone())
            .collect()
    }

    /// Names of the tensioners.
    #[getter]
    fn tensioners(&self) -> Vec<String> {
        self.drive
            .tensioners
            .iter()
            .map(|tensioner| tensioner.name.clone())
            .collect()
    }

    /// Settings of a run and channels to record, unless others are given.
    fn run_defaults<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let run = self.run();
        let answer = PyDict::new(py);
        answer.set_item("until", run.until)?;
        answer.set_item("every", run.every)?;
        answer.set_item("method", run.stepping.name())?;
        answer.set_item("step", run.step)?;
        answer.set_item("tolerance", run.tolerance)?;
        answer.set_item("onset_depth", run.onset_depth)?;
        let accuracy = self.scene.run_defaults().chosen_accuracy();
        answer.set_item("accuracy", accuracy)?;
        let kinds = [
            ("teeth", run.events.teeth),
            ("guides", run.events.guides),
            ("joints", run.events.joints),
        ];
        let wanted = kinds.into_iter().filter(|(_, wanted)| *wanted);
        let events: Vec<&str> = wanted.map(|(name, _)| name).collect();
        answer.set_item("events", events)?;
        let mut record = self.scene.run_defaults().record;
        if record.is_empty() {
            let channels = Channel::defaults(&self.drive).into_iter();
            record = channels.map(|channel| channel.name().to_owned()).collect();
        }
        answer.set_item("record", record)?;
        Ok(answer)
    }

    /// The contact law of a sprocket or guide, or of `joints` or `rollers`.
    fn law(&self, body: &str) -> PyResult<Law> {
        let sprockets = self
            .drive
            .sprockets
            .iter()
            .map(|sprocket| (&sprocket.name, &sprocket.surface));
        let guides = self
            .drive
            .guides
            .iter()
            .map(|guide| (&guide.name, &guide.surface));
        let found = sprockets.chain(guides).find(|(name, _)| *name == body);
        let found = found.map(|(_, surface)| surface);
        let surface = found.or_else(|| {
            // "joints" of the only chain, "primary.joints" of one of several.
            let (chain, contact) = match body.rsplit_once('.') {
                Some((chain, contact)) => (Some(chain), contact),
                None => (None, body),
            };
            let mut chains = self.drive.chains.iter();
            let placed = chains.find(|placed| placed.name.as_deref() == chain)?;
            let model = &placed.chain.model;
            match contact {
                "joints" => model.clearance().map(|joint| &joint.surface),
                "rollers" => model.free_roller().map(|roller| &roller.surface),
                _ => None,
            }
        });
        let surface = surface.ok_or_else(|| {
            let sprockets = self.drive.sprockets.iter().map(|it| it.name.as_str());
            let guides = self.drive.guides.iter().map(|it| it.name.as_str());
            let mut names: Vec<&str> = sprockets.chain(guides).collect();
            let contacts = "`joints` or `rollers`, where pins or rollers have play";
            names.push(contacts);
            PyKeyError::new_err(format!(
                "`{body}` has no contact law; give {}",
                names.join(", ")
            ))
        })?;
        Ok(Law(surface.law))
    }

    /// Power \[W\] that a chain is rated for.
    fn rated_power(&self, chain: Option<&str>, teeth: u32, speed: f64) -> PyResult<f64> {
        let mut chains = self.drive.chains.iter();
        let placed = match chain {
            None if self.drive.chains.len() == 1 => chains.next(),
            None => {
                let message = "there are several chains, and each has its own rating".to_owned();
                return Err(parameter(message, "chain", "the name of one"));
            }
            Some(name) => chains.find(|placed| placed.name.as_deref() == Some(name)),
        };
        let placed = placed.ok_or_else(|| PyKeyError::new_err(chain.map(str::to_owned)))?;
        let rated = rating::rated_power(&placed.chain.strength, teeth, speed);
        let allowed = "a type of the A series with its own pitch, such as 16A-1, or chain.rated_power of the maker";
        rated.map_err(|why| parameter(why.to_string(), "chain.type", allowed))
    }

    /// The whole profile of a sprocket or guide, settled or as it was laid.
    fn profile(&self, py: Python<'_>, name: &str, settled: bool) -> PyResult<Profile> {
        let found = py.detach(|| {
            if settled {
                self.drive.assemble()?.profile(name)
            } else {
                self.drive.profile(name)
            }
        });
        Ok(Profile(found.or_raise()?))
    }

    /// Description of the drive: as a text, and as JSON.
    fn describe(&self, py: Python<'_>) -> PyResult<(String, String)> {
        let (drive, run) = (self.drive.clone(), self.run());
        let description = patiently(py, SETTLING, move || Description::of(&drive, &run))?
            .or_raise()?
            .unless_chosen_for(self.scene.run_defaults().chosen_accuracy());
        let json = serde_json::to_string(&description)
            .map_err(|error| parameter(error.to_string(), "description", "finite"))?;
        Ok((description.to_string(), json))
    }

    /// Names of the spans; link tensions, span tensions and closed contacts after every static stage.
    fn statics<'py>(&self, py: Python<'py>) -> PyResult<(Vec<String>, Vec<StaticStage<'py>>)> {
        let drive = self.drive.clone();
        let assembled = patiently(py, SETTLING, move || drive.assemble())?.or_raise()?;
        let spans = spans_at_rest(&self.drive, &assembled);
        let told = static_stages(&self.drive, &assembled);
        let stages = assembled.statics.into_iter().zip(told);
        let stages = stages.map(|(stage, told)| {
            let tensions = PyArray1::from_vec(py, stage.tensions);
            let span_tensions = PyArray1::from_vec(py, told.span_tensions);
            (stage.stage, tensions, span_tensions, stage.contacts)
        });
        let names = spans.into_iter().map(|span| span.name);
        Ok((names.collect(), stages.collect()))
    }

    /// Natural frequencies and mode shapes about the static state.
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drive = self.drive.clone();
        let found = patiently(py, SETTLING, move || {
            drive.assemble().and_then(|it| it.modes())
        })?;
        let modes = found.or_raise()?.modes;
        let count = modes.len();
        let answer = PyDict::new(py);
        let frequencies = modes.iter().map(|mode| mode.frequency).collect();
        answer.set_item("frequency", PyArray1::from_vec(py, frequencies))?;
        let shape = |name: &str, of: &dyn Fn(&Mode) -> &[f64]| {
            let values: Vec<f64> = modes.iter().flat_map(of).copied().collect();
            let width = values.len().checked_div(count).unwrap_or(0);
            answer.set_item(
                name,
                PyArray1::from_vec(py, values).reshape([count, width])?,
            )
        };
        shape("roller_x", &|mode| &mode.roller_x)?;
        shape("roller_y", &|mode| &mode.roller_y)?;
        shape("sprocket_angle", &|mode| &mode.sprocket_angle)?;
        shape("sprocket_x", &|mode| &mode.sprocket_x)?;
        shape("sprocket_y", &|mode| &mode.sprocket_y)?;
        shape("tensioner_position", &|mode| &mode.tensioner_position)?;
        Ok(answer)
    }

    /// What stays the same while the drive moves, settled or as it was laid; of a drive that was run in for a time.
    fn figure(&self, py: Python<'_>, settled: bool, run_in: f64) -> PyResult<drawing::Figure> {
        let drive = self.drive.clone();
        let figure = patiently(py, SETTLING, move || {
            let drive = if run_in > 0.0 {
                drive.beginning(-run_in)?
            } else {
                drive
            };
            if settled {
                drive.figure()
            } else {
                drive.figure_as_laid()
            }
        })?;
        Ok(drawing::Figure(figure.or_raise()?))
    }
}

/// A place, and what either drive has there.
type DifferenceRow = (String, Option<String>, Option<String>);

/// Place and values of everything in which two drives differ.
#[pyfunction]
pub(crate) fn diff(first: &Drive, second: &Drive) -> PyResult<Vec<DifferenceRow>> {
    let differences = scene::diff(&first.scene, &second.scene).or_raise()?;
    let told = differences
        .into_iter()
        .map(|it| (it.path, it.first, it.second));
    Ok(told.collect())
}

/// Name and one-line description of every embedded scene.
#[pyfunction]
pub(crate) fn presets() -> Vec<(&'static str, &'static str)> {
    scene::presets().to_vec()
}

/// JSON Schema of the scene format, as JSON.
#[pyfunction]
pub(crate) fn schema() -> String {
    scene::schema().to_string()
}

/// The catalogue of chains: name, ANSI number, kind and notes of every chain; then name, unit,
/// description, values and statuses of every number, NaN where there is none.
#[pyfunction]
pub(crate) fn catalogue(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let chains = chaindrive::catalogue::catalogue();
    let answer = PyDict::new(py);
    let texts = |of: &dyn Fn(&'static CatalogueChain) -> &'static str| -> Vec<&'static str> {
        chains.iter().map(of).collect()
    };
    answer.set_item("chain", texts(&|chain| &chain.name))?;
    answer.set_item("ansi", texts(&|chain| &chain.ansi))?;
    answer.set_item("kind", texts(&|chain| &chain.kind))?;
    answer.set_item("makers_differ", texts(&|chain| &chain.makers_differ))?;
    let statuses = PyDict::new(py);
    let numbers = PyDict::new(py);
    for number in Number::ALL {
        let status = number.status();
        statuses.set_item(status.name(), texts(&|chain| chain.status(status)))?;
        let values = chains
            .iter()
            .map(|chain| chain.number(number).unwrap_or(f64::NAN))
            .collect();
        let about = (
            PyArray1::from_vec(py, values),
            number.unit(),
            number.description(),
            status.name(),
        );
        numbers.set_item(number.name(), about)?;
    }
    answer.set_item("numbers", numbers)?;
    answer.set_item("statuses", statuses)?;
    Ok(answer)
}
