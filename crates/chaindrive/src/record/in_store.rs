//! Results in a Zarr store.

use std::path::PathBuf;

use super::zarr::Store;
use super::{Existing, Provenance, WriteError, ZarrWriter};
use crate::run::{Checkpoint, End, Sink};
use crate::{Channel, Simulation};

/// Streams samples and contacts into a Zarr store.
#[derive(Debug)]
pub struct InStore {
    place: Place,
    writer: Option<ZarrWriter>,
}

/// Where the samples go.
enum Place {
    /// Into a store that is made when the run begins.
    New(PathBuf, Existing),
    /// Into one that was left, behind its checkpoint.
    Left(Box<(Store, Checkpoint)>),
    /// The writer knows.
    Begun,
}

impl std::fmt::Debug for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::New(path, existing) => f.debug_tuple("New").field(path).field(existing).finish(),
            Self::Left(left) => f.debug_tuple("Left").field(&left.0.path()).finish(),
            Self::Begun => f.write_str("Begun"),
        }
    }
}

impl InStore {
    /// A store at a path, made when the run begins.
    pub fn new(path: PathBuf, existing: Existing) -> Self {
        Self {
            place: Place::New(path, existing),
            writer: None,
        }
    }

    /// A store that was left, gone on with when the run does.
    pub(super) fn left(store: Store, checkpoint: Checkpoint) -> Self {
        Self {
            place: Place::Left(Box::new((store, checkpoint))),
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
        if let Some(writer) = &mut self.writer {
            writer.goes_by(provenance);
            return Ok(());
        }
        self.writer = match std::mem::replace(&mut self.place, Place::Begun) {
            Place::New(path, existing) => {
                let made = ZarrWriter::create(&path, simulation, channels, provenance, existing);
                Some(made?)
            }
            Place::Left(left) => {
                let (store, checkpoint) = *left;
                let writer =
                    ZarrWriter::go_on(store, &checkpoint, simulation, channels, provenance);
                Some(writer?)
            }
            Place::Begun => None,
        };
        Ok(())
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        match &mut self.writer {
            Some(writer) => writer.push(simulation),
            None => Ok(()),
        }
    }

    fn keep(&mut self, simulation: &Simulation, checkpoint: &Checkpoint) -> Result<(), WriteError> {
        match &mut self.writer {
            Some(writer) => writer.keep(simulation, checkpoint),
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
