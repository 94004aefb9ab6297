//! Destinations of the samples of a run.

use serde_json::{Map, Value};

use super::{Checkpoint, Provenance};
use crate::precision::Judgement;
use crate::story::Ending;
use crate::{Channel, Run, Simulation, Summary};

/// Destination of samples: memory, a store, a table.
pub trait Sink {
    /// Why it refuses.
    type Error: std::error::Error;

    /// Takes note of a run that is about to begin: once, or before its run-in and after it.
    ///
    /// # Errors
    /// The place is taken, or cannot be written.
    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), Self::Error>;

    /// Refuses what it could not keep, before anything moves.
    ///
    /// # Errors
    /// There is no room for so many samples.
    fn has_room(
        &self,
        simulation: &Simulation,
        channels: &[Channel],
        run: &Run,
    ) -> Result<(), Self::Error> {
        let _ = (simulation, channels, run);
        Ok(())
    }

    /// Whether the samples are kept; otherwise only their summary is read.
    fn keeps_samples(&self) -> bool {
        true
    }

    /// Attributes of the result are kept; for other sinks they are left empty.
    fn keeps_attributes(&self) -> bool {
        true
    }

    /// Takes the last sample of the simulation. Its observation has what the channels told at the beginning need, energies and the motion of
    /// bodies; lists of links and rollers that nobody asked for are empty, but in the last sample of a run.
    ///
    /// # Errors
    /// It cannot be written.
    fn push(&mut self, simulation: &Simulation) -> Result<(), Self::Error>;

    /// Keeps what the run goes on from if it is stopped or killed, until the next one takes its place or the result is
    /// closed with no sample more. Called for every checkpoint that is asked for, and when the user stops the run;
    /// places that cannot be carried on have nothing to do.
    ///
    /// # Errors
    /// It cannot be written.
    fn keep(
        &mut self,
        simulation: &Simulation,
        checkpoint: &Checkpoint,
    ) -> Result<(), Self::Error> {
        let _ = (simulation, checkpoint);
        Ok(())
    }

    /// Closes the result, however the run ended.
    ///
    /// # Errors
    /// It cannot be written.
    fn end(&mut self, end: &End<'_>) -> Result<(), Self::Error>;
}

/// Facts that are known when a run has ended.
#[derive(Debug)]
pub struct End<'a> {
    /// The simulation at its last state.
    pub simulation: &'a Simulation,
    /// The account of its samples.
    pub summary: &'a Summary,
    /// Estimate of the numerical error; none for a run that failed.
    pub judgement: Option<&'a Judgement>,
    /// End of the run, with its reason.
    pub ending: &'a Ending,
    /// Attributes of the result.
    pub attributes: &'a Map<String, Value>,
}
