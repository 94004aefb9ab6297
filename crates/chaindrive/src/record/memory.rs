//! Results in memory.

use std::convert::Infallible;

use super::{EventTable, Provenance, Recording};
use crate::run::{End, Sink};
use crate::{Channel, Simulation};

/// Keeps samples and contacts in memory.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// The samples.
    pub recording: Recording,
    /// The contacts, where they are logged: those that last come last.
    pub events: EventTable,
}

impl Sink for Memory {
    type Error = Infallible;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        _: &Provenance,
    ) -> Result<(), Infallible> {
        self.recording = Recording::new(channels, simulation.system());
        self.events = EventTable::new(simulation.system());
        Ok(())
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), Infallible> {
        self.recording.push(simulation.observation());
        simulation
            .events()
            .iter()
            .for_each(|event| self.events.push(event));
        Ok(())
    }

    fn end(&mut self, end: &End<'_>) -> Result<(), Infallible> {
        let lasting = end.simulation.outstanding_events();
        for event in &lasting {
            self.events.push(event);
        }
        Ok(())
    }
}
