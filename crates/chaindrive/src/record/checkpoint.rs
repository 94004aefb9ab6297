//! State from which a run goes on when it was stopped or killed.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use chaindrive_mechanics::{Assembled, Drive, SystemMemory};

use super::Provenance;
use crate::interruptible::assemble;
use crate::precision::{Choice, Quantity};
use crate::scene::SceneError;
use crate::seal::{SealedValue, opened, sealed};
use crate::{
    Request, RequestError, Run, RunIn, RunInReport, Scene, SealError, SettingValue, Simulation,
    SimulationError, Snapshot, SnapshotError, Summary,
};

/// Reason why a drive cannot be brought back to its checkpoint.
pub(crate) enum RestoreError {
    Start(SimulationError),
    Snapshot(SnapshotError),
}

impl From<SimulationError> for RestoreError {
    fn from(error: SimulationError) -> Self {
        Self::Start(error)
    }
}

impl From<SnapshotError> for RestoreError {
    fn from(error: SnapshotError) -> Self {
        Self::Snapshot(error)
    }
}

/// A run at one of its moments, with everything that does not follow from the scene: a run that goes on from here is
/// the run that was never stopped, to the last bit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    scene: String,
    scene_name: String,
    run: Run,
    record: Vec<String>,
    estimate: bool,
    every: Option<f64>,
    choice: Option<Choice>,
    /// Verification of the choice at the end of the run-in: done or not.
    pub(crate) is_verified: bool,
    /// Wall time of the run so far, and that of its stepping \[s\].
    spent: [f64; 2],
    pub(crate) summary: Summary,
    /// None before the first sample of a run that is run in: it begins anew.
    pub(crate) snapshot: Option<Snapshot>,
    /// Start of the record, if the drive was run in.
    start: Option<Start>,
}

/// A drive that was run in, at t = 0.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Start {
    ran_in: RunInReport,
    /// Time \[s\] on the clock of the drive, and that of the record's t = 0.
    clock: [f64; 2],
    system: SystemMemory,
    /// Coordinates, velocities, first-order states.
    state: [Vec<f64>; 3],
}

impl SealedValue for Checkpoint {
    const KIND: &'static str = "checkpoint";
}

impl Checkpoint {
    /// A run as it is now.
    pub(crate) fn of(
        request: &Request,
        provenance: &Provenance,
        simulation: &Simulation,
        summary: &Summary,
    ) -> Self {
        let beginning = Self::of_beginning(request, provenance, simulation);
        if simulation.has_samples_ahead() {
            // The run-in gives them once more.
            return beginning;
        }
        Self {
            run: provenance.run.clone(),
            summary: summary.clone(),
            snapshot: Some(simulation.snapshot()),
            start: provenance.ran_in.clone().map(|ran_in| {
                let start = simulation.assembled();
                let state = [&start.q, &start.v, &start.z].map(Clone::clone);
                let system = start.system.memory();
                Start {
                    ran_in,
                    clock: [start.time, start.zero],
                    system,
                    state,
                }
            }),
            ..beginning
        }
    }

    /// A run before its run-in.
    pub(crate) fn of_beginning(
        request: &Request,
        provenance: &Provenance,
        simulation: &Simulation,
    ) -> Self {
        let mut run = provenance.run.clone();
        if provenance.ran_in.as_ref().is_some_and(|it| it.by_default) {
            run.run_in = RunIn::Usual;
        }
        Self {
            scene: provenance.scene.clone(),
            scene_name: provenance.scene_name.clone(),
            run,
            record: request.record.clone(),
            estimate: request.estimate,
            every: request.checkpoint_every,
            choice: provenance.choice.clone(),
            is_verified: provenance.ran_in.is_some(),
            spent: [
                provenance.wall_time().as_secs_f64(),
                simulation.stepping_time(),
            ],
            summary: Summary::new(simulation),
            snapshot: None,
            start: None,
        }
    }

    /// The checkpoint as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        sealed(self)
    }

    /// The checkpoint that was written down.
    ///
    /// # Errors
    /// [`SealError`]: something else, damaged, or of another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SealError> {
        opened(bytes)
    }

    /// Whether a scene is that of the run; its end may differ, for a run that goes on longer is the same run.
    pub(crate) fn is_of(&self, scene: &str) -> bool {
        let endless = |text: &str| {
            let scene = Scene::from_text(text, &self.scene_name)?;
            scene.replace_json("run.until", &self.run.until.into())
        };
        match (endless(scene), endless(&self.scene)) {
            (Ok(scene), Ok(own)) => scene.text() == own.text(),
            _ => false,
        }
    }

    /// File or preset that the scene was read from.
    pub fn scene_name(&self) -> &str {
        &self.scene_name
    }

    /// Samples taken so far.
    pub fn samples(&self) -> u64 {
        self.summary.samples
    }

    /// Logged contacts that have ended so far.
    pub fn contacts(&self) -> u64 {
        self.summary.ended()
    }

    /// Time that the simulation has reached \[s\].
    pub fn time(&self) -> f64 {
        self.snapshot.as_ref().map_or(0.0, Snapshot::time)
    }

    /// End of the run \[s\].
    pub fn until(&self) -> f64 {
        self.run.until
    }

    /// Another end, not before the last sample.
    ///
    /// # Errors
    /// A text that is no time, an end that has passed or leaves too many samples.
    pub(crate) fn extend(&mut self, until: &SettingValue) -> Result<(), RequestError> {
        let scene = Scene::from_text(&self.scene, &self.scene_name)?;
        let time = until.time(&scene, "until")?;
        let reached = self.summary.samples.saturating_sub(1) as f64 * self.run.every;
        if time.is_nan() || time < reached {
            let until = time;
            return Err(SimulationError::Ended { until, reached }.into());
        }
        let run = Run {
            until: time,
            ..self.run.clone()
        };
        run.check()?;
        let extended = until.put(&scene, "run.until")?;
        extended.text().clone_into(&mut self.scene);
        self.run = run;
        Ok(())
    }

    /// The request, with method and step as they were chosen.
    pub(crate) fn request(&self) -> Result<Request, SceneError> {
        Ok(Request {
            scene: Scene::from_text(&self.scene, &self.scene_name)?,
            run: self.run.clone(),
            record: self.record.clone(),
            accuracy: None,
            accuracy_of: Quantity::default(),
            estimate: self.estimate,
            checkpoint_every: self.every,
        })
    }

    /// The run-in of the drive, if there was one.
    pub(crate) fn ran_in(&self) -> Option<RunInReport> {
        self.start.as_ref().map(|start| start.ran_in.clone())
    }

    /// A run-in before the record, longer than nothing.
    pub(crate) fn has_moved(&self) -> bool {
        self.start.as_ref().is_some_and(|it| it.ran_in.has_moved())
    }

    /// The drive where the record begins. It is assembled as far before as it was, and not moved again.
    ///
    /// # Errors
    /// It does not assemble, or is another one; somebody wants to stop.
    pub(crate) fn start(
        &self,
        drive: &Drive,
        stop: &dyn Fn() -> bool,
    ) -> Result<Assembled, RestoreError> {
        let Some(start) = &self.start else {
            return Ok(assemble(drive, stop)?);
        };
        let [time, zero] = start.clock;
        let assembled_at = zero - start.ran_in.time;
        let before = if assembled_at < 0.0 {
            let drive = drive.beginning(assembled_at);
            assemble(&drive.map_err(SimulationError::from)?, stop)?
        } else {
            assemble(drive, stop)?
        };
        let stood = before.stood(time, start.system.clone(), start.state.clone());
        Ok(stood.map_err(SnapshotError::from)?.recorded_from(zero))
    }

    /// Choice of method and step.
    pub(crate) fn choice(&self) -> Option<&Choice> {
        self.choice.as_ref()
    }

    /// Wall time spent on the run and on its stepping before it was stopped.
    pub(crate) fn spent(&self) -> [Duration; 2] {
        let time = |seconds: f64| Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.spent.map(time)
    }
}
