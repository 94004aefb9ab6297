//! Results in memory.

use super::{End, Sink};
use super::{EventTable, Provenance, Recording};
use crate::{Channel, Run, Simulation, SimulationError};

/// Keeps samples and contacts in memory.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// The samples.
    pub recording: Recording,
    /// The contacts, where they are logged: those that last come last.
    pub events: EventTable,
}

impl Sink for Memory {
    type Error = SimulationError;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), SimulationError> {
        self.recording = Recording::of_run(channels, simulation.system(), &provenance.run)?;
        self.events = EventTable::new(simulation.system());
        Ok(())
    }

    fn has_room(
        &self,
        simulation: &Simulation,
        channels: &[Channel],
        run: &Run,
    ) -> Result<(), SimulationError> {
        Recording::of_run(channels, simulation.system(), run).map(drop)
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), SimulationError> {
        self.recording.push(simulation.observation());
        simulation
            .events()
            .iter()
            .for_each(|event| self.events.push(event));
        Ok(())
    }

    fn end(&mut self, end: &End<'_>) -> Result<(), SimulationError> {
        let lasting = end.simulation.outstanding_events();
        for event in &lasting {
            self.events.push(event);
        }
        Ok(())
    }
}
