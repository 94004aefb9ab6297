//! A store in the making: begun beside its place, put there whole, and told how it ended.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Map, Value, json};
use zarrs::group::Group;
use zarrs::metadata::v3::{AdditionalFieldV3, GroupMetadataV3};
use zarrs::storage::StoreKey;

use super::bucket::{Bucket, Objects};
use super::claim::Claim;
use super::fault::Fault;
use super::files::{Ground, Storage};
use super::folder::Folder;
use super::inspect::inspect;
use super::names::GROUP;
use super::write_error::WriteError;
use super::{Existing, target};
use crate::story::Ending;

/// Space for a last group document on a full disk, beyond twice the length of the first.
const RESERVE: usize = 1 << 16;

/// A store with its files and the last group document.
pub(crate) struct Store {
    path: PathBuf,
    disk: Option<Disk>,
    storage: Storage,
    last: Document,
    /// Whether the ending is written: that of the run, or that it was given up.
    ended: bool,
    /// Why it had failed before it went on.
    earlier: Option<String>,
}

/// Means of stores on a disk: a claim that the system lets go of when the process ends, and a folder that takes its place whole.
struct Disk {
    claim: Claim,
    folder: Arc<Folder>,
}

/// Contents of the group document.
#[derive(Clone, Default)]
struct Document {
    attributes: Map<String, Value>,
    arrays: Map<String, Value>,
}

impl Store {
    /// Claims a place and begins a store beside it. What was in the place stays until
    /// [`publish`](Self::publish).
    pub(crate) fn begin(path: &Path, existing: Existing) -> Result<Self, WriteError> {
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        if path.extension().is_none_or(|extension| extension != "zarr") {
            return Err(WriteError::Name {
                path: path.to_owned(),
            });
        }
        // `s3://bucket`, or `s3:/bucket` where a path was made of it; `C:` is a drive.
        let first = path.components().next();
        let first = first.map(|it| it.as_os_str().to_string_lossy().into_owned());
        if first.is_some_and(|it| it.len() > 2 && it.ends_with(':')) {
            return Err(WriteError::Address {
                path: path.to_owned(),
            });
        }
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(io)?;
        }
        let claim = Claim::take(path)?;
        target::check(path, claim.place(), existing)?;
        let folder = Arc::new(Folder::create(claim.workshop()).map_err(io)?);
        Ok(Self {
            path: path.to_owned(),
            storage: Ground::of(folder.clone()),
            disk: Some(Disk { claim, folder }),
            last: Document::default(),
            ended: false,
            earlier: None,
        })
    }

    /// Begins a store in an object store, where nobody else has begun one. What was in the place is removed at once.
    pub(crate) fn begin_in(
        objects: &Arc<dyn Objects>,
        existing: Existing,
    ) -> Result<Self, WriteError> {
        let path = PathBuf::from(objects.name());
        target::clear(&path, objects.as_ref(), existing)?;
        let begun = Bucket::begin(objects).map_err(|source| WriteError::Io {
            path: path.clone(),
            source,
        })?;
        let bucket = begun.ok_or_else(|| WriteError::HalfBegun { path: path.clone() })?;
        Ok(Self {
            path,
            storage: Ground::of(Arc::new(bucket)),
            disk: None,
            last: Document::default(),
            ended: false,
            earlier: None,
        })
    }

    /// Claims a store that was left, to go on with it. It says what it said until the next [`tell`](Self::tell).
    pub(crate) fn reopen(path: &Path) -> Result<Self, WriteError> {
        Self::reopen_by(path, Folder::open)
    }

    /// Claims a store that was left, to go on with it together with other processes.
    pub(crate) fn reopen_shared(path: &Path) -> Result<Self, WriteError> {
        Self::reopen_by(path, |root| {
            let folder = Folder::shared(root)?;
            folder.clear_staged()?;
            Ok(folder)
        })
    }

    fn reopen_by(
        path: &Path,
        open: impl FnOnce(&Path) -> io::Result<Folder>,
    ) -> Result<Self, WriteError> {
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        let claim = Claim::take(path)?;
        let group = target::group(path, claim.place())?;
        inspect(claim.place(), &group).map_err(|found| WriteError::Foreign {
            path: path.to_owned(),
            found,
        })?;
        let folder = Arc::new(open(claim.place()).map_err(io)?);
        let disk = Disk {
            claim,
            folder: Arc::clone(&folder),
        };
        Ok(Self::left(path, Ground::of(folder), Some(disk), &group))
    }

    /// A store in an object store, to go on with it together with other processes.
    pub(crate) fn reopen_in(objects: &Arc<dyn Objects>) -> Result<Self, WriteError> {
        let path = PathBuf::from(objects.name());
        let bucket = target::bucket(&path, objects)?;
        let storage = Ground::of(Arc::new(bucket));
        let group = objects.get(GROUP).map_err(|source| WriteError::Io {
            path: path.clone(),
            source,
        })?;
        let group = group.as_ref().map(|object| object.bytes.as_slice());
        let group = target::document(&path, group)?;
        Ok(Self::left(&path, storage, None, &group))
    }

    fn left(path: &Path, storage: Storage, disk: Option<Disk>, group: &Value) -> Self {
        let entries = |value: &Value| value.as_object().cloned().unwrap_or_default();
        Self {
            path: path.to_owned(),
            storage,
            disk,
            last: Document {
                attributes: entries(&group["attributes"]),
                arrays: entries(&group["consolidated_metadata"]["metadata"]),
            },
            // Nothing new has been said that could be broken off.
            ended: true,
            earlier: group["attributes"]["failure"].as_str().map(str::to_owned),
        }
    }

    /// Goes on: from here on the store is being written.
    pub(crate) fn go_on(&mut self) -> Result<(), WriteError> {
        self.ended = false;
        self.set_aside()
    }

    /// Attributes of the store.
    pub(crate) fn attributes(&self) -> &Map<String, Value> {
        &self.last.attributes
    }

    /// A file of its own, beside the arrays.
    pub(crate) fn read(&self, key: &str) -> Result<Option<Vec<u8>>, Fault> {
        let bytes = self.storage.read(&StoreKey::new(key)?)?;
        Ok(bytes.map(Vec::from))
    }

    /// Puts such a file in place, whole or not at all.
    pub(crate) fn put(&self, key: &str, bytes: &[u8]) -> Result<(), Fault> {
        Ok(self.storage.put(&StoreKey::new(key)?, bytes)?)
    }

    /// Removes it, if it is there.
    pub(crate) fn remove(&self, key: &str) -> Result<(), Fault> {
        Ok(self.storage.remove(&StoreKey::new(key)?)?)
    }

    /// Removes the chunks of an array after the last that is used along its first dimension.
    pub(crate) fn clear_behind(&self, array: &str, last: u64) -> Result<(), Fault> {
        let chunks = format!("{array}/c/");
        for key in self.storage.held(&chunks)? {
            let place = key.as_str().trim_start_matches(&chunks);
            let index = place.split('/').next().and_then(|it| it.parse().ok());
            if index.is_some_and(|index: u64| index > last) {
                self.storage.remove(&key)?;
            }
        }
        Ok(())
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn storage(&self) -> &Storage {
        &self.storage
    }

    /// Where the store is, symbolic links followed.
    pub(crate) fn place(&self) -> &Path {
        let disk = self.disk.as_ref();
        disk.map_or(&self.path, |disk| disk.claim.place())
    }

    /// Number of the open file that holds the claim, on a disk.
    #[cfg(unix)]
    pub(crate) fn descriptor(&self) -> Option<i32> {
        self.disk.as_ref().map(|disk| disk.claim.descriptor())
    }

    /// Lets other processes write in the store as well, once it is in place.
    pub(crate) fn share(&mut self) -> Result<(), WriteError> {
        if let Some(disk) = &mut self.disk {
            let folder = Folder::shared(disk.claim.place());
            let folder = folder.map_err(|source| WriteError::Io {
                path: self.path.clone(),
                source,
            })?;
            disk.folder = Arc::new(folder);
            self.storage = Ground::of(disk.folder.clone());
        }
        Ok(())
    }

    /// Puts the store in place, with space set aside for its last words.
    pub(crate) fn publish(&self) -> Result<(), WriteError> {
        self.set_aside()?;
        if let Some(Disk { claim, folder }) = &self.disk {
            claim.put_in_place()?;
            folder.moved_to(claim.place());
        }
        Ok(())
    }

    /// Sets space aside for the last words, where it may run out.
    fn set_aside(&self) -> Result<(), WriteError> {
        let Some(disk) = &self.disk else {
            return Ok(());
        };
        let document = json!([self.last.attributes, self.last.arrays]).to_string();
        let reserved = disk.claim.reserve(2 * document.len() + RESERVE);
        reserved.map_err(|source| WriteError::Io {
            path: self.path.clone(),
            source,
        })
    }

    /// Writes the group document: from here on readers see what it lists.
    ///
    /// A store ends only when everything that was written is still there.
    pub(crate) fn tell(
        &mut self,
        attributes: Map<String, Value>,
        arrays: Map<String, Value>,
        ending: &Ending,
    ) -> Result<(), WriteError> {
        if self.ended {
            return Err(WriteError::GivenUp {
                path: self.path.clone(),
            });
        }
        if *ending != Ending::None
            && let Some(what) = self.storage.missing()
        {
            return Err(self.vanished(what));
        }
        let document = Document { attributes, arrays };
        self.write(&document).map_err(|fault| self.fault(fault))?;
        self.last = document;
        self.ended = *ending != Ending::None;
        Ok(())
    }

    fn write(&self, document: &Document) -> Result<(), Fault> {
        // A folder knows itself, wherever it is. A place in an object store may have become that of another store.
        if self.disk.is_none() && self.storage.missing().is_some() {
            return Err(io::Error::from(io::ErrorKind::NotFound).into());
        }
        let consolidated = json!({ "kind": "inline", "metadata": document.arrays });
        // `Group::set_consolidated_metadata` would do, but loses the order of the arrays.
        let fields = [(
            "consolidated_metadata".to_owned(),
            AdditionalFieldV3::new(consolidated, false),
        )];
        let metadata = GroupMetadataV3::new()
            .with_attributes(document.attributes.clone())
            .with_additional_fields(fields.into_iter().collect());
        Ok(
            Group::new_with_metadata(Arc::clone(&self.storage), "/", metadata.into())?
                .store_metadata()?,
        )
    }

    /// A fault with its place; that the store was taken away explains every other.
    pub(crate) fn fault(&self, fault: Fault) -> WriteError {
        match self.storage.missing() {
            Some(what) => self.vanished(what),
            None => WriteError::Store {
                path: self.path.clone(),
                source: Box::new(fault),
            },
        }
    }

    fn vanished(&self, what: String) -> WriteError {
        WriteError::Vanished {
            path: self.path.clone(),
            what,
        }
    }

    /// Says in the store why nothing more is written: what was told last stays as it is otherwise.
    pub(crate) fn give_up(&mut self, reason: &str) {
        if self.ended {
            return;
        }
        self.ended = true;
        let failed = Ending::Failed(reason.to_owned());
        let mut document = self.last.clone();
        let attributes = &mut document.attributes;
        if attributes.is_empty() {
            // On a disk it was begun beside its place. Elsewhere the place would stay taken.
            if self.disk.is_none() && self.storage.missing().is_none() {
                let _ = self.storage.remove_all();
            }
            return;
        }
        attributes.insert("status".into(), failed.status().into());
        attributes.insert("complete".into(), 0.into());
        // A second failure is mostly what the first one left.
        let reason = match &self.earlier {
            Some(earlier) if earlier != reason => {
                format!("{earlier}; and when it went on: {reason}")
            }
            _ => reason.to_owned(),
        };
        attributes.insert("failure".into(), reason.into());
        if let Some(disk) = &self.disk {
            disk.claim.spend_reserve();
        }
        // Where even this fails the store says `running`, and no lock is held: readers can tell.
        let _ = self.write(&document);
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        self.give_up("the program gave the result up before its end");
    }
}
