//! The files of a store: each appears whole or not at all, and none where the store is gone.
//!
//! Folders are made once. A folder or file that was there and is not is an error: somebody removes the
//! store, and to make it anew would leave a torso that looks like a result.

use std::collections::HashSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use same_file::Handle;
use zarrs::storage::byte_range::{ByteRangeIterator, extract_byte_ranges};
use zarrs::storage::{
    Bytes, MaybeBytes, MaybeBytesIterator, OffsetBytesIterator, ReadableStorageTraits,
    StorageError, StoreKey, StorePrefix, WritableStorageTraits, store_set_partial_many,
};

/// Begins the end of the name of a file on its way, the number of its process; readers of the store know no such key.
pub(super) const STAGED: char = '#';

/// A folder with a store in the making.
#[derive(Debug)]
pub(super) struct Folder {
    /// Keeps the folder recognisable, wherever it is moved.
    itself: Handle,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    root: PathBuf,
    /// Folders and files made, from the root.
    folders: HashSet<PathBuf>,
    files: HashSet<StoreKey>,
    /// Whether other processes write here as well: files of theirs cannot be noted, and as many as those of a large sweep
    /// should not be.
    shared: bool,
}

impl Folder {
    /// Makes an empty folder.
    pub(super) fn create(root: PathBuf) -> io::Result<Self> {
        fs::create_dir(&root)?;
        Ok(Self {
            itself: Handle::from_path(&root)?,
            state: Mutex::new(State {
                root,
                folders: HashSet::new(),
                files: HashSet::new(),
                shared: false,
            }),
        })
    }

    /// Opens a folder with a store that was left, and clears away what was on its way when its writer died.
    pub(super) fn open(root: &Path) -> io::Result<Self> {
        let mut state = State {
            root: root.to_owned(),
            folders: HashSet::new(),
            files: HashSet::new(),
            shared: false,
        };
        state.take_in(Path::new(""))?;
        Ok(Self {
            itself: Handle::from_path(root)?,
            state: Mutex::new(state),
        })
    }

    /// Opens a folder to read it, whoever writes there: nothing is cleared away.
    pub(super) fn to_read(root: &Path) -> io::Result<Self> {
        Ok(Self {
            itself: Handle::from_path(root)?,
            state: Mutex::new(State {
                root: root.to_owned(),
                folders: HashSet::new(),
                files: HashSet::new(),
                shared: false,
            }),
        })
    }

    /// Opens a folder in which several processes write, each files of its own.
    pub(super) fn shared(root: &Path) -> io::Result<Self> {
        let folder = Self::to_read(root)?;
        folder.state().shared = true;
        Ok(folder)
    }

    /// Clears away what was on its way when a writer died.
    pub(super) fn clear_staged(&self) -> io::Result<()> {
        clear_staged(&self.state().root)
    }

    /// Whether a file is there.
    pub(super) fn holds(&self, key: &StoreKey) -> bool {
        self.path(key).exists()
    }

    /// Removes the chunks of an array whose index along the first dimension is beyond `last`.
    pub(super) fn clear_behind(&self, array: &str, last: u64) -> Result<(), StorageError> {
        let chunks = format!("{array}/c/");
        let behind = |key: &StoreKey| {
            let place = key.as_str().strip_prefix(&chunks)?;
            let index: u64 = place.split('/').next()?.parse().ok()?;
            (index > last).then(|| key.clone())
        };
        let keys: Vec<StoreKey> = self.state().files.iter().filter_map(behind).collect();
        keys.iter().try_for_each(|key| self.erase(key))
    }

    /// Takes note that the folder was moved.
    pub(super) fn moved_to(&self, root: &Path) {
        root.clone_into(&mut self.state().root);
    }

    /// The first file that was written and is not there any more, if any.
    pub(super) fn missing(&self) -> Option<String> {
        let state = self.state();
        if self.is_elsewhere(&state.root) {
            return Some("the result".into());
        }
        let mut files = state.files.iter();
        let missing = files.find(|key| !state.root.join(key.as_str()).exists());
        missing.map(|key| format!("`{key}`"))
    }

    fn is_elsewhere(&self, root: &Path) -> bool {
        Handle::from_path(root).ok().as_ref() != Some(&self.itself)
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        // A name is noted after its file is there: a panic in between spoils nothing.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn path(&self, key: &StoreKey) -> PathBuf {
        self.state().root.join(key.as_str())
    }

    fn write(&self, key: &StoreKey, value: &[u8]) -> io::Result<()> {
        let mut state = self.state();
        if self.is_elsewhere(&state.root) {
            return Err(io::ErrorKind::NotFound.into());
        }
        let within = Path::new(key.as_str()).parent().unwrap_or(Path::new(""));
        let mut folders: Vec<&Path> = within.ancestors().collect();
        folders.pop();
        for folder in folders.into_iter().rev() {
            if !state.folders.contains(folder) {
                match fs::create_dir(state.root.join(folder)) {
                    Err(error) if state.shared && error.kind() == io::ErrorKind::AlreadyExists => {}
                    made => made?,
                }
                state.folders.insert(folder.to_owned());
            }
        }
        let path = state.root.join(key.as_str());
        let staged = format!("{key}{STAGED}{}", std::process::id());
        let staged = state.root.join(staged);
        let written = fs::write(&staged, value).and_then(|()| fs::rename(&staged, &path));
        if written.is_err() {
            // Of the two errors the first says more.
            let _ = fs::remove_file(&staged);
        }
        written?;
        if !state.shared {
            state.files.insert(key.clone());
        }
        Ok(())
    }
}

fn clear_staged(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            clear_staged(&entry.path())?;
        } else if is_staged(&entry.file_name().to_string_lossy()) {
            match fs::remove_file(entry.path()) {
                // A worker that lives on has just put it in place.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                removed => removed?,
            }
        }
    }
    Ok(())
}

fn is_staged(name: &str) -> bool {
    name.contains(STAGED)
}

impl State {
    /// Takes note of what is in a folder, given from the root.
    fn take_in(&mut self, within: &Path) -> io::Result<()> {
        for entry in fs::read_dir(self.root.join(within))? {
            let entry = entry?;
            let place = within.join(entry.file_name());
            let name = place.to_string_lossy();
            if entry.file_type()?.is_dir() {
                self.take_in(&place)?;
                self.folders.insert(place);
            } else if is_staged(&name) {
                fs::remove_file(entry.path())?;
            } else if let Ok(key) = StoreKey::new(name) {
                self.files.insert(key);
            }
        }
        Ok(())
    }
}

impl WritableStorageTraits for Folder {
    fn set(&self, key: &StoreKey, value: Bytes) -> Result<(), StorageError> {
        Ok(self.write(key, &value)?)
    }

    fn set_partial_many(
        &self,
        key: &StoreKey,
        offset_values: OffsetBytesIterator,
    ) -> Result<(), StorageError> {
        store_set_partial_many(self, key, offset_values)
    }

    fn erase(&self, key: &StoreKey) -> Result<(), StorageError> {
        let mut state = self.state();
        let noted = state.files.remove(key) || state.shared;
        drop(state);
        if noted {
            fs::remove_file(self.path(key))?;
        }
        Ok(())
    }

    fn erase_prefix(&self, prefix: &StorePrefix) -> Result<(), StorageError> {
        let files: Vec<StoreKey> = self.state().files.iter().cloned().collect();
        files
            .iter()
            .filter(|key| key.has_prefix(prefix))
            .try_for_each(|key| self.erase(key))
    }

    fn supports_set_partial(&self) -> bool {
        false
    }
}

impl ReadableStorageTraits for Folder {
    fn get(&self, key: &StoreKey) -> Result<MaybeBytes, StorageError> {
        match fs::read(self.path(key)) {
            Ok(bytes) => Ok(Some(bytes.into())),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn get_partial_many<'a>(
        &'a self,
        key: &StoreKey,
        byte_ranges: ByteRangeIterator<'a>,
    ) -> Result<MaybeBytesIterator<'a>, StorageError> {
        let Some(bytes) = self.get(key)? else {
            return Ok(None);
        };
        let parts = extract_byte_ranges(&bytes, byte_ranges)?;
        Ok(Some(Box::new(
            parts.into_iter().map(|part| Ok(part.into())),
        )))
    }

    fn size_key(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        Ok(self.get(key)?.map(|bytes| bytes.len() as u64))
    }

    fn supports_get_partial(&self) -> bool {
        false
    }
}
