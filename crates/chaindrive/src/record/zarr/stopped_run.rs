//! Results of runs that were stopped or killed, and go on.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::record::Checkpoint;
use crate::record::zarr_sink::ZarrSink;
use crate::zarr::{CHECKPOINT, Store, WriteError};
use crate::{RequestError, SealError, SettingValue};

/// A result whose run can go on, claimed for that.
///
/// Runs leave a checkpoint when Ctrl-C or a signal stops them, and runs with
/// [checkpoints](crate::Request::with_checkpoints) under way and at their end as well. What the store holds after its
/// checkpoint is simulated again: the result is that of a run that was never stopped, to the last bit, but for its wall
/// times.
///
/// # Example
///
/// ```
/// use chaindrive::record::{Existing, ZarrSink, StoppedRun};
/// use chaindrive::{SettingValue, Request, Scene, Settings, execute};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("ring.zarr");
/// let settings = Settings::default().with("until", SettingValue::Number(4e-3));
/// let request = Request::new(&Scene::preset("spinning_ring")?, &settings)?;
/// let request = request.without_estimate().with_checkpoints(&SettingValue::Number(1e-3))?;
/// execute(&request, &mut ZarrSink::new(path.clone(), Existing::Keep), &|| false)?;
///
/// let report = StoppedRun::open(&path, Some(&SettingValue::Number(6e-3)))?.resume(&|| false)?;
/// assert_eq!(report.attributes["status"], "complete");
/// assert_eq!(report.attributes["samples"], 61);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StoppedRun {
    store: Store,
    checkpoint: Checkpoint,
}

impl fmt::Debug for StoppedRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StoppedRun")
            .field("path", &self.store.path())
            .field("samples", &self.checkpoint.samples())
            .finish_non_exhaustive()
    }
}

/// Why a result cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum ResumeError {
    /// It is being written, or it is no result.
    #[error(transparent)]
    Store(#[from] WriteError),

    /// There is nothing to go on from.
    #[error("{}: there is no checkpoint here to go on from: {why}", .path.display())]
    NoCheckpoint { path: PathBuf, why: String },

    /// The checkpoint cannot be read.
    #[error("{}: {source}", .path.display())]
    Checkpoint { path: PathBuf, source: SealError },

    /// The checkpoint and the result are of different runs.
    #[error(
        "{}: the checkpoint is of another scene than the result says; somebody has changed one of them: begin anew",
        .path.display()
    )]
    OtherScene { path: PathBuf },

    /// There is nothing left to do.
    #[error("{}: the run is complete, up to {until} s; give a later end to carry it on", .path.display())]
    Complete { path: PathBuf, until: f64 },

    /// The end asked for.
    #[error("{}: {source}", .path.display())]
    Until { path: PathBuf, source: RequestError },
}

impl StoppedRun {
    /// Claims a result and reads its checkpoint. The run goes on to the end that was asked for, or to another one,
    /// which may be as early as the last sample.
    ///
    /// # Errors
    /// [`ResumeError`]: somebody writes it, it is no result, it is complete, or it has no checkpoint that could be used.
    pub fn open(path: &Path, until: Option<&SettingValue>) -> Result<Self, ResumeError> {
        if !path.exists() {
            let why = "there is nothing of this name; check the path".to_owned();
            let path = path.to_owned();
            return Err(ResumeError::NoCheckpoint { path, why });
        }
        let store = Store::reopen(path)?;
        let path = || path.to_owned();
        let bytes = store.read(CHECKPOINT).map_err(|fault| store.fault(fault))?;
        let said = |name: &str| store.attributes().get(name).and_then(|it| it.as_str());
        let Some(bytes) = bytes else {
            let why = match (said("status"), said("failure")) {
                (Some("complete"), _) => {
                    "the run is complete, and was not asked to keep checkpoints".to_owned()
                }
                (Some("failed"), Some(reason)) => {
                    format!("the run failed, and was left without one: {reason}")
                }
                _ if store.attributes().contains_key("checkpoint_every") => {
                    "the run was killed before the first one; begin anew".to_owned()
                }
                _ => "the run was killed, and was not asked to keep checkpoints; begin anew"
                    .to_owned(),
            };
            return Err(ResumeError::NoCheckpoint { path: path(), why });
        };
        let checkpoint = Checkpoint::from_bytes(&bytes);
        let mut checkpoint = checkpoint.map_err(|source| ResumeError::Checkpoint {
            path: path(),
            source,
        })?;
        let end = store.attributes().get("until");
        let is_whole = end.and_then(serde_json::Value::as_f64) == Some(checkpoint.until());
        if !checkpoint.is_of(said("scene").unwrap_or_default()) {
            return Err(ResumeError::OtherScene { path: path() });
        }
        if let Some(until) = until {
            let extended = checkpoint.extend(until);
            extended.map_err(|source| ResumeError::Until {
                path: path(),
                source,
            })?;
        } else if said("status") == Some("complete") && is_whole {
            return Err(ResumeError::Complete {
                path: path(),
                until: checkpoint.until(),
            });
        }
        Ok(Self { store, checkpoint })
    }

    /// State from which the run goes on.
    pub fn checkpoint(&self) -> &Checkpoint {
        &self.checkpoint
    }

    /// The checkpoint, and the store as the sink of what follows.
    pub(crate) fn into_parts(self) -> (Checkpoint, ZarrSink) {
        let Self { store, checkpoint } = self;
        let sink = ZarrSink::left(store, checkpoint.clone());
        (checkpoint, sink)
    }
}
