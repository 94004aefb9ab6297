//! Recordings: labelled columns with units, and the story of how they came about.

mod attributes;
mod channel;
mod claim;
mod error;
mod event;
mod in_store;
mod memory;
mod recorded;
mod summary;
mod zarr;

use chaindrive_mechanics::{ChainSize, Energy, Flow, Observation, Place, Store, System};

use crate::{Run, SimulationError};

pub use attributes::{Ending, Provenance, attributes};
pub use channel::{Axis, Channel};
pub use claim::{Claim, is_being_written, take_over};
pub use error::WriteError;
pub use event::{EventColumn, EventTable};
pub use in_store::InStore;
pub use memory::Memory;
pub use recorded::{LoggedContact, Recorded, RecordedChannel};
pub use summary::{
    Bearing, Bodies, ContactStatistics, Course, ForceStatistics, ImpactStatistics, Known, Ledger,
    SpanStatistics, SprocketCourse, Steadiness, Summary,
};
pub(crate) use summary::{DRIFT, drift};
pub use zarr::{
    Existing, Finished, Object, Objects, ReadError, ResumeError, Stopped, SweepStore, Worker,
    ZarrWriter, inspect,
};

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

impl Axis {
    /// Whether its labels are numbers, not names.
    pub fn is_numbered(self) -> bool {
        matches!(self, Self::Roller | Self::Link | Self::Joint)
    }
}

impl Axis {
    /// Name of the coordinate that tells the chain of every entry.
    pub fn chain_coordinate(self) -> Option<&'static str> {
        match self {
            Self::Roller => Some("roller_chain"),
            Self::Link => Some("link_chain"),
            Self::Joint => Some("joint_chain"),
            Self::Span => Some("span_chain"),
            _ => None,
        }
    }
}

/// The chain that every entry along an axis belongs to, by name; none where there is one chain only, and along axes that do not
/// run over chains.
pub fn chains_along(axis: Axis, system: &System) -> Option<Vec<String>> {
    let count: fn(&ChainSize) -> usize = match axis {
        Axis::Roller => |size| size.rollers,
        Axis::Link => |size| size.links,
        Axis::Joint => |size| size.joints,
        Axis::Span => |size| size.spans,
        _ => return None,
    };
    let chains = system.chain_sizes();
    let several = chains.len() > 1;
    let repeated = |(name, size): (String, ChainSize)| vec![name; count(&size)];
    several.then(|| chains.into_iter().flat_map(repeated).collect())
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

/// Labels along an axis: names, or numbers from 0 for rollers, links and joints; `None` for a scalar.
pub fn labels(axis: Axis, system: &System) -> Option<Vec<String>> {
    let numbers = |count: usize| (0..count).map(|i| i.to_string()).collect();
    match axis {
        Axis::None => None,
        Axis::Roller => Some(numbers(system.rollers())),
        Axis::Link => Some(numbers(system.links())),
        Axis::Joint => Some(numbers(system.joints())),
        Axis::Span => Some(system.span_names()),
        Axis::Sprocket => Some(system.sprocket_names()),
        Axis::Shaft => Some(system.shaft_names()),
        Axis::Coupling => Some(system.coupling_names()),
        Axis::Guide => Some(system.guide_names()),
        Axis::Tensioner => Some(system.tensioner_names()),
        Axis::OilColumn => Some(system.oil_column_names()),
        Axis::Store => Some(Store::ALL.iter().map(|s| s.name().to_owned()).collect()),
        Axis::Place => Some(Place::ALL.iter().map(|p| p.name().to_owned()).collect()),
        Axis::Flow => Some(Flow::ALL.iter().map(|f| f.name().to_owned()).collect()),
    }
}

/// Memory that this program can still have \[bytes\], limits of its control group included; without bounds where the
/// system does not say.
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

fn free_memory() -> f64 {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let group = system.cgroup_limits().map(|limits| limits.free_memory);
    let free = system.available_memory();
    match group.map_or(free, |group| group.min(free)) {
        0 => f64::INFINITY,
        bytes => bytes as f64,
    }
}
