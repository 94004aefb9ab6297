//! A drive at the start of its run, as a part of another simulation.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use chaindrive::scene::SceneError;
use chaindrive::{
    Build, Channel, Request, RequestError, Scene, Settings, Simulation, SimulationError,
};

use crate::export::{Export, ResourceError, identifier};
use crate::ports::{Ports, usual};
use crate::variable::{Causality, Variable};

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

/// Why there is no model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A resource cannot be read.
    #[error(transparent)]
    Resource(#[from] ResourceError),

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
            token: export.token(),
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
        let token = export.token();
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

    /// Files that a unit has among its resources: names and texts.
    pub fn resources(&self) -> [(&'static str, String); 2] {
        self.export.resources()
    }

    /// References of the variables of a direction.
    pub(crate) fn of_causality(&self, causality: Causality) -> impl Iterator<Item = usize> + '_ {
        let all = self.variables().iter().enumerate();
        all.filter(move |(_, it)| it.causality == causality)
            .map(|(index, _)| index)
    }
}
