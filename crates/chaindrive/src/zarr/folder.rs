//! The files of a store: each appears whole or not at all, and none where the store is gone.
//!
//! Folders are made once. A folder or file that was there and is not is an error: somebody removes the
//! store, and to make it anew would leave a torso that looks like a result.

use std::collections::{BTreeSet, HashSet};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rayon::ThreadPool;
use same_file::Handle;
use zarrs::storage::{Bytes, StorageError, StoreKey};

use super::claim::exchanged;
use super::fault::Fault;
use super::files::{Change, Files};
use super::inspect::read_file;
use super::names::STAGED;

/// Largest file of a store \[bytes\]: chunks, documents and checkpoints stay far below.
const LARGEST: u64 = 1 << 30;

/// A folder with a store in the making.
#[derive(Debug)]
pub(crate) struct Folder {
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
    pub(crate) fn create(root: PathBuf) -> io::Result<Self> {
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
    pub(crate) fn open(root: &Path) -> io::Result<Self> {
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
    pub(crate) fn to_read(root: &Path) -> io::Result<Self> {
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
    pub(crate) fn shared(root: &Path) -> io::Result<Self> {
        let folder = Self::to_read(root)?;
        folder.state().shared = true;
        Ok(folder)
    }

    /// Clears away what was on its way when a writer died.
    pub(crate) fn clear_staged(&self) -> io::Result<()> {
        clear_staged(&self.state().root)
    }

    /// Takes note that the folder was moved.
    pub(crate) fn moved_to(&self, root: &Path) {
        root.clone_into(&mut self.state().root);
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
        let known = state.files.contains(key);
        let written = fs::write(&staged, value).and_then(|()| put(&staged, &path, known));
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

/// Puts a file in place, of which a reader finds the old one or the new one.
///
/// A file that is `known` to be there is exchanged and then removed: a move onto it would have some file systems (ext4) write the new one out
/// at once, at every checkpoint once for every array.
fn put(staged: &Path, path: &Path, known: bool) -> io::Result<()> {
    if known && exchanged(staged, path)? {
        return fs::remove_file(staged);
    }
    fs::rename(staged, path)
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
            } else if let Some(key) = key_of(&place) {
                self.files.insert(key);
            }
        }
        Ok(())
    }
}

impl Files for Folder {
    fn read(&self, key: &StoreKey) -> Result<Option<Bytes>, StorageError> {
        Ok(read_file(&self.path(key), LARGEST)?.map(Bytes::from))
    }

    fn size(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        let found = if_there(fs::metadata(self.path(key)))?;
        Ok(found.map(|file| file.len()))
    }

    fn put(&self, key: &StoreKey, bytes: &[u8]) -> Result<(), StorageError> {
        Ok(self.write(key, bytes)?)
    }

    fn remove(&self, key: &StoreKey) -> Result<(), StorageError> {
        let mut state = self.state();
        let noted = state.files.remove(key) || state.shared;
        drop(state);
        if noted {
            if_there(fs::remove_file(self.path(key)))?;
        }
        Ok(())
    }

    fn held(&self, prefix: &str) -> Result<BTreeSet<StoreKey>, StorageError> {
        let root = self.state().root.clone();
        let mut found = BTreeSet::new();
        gather(&root, Path::new(prefix), &mut found)?;
        Ok(found)
    }

    fn change(&self, key: &StoreKey, change: &mut Change<'_>) -> Result<(), Fault> {
        // The system lets go of the lock when the process ends, however it ends.
        let lock = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(self.path(key).with_extension("lock"))?;
        lock.lock()?;
        if let Some(changed) = change(self.read(key)?)? {
            self.write(key, &changed)?;
        }
        Ok(())
    }

    fn missing(&self) -> Option<String> {
        let state = self.state();
        if self.is_elsewhere(&state.root) {
            return Some("the result".into());
        }
        let mut files = state.files.iter();
        let missing = files.find(|key| !state.root.join(key.as_str()).exists());
        missing.map(|key| format!("`{key}`"))
    }

    fn waiting(&self) -> Option<&ThreadPool> {
        None
    }
}

/// The answer of the file system; none where there is no such file.
fn if_there<T>(found: io::Result<T>) -> io::Result<Option<T>> {
    match found {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        found => found.map(Some),
    }
}

/// Key of a file, given from the root: slashes between its parts on every system.
fn key_of(place: &Path) -> Option<StoreKey> {
    let parts: Vec<_> = place.iter().map(|part| part.to_string_lossy()).collect();
    StoreKey::new(parts.join("/")).ok()
}

/// Adds the names of all files in a folder, given from the root, but for those that are on their way.
fn gather(root: &Path, within: &Path, found: &mut BTreeSet<StoreKey>) -> io::Result<()> {
    for entry in if_there(fs::read_dir(root.join(within)))?
        .into_iter()
        .flatten()
    {
        let entry = entry?;
        let place = within.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            gather(root, &place, found)?;
        } else if let (false, Some(key)) = (is_staged(&place.to_string_lossy()), key_of(&place)) {
            found.insert(key);
        }
    }
    Ok(())
}
