//! A store in the making: begun beside its place, put there whole, and told how it ended.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Map, Value, json};
use zarrs::group::Group;
use zarrs::metadata::v3::{AdditionalFieldV3, GroupMetadataV3};
use zarrs::storage::{
    ReadableStorageTraits, ReadableWritableStorageTraits, StoreKey, WritableStorageTraits,
};

use super::error::Fault;
use super::folder::Folder;
use super::{Ending, Existing, target};
use crate::record::claim::Claim;
use crate::record::error::WriteError;

/// Where arrays write their chunks.
pub(super) type Storage = Arc<dyn ReadableWritableStorageTraits>;

/// Space for a last group document on a full disk, beyond twice the length of the first.
const RESERVE: usize = 1 << 16;

/// A store with its claim, its files, and the last group document.
pub(in crate::record) struct Store {
    path: PathBuf,
    claim: Claim,
    folder: Arc<Folder>,
    storage: Storage,
    last: Document,
    /// Whether the last word was said: how it ended, or that it was given up.
    ended: bool,
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
    pub(super) fn begin(path: &Path, existing: Existing) -> Result<Self, WriteError> {
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        if path.extension().is_none_or(|extension| extension != "zarr") {
            return Err(WriteError::Name {
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
            claim,
            storage: folder.clone(),
            folder,
            last: Document::default(),
            ended: false,
        })
    }

    /// Claims a store that was left, to go on with it. It says what it said until the next [`tell`](Self::tell).
    pub(super) fn reopen(path: &Path) -> Result<Self, WriteError> {
        Self::reopen_by(path, Folder::open)
    }

    /// Claims a store that was left, to go on with it together with other processes.
    pub(super) fn reopen_shared(path: &Path) -> Result<Self, WriteError> {
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
        let folder = Arc::new(open(claim.place()).map_err(io)?);
        let entries = |value: &Value| value.as_object().cloned().unwrap_or_default();
        Ok(Self {
            path: path.to_owned(),
            claim,
            storage: folder.clone(),
            folder,
            last: Document {
                attributes: entries(&group["attributes"]),
                arrays: entries(&group["consolidated_metadata"]["metadata"]),
            },
            // Nothing new has been said that could be broken off.
            ended: true,
        })
    }

    /// Goes on: from here on the store is being written.
    pub(super) fn go_on(&mut self) -> Result<(), WriteError> {
        self.ended = false;
        self.set_aside()
    }

    /// Attributes of the store.
    pub(super) fn attributes(&self) -> &Map<String, Value> {
        &self.last.attributes
    }

    /// A file of its own, beside the arrays.
    pub(super) fn read(&self, key: &str) -> Result<Option<Vec<u8>>, Fault> {
        let bytes = self.folder.get(&StoreKey::new(key)?)?;
        Ok(bytes.map(Vec::from))
    }

    /// Puts such a file in place, whole or not at all.
    pub(super) fn put(&self, key: &str, bytes: Vec<u8>) -> Result<(), Fault> {
        Ok(self.folder.set(&StoreKey::new(key)?, bytes.into())?)
    }

    /// Removes it, if it is there.
    pub(super) fn remove(&self, key: &str) -> Result<(), Fault> {
        Ok(self.folder.erase(&StoreKey::new(key)?)?)
    }

    /// Removes the chunks of an array behind the last that is used.
    pub(super) fn clear_behind(&self, array: &str, last: u64) -> Result<(), Fault> {
        Ok(self.folder.clear_behind(array, last)?)
    }

    pub(in crate::record) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn storage(&self) -> &Storage {
        &self.storage
    }

    /// Where the store is, symbolic links followed.
    pub(super) fn place(&self) -> &Path {
        self.claim.place()
    }

    #[cfg(unix)]
    pub(super) fn descriptor(&self) -> i32 {
        self.claim.descriptor()
    }

    /// Lets other processes write in the store as well, once it is in place.
    pub(super) fn share(&mut self) -> Result<(), WriteError> {
        let folder = Folder::shared(self.claim.place());
        self.folder = Arc::new(folder.map_err(|source| WriteError::Io {
            path: self.path.clone(),
            source,
        })?);
        self.storage = self.folder.clone();
        Ok(())
    }

    /// Puts the store in place, with space set aside for its last words.
    pub(super) fn publish(&self) -> Result<(), WriteError> {
        self.set_aside()?;
        self.claim.put_in_place()?;
        self.folder.moved_to(self.claim.place());
        Ok(())
    }

    /// Sets space aside for the last words.
    fn set_aside(&self) -> Result<(), WriteError> {
        let document = json!([self.last.attributes, self.last.arrays]).to_string();
        let reserved = self.claim.reserve(2 * document.len() + RESERVE);
        reserved.map_err(|source| WriteError::Io {
            path: self.path.clone(),
            source,
        })
    }

    /// Writes the group document: from here on readers see what it lists.
    ///
    /// A store ends only when everything that was written is still there.
    pub(super) fn tell(
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
            && let Some(what) = self.folder.missing()
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
    pub(super) fn fault(&self, fault: Fault) -> WriteError {
        match self.folder.missing() {
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
    pub(super) fn give_up(&mut self, reason: &str) {
        if self.ended {
            return;
        }
        self.ended = true;
        let failed = Ending::Failed(reason.to_owned());
        let mut document = self.last.clone();
        let attributes = &mut document.attributes;
        if attributes.is_empty() {
            return;
        }
        attributes.insert("status".into(), failed.status().into());
        attributes.insert("complete".into(), 0.into());
        attributes.insert("failure".into(), reason.into());
        self.claim.spend_reserve();
        // Where even this fails the store says `running`, and no lock is held: readers can tell.
        let _ = self.write(&document);
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        self.give_up("the program gave the result up before its end");
    }
}
