//! Contents of a unit: a scene, and the facts found when it was exported.

use std::convert::Infallible;
use std::path::{Path, PathBuf};

use chaindrive::record::Provenance;
use chaindrive::{
    Build, Channel, End, Onlooker, Request, RunError, Simulation, Sink, Stop, execute,
};
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Name of the library in a unit, without what its platform puts before and after it.
pub const LIBRARY: &str = "chaindrive_fmu";

/// Files of a unit among its resources.
const SCENE: &str = "scene.toml";
const EXPORT: &str = "export.json";

/// Contents of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Text of the scene, settings of the run included.
    pub scene: String,
    /// Facts found at the export.
    pub facts: Facts,
}

/// Facts of a unit beside its scene.
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
struct DiscardSink;

impl Sink for DiscardSink {
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

/// A resource that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}; export the unit anew", .path.display())]
pub struct ResourceError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub reason: String,
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
        let report = execute(request, &mut DiscardSink, onlooker)?;
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
    /// [`ResourceError`].
    pub fn read(folder: &Path) -> Result<Self, ResourceError> {
        let read = |name: &str| {
            let path = folder.join(name);
            // Who opens a pipe waits for whoever writes into it.
            let text = if path.metadata().is_ok_and(|it| !it.is_file()) {
                Err("this is no file".to_owned())
            } else {
                chaindrive::scene::read_file(&path)
            };
            text.map_err(|reason| ResourceError { path, reason })
        };
        let scene = read(SCENE)?;
        let facts = serde_json::from_str(&read(EXPORT)?);
        let facts = facts.map_err(|error| ResourceError {
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

    /// Token that tells units apart, the same everywhere.
    pub(crate) fn token(&self) -> String {
        identifier(&format!("{}\n{}", self.scene, self.told()))
    }
}

/// Name-based, so that the same text has the same one everywhere.
pub(crate) fn identifier(text: &str) -> String {
    Uuid::new_v5(&Uuid::NAMESPACE_OID, text.as_bytes()).to_string()
}
