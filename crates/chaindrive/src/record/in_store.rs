//! Results in a Zarr store.

use std::path::PathBuf;

use super::{Existing, Provenance, WriteError, ZarrWriter};
use crate::run::{End, Sink};
use crate::{Channel, Simulation};

/// Streams samples and contacts into a Zarr store.
#[derive(Debug)]
pub struct InStore {
    path: PathBuf,
    existing: Existing,
    writer: Option<ZarrWriter>,
}

impl InStore {
    /// A store at a path, made when the run begins.
    pub fn new(path: PathBuf, existing: Existing) -> Self {
        Self {
            path,
            existing,
            writer: None,
        }
    }
}

impl Sink for InStore {
    type Error = WriteError;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), WriteError> {
        let provenance = provenance.clone();
        let made = ZarrWriter::create(&self.path, simulation, channels, provenance, self.existing)?;
        self.writer = Some(made);
        Ok(())
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        match &mut self.writer {
            Some(writer) => writer.push(simulation),
            None => Ok(()),
        }
    }

    fn end(&mut self, end: &End<'_>) -> Result<(), WriteError> {
        let Some(mut writer) = self.writer.take() else {
            return Ok(());
        };
        if let Some(judgement) = end.judgement {
            writer.judge(judgement);
        }
        writer.tell(end.attributes);
        writer.finish(end.simulation, end.ending)
    }
}
