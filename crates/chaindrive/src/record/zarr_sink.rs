//! Results in a Zarr store.

use std::path::{Path, PathBuf};

use super::{Checkpoint, End, Sink};
use super::{Provenance, Recording, Size, ZarrWriter};
use crate::zarr::{Existing, Store, WriteError};
use crate::{Channel, Run, Simulation};

/// Streams samples and contacts into a Zarr store.
#[derive(Debug)]
pub struct ZarrSink {
    place: Destination,
    writer: Option<ZarrWriter>,
}

/// Destination of the samples.
enum Destination {
    /// Into a store that is made when the run begins.
    New(PathBuf, Existing),
    /// Into one that was left, after its checkpoint.
    Left(Box<(Store, Checkpoint)>),
    /// The writer knows.
    Begun,
}

impl std::fmt::Debug for Destination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::New(path, existing) => f.debug_tuple("New").field(path).field(existing).finish(),
            Self::Left(left) => f.debug_tuple("Left").field(&left.0.path()).finish(),
            Self::Begun => f.write_str("Begun"),
        }
    }
}

impl ZarrSink {
    /// A store at a path, made when the run begins.
    pub fn new(path: PathBuf, existing: Existing) -> Self {
        Self {
            place: Destination::New(path, existing),
            writer: None,
        }
    }

    /// A store that was left, gone on with when the run does.
    pub(super) fn left(store: Store, checkpoint: Checkpoint) -> Self {
        Self {
            place: Destination::Left(Box::new((store, checkpoint))),
            writer: None,
        }
    }
}

/// Times by which channels are packed at most. *Assumed*: places and speeds of rollers shrink by 1.1 to 3.
const PACKED: f64 = 4.0;

impl Sink for ZarrSink {
    type Error = WriteError;

    fn has_room(
        &self,
        simulation: &Simulation,
        channels: &[Channel],
        run: &Run,
    ) -> Result<(), WriteError> {
        let Destination::New(path, _) = &self.place else {
            return Ok(());
        };
        let size = Size::of_run(&Recording::new(channels, simulation.system()), run);
        let free = free_disk(path);
        if size.bytes <= PACKED * free {
            return Ok(());
        }
        Err(WriteError::NoRoom {
            path: path.clone(),
            gigabytes: size.bytes * 1e-9,
            free: free * 1e-9,
            samples: size.samples,
            values: size.values,
        })
    }

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), WriteError> {
        self.has_room(simulation, channels, &provenance.run)?;
        let provenance = provenance.clone();
        if let Some(writer) = &mut self.writer {
            writer.goes_by(provenance);
            return Ok(());
        }
        self.writer = match std::mem::replace(&mut self.place, Destination::Begun) {
            Destination::New(path, existing) => {
                let made = ZarrWriter::create(&path, simulation, channels, provenance, existing);
                Some(made?)
            }
            Destination::Left(left) => {
                let (store, checkpoint) = *left;
                let writer =
                    ZarrWriter::go_on(store, &checkpoint, simulation, channels, provenance);
                Some(writer?)
            }
            Destination::Begun => None,
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

/// Bytes that are free where a result is to lie; any number where nobody can tell.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
fn free_disk(path: &Path) -> f64 {
    // The folder may not be there yet.
    let found = path.ancestors().skip(1).find_map(|folder| {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        rustix::fs::statvfs(folder).ok()
    });
    found.map_or(f64::INFINITY, |disk| {
        disk.f_bavail as f64 * disk.f_frsize as f64
    })
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
fn free_disk(_: &Path) -> f64 {
    f64::INFINITY
}
