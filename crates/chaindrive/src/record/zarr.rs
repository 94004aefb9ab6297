//! Results on disk: Zarr v3, readable while the run goes on and after it was killed.
//!
//! ```text
//! out.zarr/
//!   zarr.json              group: attributes, and the metadata of all arrays
//!   time/                  (time,) [s]
//!   span/, roller/, …      labels of the other dimensions
//!   span_tension/          (time, span) [N]: zarr.json, c/0/0, c/1/0, …
//!   event_start/, …        (event,) contacts from touch to parting, where they are logged
//! ```
//!
//! `zarrs` makes the arrays and their chunks; `object_store` puts every file in place by renaming
//! it, whole or not at all. A commit writes in this order:
//!
//! 1. the chunks in work, filled up with NaN; the samples already there do not change,
//! 2. the group document with the new lengths of **all** arrays as consolidated metadata: one
//!    rename, after which every reader that opens the group sees the new samples,
//! 3. the metadata of each array, for readers that do not know consolidated metadata.
//!
//! Whenever the process dies, the group document describes chunks that are there. Files are not
//! synchronised with the disk one by one: a result outlives the program, not a power cut.
//!
//! A reader has to open the file of a chunk once, as `zarr-python` does. One that asks for its size
//! first, as `zarrs` does through its adapter of asynchronous stores, may then find another file;
//! once the run has ended this does not matter.

mod error;
mod events;
mod sweep;
mod target;
mod track;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use chaindrive_mechanics::{Energy, EventKinds};
use serde_json::{Map, Value, json};
use zarrs::group::Group;
use zarrs::metadata::v3::{AdditionalFieldV3, GroupMetadataV3};

pub use error::WriteError;
pub use sweep::SweepWriter;

use super::attributes::{Ending, Provenance, attributes};
use super::{Axis, Channel, labels};
use crate::Simulation;
use crate::precision::Judgement;
use error::Fault;
use events::EventTracks;
use target::{Storage, Target};
use track::{Track, store_labels};

/// Wall time between two commits.
const COMMIT_EVERY: Duration = Duration::from_secs(1);

/// What happens to an earlier result of the same name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and the new one is refused.
    #[default]
    Keep,
    /// It is removed. Anything but a result of this program stays in any case.
    Replace,
}

/// Streams a run into a Zarr v3 group. Memory is bounded by one chunk a channel, 1 MiB each.
///
/// # Example
///
/// ```
/// use chaindrive::record::{Ending, Existing, Provenance, ZarrWriter};
/// use chaindrive::{Channel, Run, Scene, Simulation};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("ring.zarr");
/// let scene = Scene::preset("spinning_ring")?;
/// let run = Run { until: 5e-3, every: 1e-3, ..Run::default() };
/// let mut simulation = Simulation::start(&scene.drive()?, &run)?;
/// let provenance = Provenance::of(&scene, &run);
/// let channels = [Channel::LinkTension];
/// let mut writer = ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep)?;
/// while simulation.next_sample()?.is_some() {
///     writer.push(&simulation)?;
/// }
/// writer.finish(&simulation, &Ending::Complete)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ZarrWriter {
    path: PathBuf,
    storage: Storage,
    provenance: Provenance,
    time: Track,
    tracks: Vec<(Channel, Track)>,
    /// Contacts, where they are logged.
    events: Option<EventTracks>,
    /// Metadata of the arrays that do not grow.
    fixed: Vec<(&'static str, Value)>,
    start: Option<Energy>,
    judgement: Option<Judgement>,
    /// What the result says about itself in the end.
    told: Option<Map<String, Value>>,
    samples: u64,
    committed: Instant,
}

impl fmt::Debug for ZarrWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZarrWriter")
            .field("path", &self.path)
            .field("samples", &self.samples)
            .finish_non_exhaustive()
    }
}

impl ZarrWriter {
    /// Makes the store for a run that is about to begin; it can be opened from here on.
    ///
    /// # Errors
    /// [`WriteError`] when the target is taken, or cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: Provenance,
        existing: Existing,
    ) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let target = Target::prepare(path, existing)?;
        let made = target.storage().and_then(|storage| {
            let made = Self::begin(path, &storage, simulation, channels, provenance);
            made.map_err(|fault| at(path, fault))
        });
        if made.is_err() {
            target.abandon();
        }
        made
    }

    fn begin(
        path: &Path,
        storage: &Storage,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: Provenance,
    ) -> Result<Self, Fault> {
        let system = simulation.system();
        let mut fixed = Vec::new();
        let mut tracks: Vec<(Channel, Track)> = Vec::new();
        for &channel in channels {
            if tracks.iter().any(|(known, _)| *known == channel) {
                continue;
            }
            let axis = channel.axis();
            if let (Some(name), Some(labels)) = (axis.name(), labels(axis, system))
                && !fixed.iter().any(|(known, _)| *known == name)
            {
                fixed.push((name, store_labels(storage, name, axis, &labels)?));
            }
            let about = about(channel.unit(), channel.description());
            tracks.push((
                channel,
                Track::new(storage, channel.name(), axis, system, about)?,
            ));
        }
        let time = Track::new(storage, "time", Axis::None, system, about("s", "time"))?;
        let logged = provenance.run.events != EventKinds::default();
        let events = logged.then(|| EventTracks::new(storage, system));
        let mut writer = Self {
            path: path.to_owned(),
            storage: storage.clone(),
            provenance,
            time,
            tracks,
            events: events.transpose()?,
            fixed,
            start: None,
            judgement: None,
            told: None,
            samples: 0,
            committed: Instant::now(),
        };
        writer.commit(simulation, &Ending::None)?;
        Ok(writer)
    }

    /// Takes the last sample of the simulation, and commits if the last commit was a while ago.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses. What was committed stays readable.
    pub fn push(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        self.take(simulation)
            .map_err(|fault| at(&self.path, fault))?;
        if self.committed.elapsed() >= COMMIT_EVERY {
            self.flush(simulation)?;
        }
        Ok(())
    }

    fn take(&mut self, simulation: &Simulation) -> Result<(), Fault> {
        let sample = simulation.observation();
        let start = *self.start.get_or_insert(sample.energy);
        self.time.push(|to| to.push(sample.time))?;
        for (channel, track) in &mut self.tracks {
            track.push(|to| channel.read(sample, &start, to))?;
        }
        if let Some(events) = &mut self.events {
            events.push(simulation.events())?;
        }
        self.samples += 1;
        Ok(())
    }

    /// Commits: all samples so far can be read.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses. What was committed before stays readable.
    pub fn flush(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let committed = self.commit(simulation, &Ending::None);
        committed.map_err(|fault| at(&self.path, fault))
    }

    /// Takes in what is said about the error of the run; it is stored with the next commit.
    ///
    /// Channels whose waveforms cease to mean anything within the run get the attribute `waveform_horizon` \[s\]:
    /// samples behind it are for statistics; and `waveform_horizon_of`, the channel on whose errors it was found.
    pub fn judge(&mut self, judgement: &Judgement) {
        for (channel, track) in &mut self.tracks {
            if let Some(horizon) = judgement.horizon_of(*channel) {
                track.tell("waveform_horizon", horizon.at.into());
                track.tell("waveform_horizon_of", horizon.found_on.name().into());
            }
        }
        self.judgement = Some(judgement.clone());
    }

    /// Takes in what the result is to say about itself in the end, in place of what the writer would say.
    pub fn tell(&mut self, attributes: &Map<String, Value>) {
        self.told = Some(attributes.clone());
    }

    /// Commits for the last time and says how the run ended.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses. What was committed before stays readable.
    pub fn finish(mut self, simulation: &Simulation, ending: &Ending) -> Result<(), WriteError> {
        let lasting = match &mut self.events {
            Some(events) => events.push(&simulation.outstanding_events()),
            None => Ok(()),
        };
        let committed = lasting.and_then(|()| self.commit(simulation, ending));
        committed.map_err(|fault| at(&self.path, fault))
    }

    /// Samples taken.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    fn commit(&mut self, simulation: &Simulation, ending: &Ending) -> Result<(), Fault> {
        let mut arrays = Map::new();
        for track in growing(&mut self.time, &mut self.tracks) {
            track.store()?;
            track.set_length(self.samples)?;
            arrays.insert(track.name.into(), track.metadata()?);
        }
        if let Some(events) = &mut self.events {
            events.store()?;
            events.set_length()?;
            for (name, metadata) in events.metadata()? {
                arrays.insert(name.into(), metadata);
            }
        }
        for (name, metadata) in &self.fixed {
            arrays.insert((*name).into(), metadata.clone());
        }
        let consolidated = json!({ "kind": "inline", "metadata": arrays });
        // `Group::set_consolidated_metadata` would do, but loses the order of the arrays.
        let fields = [(
            "consolidated_metadata".to_owned(),
            AdditionalFieldV3::new(consolidated, false),
        )];
        let metadata = GroupMetadataV3::new()
            .with_attributes(self.told.clone().unwrap_or_else(|| {
                let judgement = self.judgement.as_ref();
                let (provenance, samples) = (&self.provenance, self.samples);
                attributes(provenance, simulation, None, samples, ending, judgement)
            }))
            .with_additional_fields(fields.into_iter().collect());
        Group::new_with_metadata(self.storage.clone(), "/", metadata.into())?.store_metadata()?;
        for track in growing(&mut self.time, &mut self.tracks) {
            track.store_metadata()?;
        }
        if let Some(events) = &self.events {
            events.store_metadata()?;
        }
        self.committed = Instant::now();
        Ok(())
    }
}

fn growing<'a>(
    time: &'a mut Track,
    tracks: &'a mut [(Channel, Track)],
) -> impl Iterator<Item = &'a mut Track> {
    std::iter::once(time).chain(tracks.iter_mut().map(|(_, track)| track))
}

fn about(unit: &str, text: &str) -> Map<String, Value> {
    let entries = [("units", unit), ("long_name", text)];
    entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value.into()))
        .collect()
}

fn at(path: &Path, fault: Fault) -> WriteError {
    WriteError::Store {
        path: path.to_owned(),
        source: Box::new(fault),
    }
}
