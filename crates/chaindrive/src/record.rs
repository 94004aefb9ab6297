//! Recordings: labelled columns with units, and the story of how they came about.

mod attributes;
mod checkpoint;
mod free_memory;
mod memory;
mod recorded;
mod sink;

// Stores.
#[cfg(feature = "stores")]
mod zarr;
#[cfg(feature = "stores")]
mod zarr_sink;

use chaindrive_mechanics::{Energy, Observation, System};

use crate::channel::labels;
use crate::{Channel, Run, SimulationError};

pub use crate::event::{EventColumn, EventTable};
pub use crate::story::Ending;
pub use crate::summary::{
    Balance, Bodies, ConfidenceInterval, ContactStatistics, ForceRecord, ForceStatistics,
    ImpactStatistics, Ledger, SpanStatistics, SprocketStatistics, Steadiness, Summary,
    TensionerStatistics,
};
pub use attributes::{Provenance, attributes};
pub use checkpoint::Checkpoint;
pub(crate) use checkpoint::RestoreError;
use free_memory::free_memory;
pub use memory::Memory;
pub use recorded::{LoggedContact, RecordedChannel, RecordedRun};
pub use sink::{End, Sink};

#[cfg(feature = "stores")]
pub use crate::zarr::{Claim, Existing, Object, Objects, WriteError, is_being_written, take_over};
#[cfg(feature = "stores")]
pub use zarr::{ReadError, ResumeError, StoppedRun, ZarrWriter, inspect};
#[cfg(feature = "stores")]
pub use zarr_sink::ZarrSink;

/// One channel of a recording.
#[derive(Clone, Debug)]
pub struct Column {
    /// Its contents.
    pub channel: Channel,
    /// Entries a sample: the length of the channel's axis, or 1.
    pub width: usize,
    /// Samples one after the other, (time, width).
    pub values: Vec<f64>,
}

/// Samples of a run in memory.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Sample times \[s\], (time,).
    pub time: Vec<f64>,
    /// The channels recorded.
    pub columns: Vec<Column>,
    start: Option<Energy>,
}

impl Recording {
    /// An empty recording of some channels of a system.
    pub fn new(channels: &[Channel], system: &System) -> Self {
        let column = |&channel: &Channel| Column {
            channel,
            width: labels(channel.axis(), system).map_or(1, |labels| labels.len()),
            values: Vec::new(),
        };
        Self {
            time: Vec::new(),
            columns: channels.iter().map(column).collect(),
            start: None,
        }
    }

    /// An empty recording for the samples of a run, if the memory can hold them all.
    ///
    /// # Errors
    /// [`SimulationError::TooLarge`], with the size.
    pub fn of_run(
        channels: &[Channel],
        system: &System,
        run: &Run,
    ) -> Result<Self, SimulationError> {
        let recording = Self::new(channels, system);
        let size = Size::of_run(&recording, run);
        // An allocator would promise more than there is, and the system would then kill the program.
        if size.bytes <= free_memory() {
            Ok(recording)
        } else {
            Err(SimulationError::TooLarge {
                gigabytes: size.bytes * 1e-9,
                samples: size.samples,
                values: size.values,
            })
        }
    }

    /// Appends one sample.
    pub fn push(&mut self, sample: &Observation) {
        let start = *self.start.get_or_insert(sample.energy);
        self.time.push(sample.time);
        for column in &mut self.columns {
            column.channel.read(sample, &start, &mut column.values);
        }
    }

    /// Removes all samples but keeps the reference of the energy residual: for writers that
    /// hand on one chunk after the other.
    pub fn clear(&mut self) {
        self.time.clear();
        for column in &mut self.columns {
            column.values.clear();
        }
    }

    /// Number of samples held.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether no sample is held.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}

/// Size of the recording of a run.
struct Size {
    samples: f64,
    /// Entries of a sample beside its time.
    values: usize,
    bytes: f64,
}

impl Size {
    fn of_run(recording: &Recording, run: &Run) -> Self {
        let values: usize = recording.columns.iter().map(|column| column.width).sum();
        let samples = (run.until / run.every).floor() + 1.0;
        // Time and values, eight bytes each.
        let bytes = 8.0 * samples * (1 + values) as f64;
        Self {
            samples,
            values,
            bytes,
        }
    }
}
