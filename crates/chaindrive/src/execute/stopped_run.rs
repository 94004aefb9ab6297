//! Stores of runs that were stopped or killed: the run goes on.

use super::start::{RunState, Setup, not_started, short_runs};
use super::{Report, RunError, complete, sights};
use crate::Simulation;
use crate::interruptible::assemble;
use crate::precision::ShortRuns;
use crate::record::{Checkpoint, Provenance, RestoreError, Sink, StoppedRun, WriteError};
use crate::run_in::Onlooker;

impl StoppedRun {
    /// Takes the run to its end.
    ///
    /// # Errors
    /// [`RunError`] when the run cannot go on, or the store refuses.
    pub fn resume(self, onlooker: &dyn Onlooker) -> Result<Report, RunError<WriteError>> {
        let (checkpoint, mut sink) = self.into_parts();
        resume(&checkpoint, &mut sink, onlooker)
    }
}

/// Carries a run on from a checkpoint: the report is that of the run that was never stopped, but for the wall times.
///
/// The sink must hold the samples and contacts up to the checkpoint, and nothing else: see
/// [`StoppedRun`](crate::record::StoppedRun), which opens the store of a run that was stopped or killed.
fn resume<S: Sink>(
    checkpoint: &Checkpoint,
    sink: &mut S,
    onlooker: &dyn Onlooker,
) -> Result<Report, RunError<S::Error>> {
    let request = checkpoint.request().map_err(RunError::Scene)?;
    let mut provenance = Provenance::of(&request.scene, &request.run);
    provenance.checkpoint_every = request.checkpoint_every;
    let [wall, stepping] = checkpoint.spent();
    provenance.earlier = wall;
    provenance.choice = checkpoint.choice().cloned();
    let drive = request.scene.drive().map_err(RunError::Scene)?;
    let Some(snapshot) = &checkpoint.snapshot else {
        let setup = Setup {
            assembled: assemble(&drive, &|| onlooker.stop()).map_err(not_started)?,
            drive,
            provenance,
            short_runs: None,
            is_verified: checkpoint.is_verified,
        };
        let sights = sights(&request, sink, &setup.assembled).map_err(RunError::Start)?;
        let state = setup.run_in(&request, sights, onlooker);
        return complete(&request, state.map_err(not_started)?, sink, onlooker);
    };
    let start = checkpoint.start(&drive, &|| onlooker.stop());
    let start = start.map_err(|error| match error {
        RestoreError::Start(error) => not_started(error),
        RestoreError::Snapshot(error) => RunError::Snapshot(error),
    })?;
    let short_runs = if checkpoint.has_moved() {
        ShortRuns::default()
    } else {
        short_runs(&request, &provenance, &start, onlooker).map_err(not_started)?
    };
    let simulation = Simulation::from_assembled(start, &request.run);
    let mut simulation = simulation.map_err(RunError::Start)?;
    let restored = simulation.restore(snapshot);
    restored.map_err(RunError::Snapshot)?;
    simulation.has_spent(stepping);
    provenance.ran_in = checkpoint.ran_in();
    let state = RunState {
        drive,
        simulation,
        provenance,
        short_runs,
        estimate: None,
        summary: checkpoint.summary.clone(),
    };
    complete(&request, state, sink, onlooker)
}
