//! A drive at the start of its run, as a part of another simulation.

use std::collections::HashMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use chaindrive::record::Provenance;
use chaindrive::scene::SceneError;
use chaindrive::{
    Build, Channel, End, Onlooker, Request, RequestError, RunError, Scene, Settings, Simulation,
    SimulationError, Sink, Stop, execute,
};
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::ports::{Ports, usual};
use crate::{Causality, Variable};

/// Files of a unit among its resources.
const SCENE: &str = "scene.toml";
const EXPORT: &str = "export.json";

/// A drive at the start of its run, and its variables: what all instances share.
#[derive(Debug)]
pub struct Model {
    export: Export,
    pub(crate) ports: Ports,
    /// At t = 0.
    pub(crate) begin: Simulation,
    token: String,
    title: String,
    until: f64,
    every: f64,
}

/// What a unit is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Text of the scene, settings of the run included.
    pub scene: String,
    /// What is known of it beside.
    pub facts: Facts,
}

/// What a unit says beside its scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Build that made the unit.
    pub build: String,
    /// Name in the importer.
    pub name: String,
    /// Channels whose entries are outputs; empty for the usual ones.
    pub outputs: Vec<String>,
    /// A run at the export.
    pub run: Option<RunFacts>,
    /// Name-based identifier of the list of variables; empty until it is known. A library of another list would mistake their references.
    pub variables: String,
}

/// A run of the scene at the export, without inputs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunFacts {
    /// Verdict: trusted, caution or distrusted.
    pub verdict: String,
    /// Its reasons in words.
    pub note: String,
    /// Time up to which waveforms could be followed \[s\]; none where nothing limits them, or nobody knows.
    pub horizon: Option<f64>,
    /// The same in words.
    pub horizon_note: String,
    /// End of the run \[s\].
    pub until: f64,
}

/// Keeps no samples.
struct Unkept;

impl Sink for Unkept {
    type Error = Infallible;

    fn begin(&mut self, _: &Simulation, _: &[Channel], _: &Provenance) -> Result<(), Infallible> {
        Ok(())
    }

    fn keeps_samples(&self) -> bool {
        false
    }

    fn push(&mut self, _: &Simulation) -> Result<(), Infallible> {
        Ok(())
    }

    fn end(&mut self, _: &End<'_>) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Why there is no model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A resource cannot be read.
    #[error("{}: {reason}; export the unit anew", .path.display())]
    Resource {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },

    /// The unit was made by a build with other variables.
    #[error(
        "the unit was made by chaindrive {build}, and the library in it is {here}, which has other variables: export it anew"
    )]
    Library {
        /// Build that made the unit.
        build: String,
        /// Build of the library.
        here: String,
    },

    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// The settings of its run are wrong.
    #[error(transparent)]
    Request(#[from] RequestError),

    /// The drive does not start.
    #[error("the drive does not start: {0}")]
    Start(String),

    /// An output that it does not have.
    #[error(transparent)]
    Output(#[from] SimulationError),
}

impl Export {
    /// The scene of a request, settings included, under a name in the importer. The channels to record are the outputs; without them, the
    /// usual ones.
    pub fn new(request: &Request, name: &str) -> Self {
        Self {
            scene: request.scene.text().to_owned(),
            facts: Facts {
                build: Build::here().id.clone(),
                name: name.to_owned(),
                outputs: request.record.clone(),
                run: None,
                variables: String::new(),
            },
        }
    }

    /// Carries out the request, and keeps what the run says of itself.
    ///
    /// # Errors
    /// [`RunError`] when the run cannot begin.
    pub fn tell_run(
        &mut self,
        request: &Request,
        onlooker: &dyn Onlooker,
    ) -> Result<(), RunError<Infallible>> {
        let report = execute(request, &mut Unkept, onlooker)?;
        if matches!(report.stop, Stop::Interrupted) {
            return Err(RunError::Interrupted);
        }
        let text = |name: &str| {
            let text = report.attributes.get(name).and_then(|it| it.as_str());
            text.unwrap_or_default().to_owned()
        };
        let horizon = report.attributes.get("waveform_horizon");
        self.facts.run = Some(RunFacts {
            verdict: text("verdict"),
            note: text("verdict_note"),
            horizon: horizon.and_then(serde_json::Value::as_f64),
            horizon_note: text("waveform_note"),
            until: report.run.until,
        });
        Ok(())
    }

    /// Reads the resources of a unit.
    ///
    /// # Errors
    /// [`ModelError::Resource`].
    pub fn read(folder: &Path) -> Result<Self, ModelError> {
        let read = |name: &str| {
            let path = folder.join(name);
            std::fs::read_to_string(&path).map_err(|error| ModelError::Resource {
                path,
                reason: error.to_string(),
            })
        };
        let scene = read(SCENE)?;
        let facts = serde_json::from_str(&read(EXPORT)?);
        let facts = facts.map_err(|error| ModelError::Resource {
            path: folder.join(EXPORT),
            reason: error.to_string(),
        })?;
        Ok(Self { scene, facts })
    }

    /// The resources of a unit, by their names.
    pub(crate) fn resources(&self) -> [(&'static str, String); 2] {
        [(SCENE, self.scene.clone()), (EXPORT, self.told())]
    }

    fn told(&self) -> String {
        // Plain data under names.
        serde_json::to_string_pretty(&self.facts).unwrap_or_default()
    }
}

impl Model {
    /// Starts the drive of an export.
    ///
    /// # Errors
    /// [`ModelError`]: the scene is wrong, the drive does not start, or does not have an output.
    pub fn new(mut export: Export) -> Result<Self, ModelError> {
        let scene = Scene::from_text(&export.scene, &export.facts.name)?;
        let request = Request::new(&scene, &Settings::default())?.with_default_step();
        let begun = Simulation::of(&request, &|| false);
        let mut begin = begun.map_err(|error| ModelError::Start(error.to_string()))?;
        begin.advance_to(0.0)?;
        let outputs = match export.facts.outputs.as_slice() {
            [] => usual(begin.system()),
            names => Channel::chosen(names, begin.system())?,
        };
        let ports = Ports::of(&begin, &outputs, &export.facts);
        let names: Vec<_> = ports.variables.iter().map(|it| it.name.as_str()).collect();
        let names = identifier(&names.join("\n"));
        let known = std::mem::replace(&mut export.facts.variables, names);
        if !known.is_empty() && known != export.facts.variables {
            return Err(ModelError::Library {
                build: export.facts.build,
                here: Build::here().id.clone(),
            });
        }
        Ok(Self {
            ports,
            token: token(&export),
            title: scene.title().to_owned(),
            until: request.run.until,
            every: request.run.every,
            begin,
            export,
        })
    }

    /// The model of the resources of a unit; instances of the same unit share it.
    ///
    /// # Errors
    /// As [`Model::new`], and [`ModelError::Resource`].
    pub fn of_resources(folder: &Path) -> Result<Arc<Self>, ModelError> {
        /// Models in use, by their tokens.
        static KNOWN: Mutex<Option<HashMap<String, Weak<Model>>>> = Mutex::new(None);
        let export = Export::read(folder)?;
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let known = known.get_or_insert_with(HashMap::new);
        let token = token(&export);
        if let Some(model) = known.get(&token).and_then(Weak::upgrade) {
            return Ok(model);
        }
        let model = Arc::new(Self::new(export)?);
        known.retain(|_, model| model.strong_count() > 0);
        known.insert(token, Arc::downgrade(&model));
        Ok(model)
    }

    /// Its variables, by their value references.
    pub fn variables(&self) -> &[Variable] {
        &self.ports.variables
    }

    /// Value reference of a name.
    pub fn reference(&self, name: &str) -> Option<u32> {
        let found = self.variables().iter().position(|it| it.name == name)?;
        u32::try_from(found).ok()
    }

    /// Token that tells units apart: of the build, the scene and what is said beside.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Name in the importer.
    pub fn name(&self) -> &str {
        &self.export.facts.name
    }

    /// Title of the scene.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// End and interval of samples that the scene suggests \[s\].
    pub fn suggested(&self) -> (f64, f64) {
        (self.until, self.every)
    }

    pub(crate) fn export(&self) -> &Export {
        &self.export
    }

    /// References of the variables of a direction.
    pub(crate) fn of_causality(&self, causality: Causality) -> impl Iterator<Item = usize> + '_ {
        let all = self.variables().iter().enumerate();
        all.filter(move |(_, it)| it.causality == causality)
            .map(|(index, _)| index)
    }
}

fn token(export: &Export) -> String {
    identifier(&format!("{}\n{}", export.scene, export.told()))
}

/// Name-based, so that the same text has the same one everywhere.
fn identifier(text: &str) -> String {
    Uuid::new_v5(&Uuid::NAMESPACE_OID, text.as_bytes()).to_string()
}
