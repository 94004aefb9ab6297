//! Results on disk: Zarr v3, readable while the run goes on and after it was killed.
//!
//! ```text
//! out.zarr/
//!   zarr.json              group: attributes, and the metadata of all arrays
//!   time/                  (time,) [s]
//!   span/, roller/, …      labels of the other dimensions
//!   span_tension/          (time, span) [N]: zarr.json, c/0/0, c/1/0, …
//!   event_start/, …        (event,) contacts from touch to parting, where they are logged
//!   checkpoint             what the run goes on from, where it can: no array, and not listed
//! ```
//!
//! `zarrs` makes the arrays and their chunks; every file is put in place by renaming it, whole or not at
//! all, and so is the store: it is begun beside its place (`zarr/claim.rs`). A commit writes in this order:
//!
//! 1. the chunks in work, filled up with NaN; the samples already there do not change,
//! 2. the metadata of each array, for readers that do not know consolidated metadata,
//! 3. the group document with the new lengths of **all** arrays as consolidated metadata: one
//!    rename, after which every reader that opens the group sees the new samples.
//!
//! Whenever the process dies, the group document describes chunks that are there. Files are not
//! synchronised with the disk one by one: a result outlives the program, not a power cut.
//!
//! `RecordedRun::open` reads a store back, and `StoppedRun::open` claims one to go on with.
//!
//! A reader has to open the file of a chunk once, as `zarr-python` does. One that asks for its size
//! first, as object stores do, may then find another file; once the run has ended this does not matter.

mod content;
mod events;
mod reader;
mod stopped_run;

use std::fmt;
use std::path::Path;
use std::time::Duration;

use serde_json::{Map, Value};

pub use reader::{ReadError, inspect};
pub use stopped_run::{ResumeError, StoppedRun};

use super::attributes::{Provenance, attributes};
use crate::clock::Instant;
use crate::precision::Judgement;
use crate::story::Ending;
use crate::zarr::{CHECKPOINT, Existing, Store, WriteError};
use crate::{Channel, Checkpoint, Simulation};
use content::Content;

/// Wall time between two commits.
const COMMIT_EVERY: Duration = Duration::from_secs(1);

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
    content: Content,
    provenance: Provenance,
    judgement: Option<Judgement>,
    /// Attributes of the result in the end.
    told: Option<Map<String, Value>>,
    samples: u64,
    /// Whether the checkpoint in the store is of the last sample.
    kept: bool,
    /// Store in its place. An earlier result stays there until the first sample or checkpoint.
    is_public: bool,
    committed: Instant,
    store: Store,
}

impl fmt::Debug for ZarrWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZarrWriter")
            .field("path", &self.store.path())
            .field("samples", &self.samples)
            .finish_non_exhaustive()
    }
}

impl ZarrWriter {
    /// Makes the store for a run that is about to begin. It can be opened from here on; where it replaces an earlier result, as soon as it has samples or a
    /// checkpoint, and the earlier one stays until then.
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
        let store = Store::begin(path.as_ref(), existing)?;
        Self::begin(store, simulation, channels, provenance)
    }

    fn begin(
        store: Store,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: Provenance,
    ) -> Result<Self, WriteError> {
        let content = Content::new(store.storage(), simulation, channels, &provenance);
        let mut writer = Self {
            content: content.map_err(|fault| store.fault(fault))?,
            provenance,
            judgement: None,
            told: None,
            samples: 0,
            kept: false,
            is_public: false,
            committed: Instant::now(),
            store,
        };
        writer.commit(simulation, &Ending::None)?;
        writer.publish()?;
        Ok(writer)
    }

    /// Goes on with a store that was left: what it holds after the checkpoint is forgotten.
    pub(super) fn go_on(
        mut store: Store,
        checkpoint: &Checkpoint,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: Provenance,
    ) -> Result<Self, WriteError> {
        store.go_on()?;
        let (samples, contacts) = (checkpoint.samples(), checkpoint.contacts());
        let content = Content::new(store.storage(), simulation, channels, &provenance);
        let content = content.and_then(|mut content| {
            content.go_on(samples, contacts, simulation.start_energy())?;
            Ok(content)
        });
        let mut writer = Self {
            content: content.map_err(|fault| store.fault(fault))?,
            provenance,
            judgement: None,
            told: None,
            samples,
            kept: false,
            is_public: true,
            committed: Instant::now(),
            store,
        };
        // It may have another end by now, which a second interruption is not to forget.
        let kept = writer.store.put(CHECKPOINT, &checkpoint.to_bytes());
        kept.map_err(|fault| writer.store.fault(fault))?;
        writer.commit(simulation, &Ending::None)?;
        // Readers see the checkpoint's samples alone from here on.
        for (array, last) in writer.content.last_chunks() {
            let cleared = writer.store.clear_behind(array, last);
            cleared.map_err(|fault| writer.store.fault(fault))?;
        }
        Ok(writer)
    }

    /// Takes note of what is known of the run once it has been run in.
    pub(super) fn goes_by(&mut self, provenance: Provenance) {
        self.provenance = provenance;
    }

    /// Keeps what the run goes on from when it is stopped or killed, with all samples before it.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn keep(
        &mut self,
        simulation: &Simulation,
        checkpoint: &Checkpoint,
    ) -> Result<(), WriteError> {
        self.flush(simulation)?;
        let bytes = checkpoint.to_bytes();
        self.or_give_up(|writer| {
            let kept = writer.store.put(CHECKPOINT, &bytes);
            kept.map_err(|fault| writer.store.fault(fault))?;
            writer.kept = true;
            writer.publish()
        })
    }

    /// Takes the last sample of the simulation, and commits if the last commit was a while ago.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses, and in every call after that. What was committed stays readable,
    /// and the store says that it failed.
    pub fn push(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let pushed = self.content.push(simulation);
        self.or_give_up(|writer| pushed.map_err(|fault| writer.store.fault(fault)))?;
        self.samples += 1;
        self.kept = false;
        // The first sample is something to put in the place of an earlier result.
        if !self.is_public || self.committed.elapsed() >= COMMIT_EVERY {
            self.flush(simulation)?;
        }
        Ok(())
    }

    /// Commits: all samples so far can be read.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn flush(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        self.or_give_up(|writer| {
            writer.commit(simulation, &Ending::None)?;
            writer.publish()
        })
    }

    /// Puts the store in its place once it has something: samples, or what the run goes on from.
    fn publish(&mut self) -> Result<(), WriteError> {
        let has_something = self.samples > 0 || self.kept || !self.store.place().exists();
        if !self.is_public && has_something {
            self.store.publish()?;
            self.is_public = true;
        }
        Ok(())
    }

    /// Takes in what is said about the error of the run; it is stored with the next commit.
    ///
    /// Channels whose waveforms cease to mean anything within the run get the attribute `waveform_horizon` \[s\]:
    /// samples after it are for statistics; and `waveform_horizon_of`, the channel on whose errors it was found.
    pub fn judge(&mut self, judgement: &Judgement) {
        self.content.judge(judgement);
        self.judgement = Some(judgement.clone());
    }

    /// Takes in what the result is to say about itself in the end, in place of what the writer would say.
    pub fn tell(&mut self, attributes: &Map<String, Value>) {
        self.told = Some(attributes.clone());
    }

    /// Commits for the last time and says how the run ended. A checkpoint that is not of the last sample goes.
    ///
    /// A writer that is dropped without this leaves a result that says so.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn finish(mut self, simulation: &Simulation, ending: &Ending) -> Result<(), WriteError> {
        let pushed = self.content.push_outstanding(simulation);
        self.or_give_up(|writer| {
            pushed.map_err(|fault| writer.store.fault(fault))?;
            writer.commit(simulation, ending)?;
            writer.publish()?;
            // What has failed would fail again.
            if writer.kept && !matches!(ending, Ending::Failed(_)) {
                return Ok(());
            }
            let removed = writer.store.remove(CHECKPOINT);
            removed.map_err(|fault| writer.store.fault(fault))
        })
    }

    /// Samples taken.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Does something with the store; an error ends it.
    fn or_give_up(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let done = work(self);
        if let Err(error) = &done {
            self.store.give_up(&error.without_path());
        }
        done
    }

    fn commit(&mut self, simulation: &Simulation, ending: &Ending) -> Result<(), WriteError> {
        let stored = self.content.store(self.samples);
        let arrays = stored.map_err(|fault| self.store.fault(fault))?;
        let attributes = self.told.clone().unwrap_or_else(|| {
            let judgement = self.judgement.as_ref();
            let (provenance, samples) = (&self.provenance, self.samples);
            attributes(provenance, simulation, None, samples, ending, judgement)
        });
        self.store.tell(attributes, arrays, ending)?;
        self.committed = Instant::now();
        Ok(())
    }
}
