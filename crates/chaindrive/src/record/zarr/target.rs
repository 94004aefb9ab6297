//! Where a result goes: a folder that is new, empty, or an earlier result that may be replaced.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use object_store::local::LocalFileSystem;
use serde_json::Value;
use zarrs::storage::ReadableWritableListableStorageTraits;
use zarrs::storage::storage_adapter::async_to_sync::{
    AsyncToSyncBlockOn, AsyncToSyncStorageAdapter,
};
use zarrs_object_store::AsyncObjectStore;

use super::Existing;
use super::error::WriteError;
use crate::record::attributes::FORMAT;

/// A store whose files appear whole or not at all.
pub(super) type Storage = Arc<dyn ReadableWritableListableStorageTraits>;

/// The document that makes a folder a Zarr group.
const GROUP: &str = "zarr.json";

/// The local file system works on the calling thread when no runtime is about: nothing to wait for.
struct OnThisThread;

impl AsyncToSyncBlockOn for OnThisThread {
    fn block_on<F: Future>(&self, future: F) -> F::Output {
        pollster::block_on(future)
    }
}

/// A folder made ready for a result.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) path: PathBuf,
    /// Whether the folder is ours to remove if the first write fails.
    made: bool,
}

impl Target {
    /// Makes the folder, or empties it of an earlier result.
    pub(super) fn prepare(path: &Path, existing: Existing) -> Result<Self, WriteError> {
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        let contents = match fs::read_dir(path) {
            Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(io)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(path).map_err(io)?;
                return Ok(Self {
                    path: path.to_owned(),
                    made: true,
                });
            }
            Err(_) if path.is_file() => {
                return Err(foreign(path, "this is a file, not a result".into()));
            }
            Err(error) => return Err(io(error)),
        };
        if !contents.is_empty() {
            let members = members(path)?;
            if existing == Existing::Keep {
                return Err(WriteError::Exists {
                    path: path.to_owned(),
                });
            }
            let names = contents
                .iter()
                .map(|entry| entry.file_name().to_string_lossy().into_owned());
            remove(path, &names.collect::<Vec<_>>(), &members)?;
        }
        Ok(Self {
            path: path.to_owned(),
            made: false,
        })
    }

    /// Opens the store.
    pub(super) fn storage(&self) -> Result<Storage, WriteError> {
        let files =
            LocalFileSystem::new_with_prefix(&self.path).map_err(|source| WriteError::Store {
                path: self.path.clone(),
                source: Box::new(source),
            })?;
        let store = Arc::new(AsyncObjectStore::new(files));
        Ok(Arc::new(AsyncToSyncStorageAdapter::new(
            store,
            OnThisThread,
        )))
    }

    /// Takes back what was made when nothing useful could be written.
    pub(super) fn abandon(&self) {
        if self.made {
            // The error that led here is the one to report.
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

fn foreign(path: &Path, found: String) -> WriteError {
    WriteError::Foreign {
        path: path.to_owned(),
        found,
    }
}

/// Names of the arrays of an earlier result; an error if the folder is anything else.
fn members(path: &Path) -> Result<Vec<String>, WriteError> {
    let not_ours = || foreign(path, "this folder is not a result of chaindrive".into());
    let text = fs::read(path.join(GROUP)).map_err(|_| not_ours())?;
    let group: Value = serde_json::from_slice(&text).map_err(|_| not_ours())?;
    if group["attributes"]["format"] != FORMAT {
        return Err(not_ours());
    }
    let arrays = group["consolidated_metadata"]["metadata"].as_object();
    Ok(arrays
        .into_iter()
        .flatten()
        .map(|(name, _)| name.clone())
        .collect())
}

/// Removes an earlier result, the group document last, so that until then it is known as one.
fn remove(path: &Path, names: &[String], members: &[String]) -> Result<(), WriteError> {
    // What a killed run leaves of a file it was about to put in place: `zarr.json#1`.
    let staged = |name: &str| name.starts_with(&format!("{GROUP}#"));
    let known = |name: &str| name == GROUP || staged(name) || members.iter().any(|m| m == name);
    if let Some(stranger) = names.iter().find(|name| !known(name)) {
        let found = format!("`{stranger}` in this folder is not of chaindrive");
        return Err(foreign(path, found));
    }
    let io = |at: &Path, source| WriteError::Io {
        path: at.to_owned(),
        source,
    };
    for name in names.iter().filter(|name| *name != GROUP) {
        let at = path.join(name);
        let removed = if staged(name) {
            fs::remove_file(&at)
        } else {
            fs::remove_dir_all(&at)
        };
        removed.map_err(|source| io(&at, source))?;
    }
    let group = path.join(GROUP);
    fs::remove_file(&group).map_err(|source| io(&group, source))
}
