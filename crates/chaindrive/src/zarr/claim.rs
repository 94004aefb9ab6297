//! The claim of one writer on a place for a result, and the move that puts a result there.
//!
//! ```text
//! run.zarr            the result
//! .run.zarr.writing/  exists while somebody writes it
//!   lock              held by the writer; the system lets it go when the process ends, however it ends
//!   new               a result in the making, until it takes its place
//!   old               an earlier result, where the file system cannot exchange two names at once
//!   reserve           space given back when the disk is full, for a last word about that
//! ```
//!
//! The next writer clears away the folder of a dead process.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use same_file::Handle;

use super::write_error::WriteError;

/// Times that the lock is tried: readers that ask whether a result is being written hold it for a moment.
const TRIES: u32 = 10;
/// Most that a writer says of itself \[bytes\].
const LONGEST: u64 = 200;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// The right to write a result, for this process alone.
#[derive(Debug)]
pub struct Claim {
    /// As it was asked for, for messages.
    asked: PathBuf,
    /// Where the result is, symbolic links followed.
    place: PathBuf,
    beside: PathBuf,
    /// Unlocked when it is closed, in all processes that have it open.
    lock: File,
    /// The process that made the claim: one that it forks has a copy of this, and no right to write.
    process: u32,
}

impl Claim {
    /// Claims a place; the folder that it lies in must exist.
    ///
    /// # Errors
    /// [`WriteError::Busy`] while another process, or another writer of this one, has the claim;
    /// [`WriteError::Dangling`] for a symbolic link to nowhere; [`WriteError::Io`].
    pub fn take(path: &Path) -> Result<Self, WriteError> {
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        let place = followed(path)?;
        let beside = beside(&place).map_err(io)?;
        let lock = lock(&beside).map_err(|refusal| match refusal {
            Refusal::Io(source) => io(source),
            Refusal::Held(holder) => WriteError::Busy {
                path: path.to_owned(),
                holder,
            },
            Refusal::Strange => WriteError::Strange {
                path: path.to_owned(),
                beside: beside.clone(),
            },
        })?;
        let claim = Self {
            asked: path.to_owned(),
            place,
            beside,
            lock,
            process: std::process::id(),
        };
        claim.clear_up().map_err(io)?;
        Ok(claim)
    }

    /// Number of the open file that holds the lock. A process that is forked must close it, or it keeps the claim alive.
    #[cfg(unix)]
    pub fn descriptor(&self) -> i32 {
        std::os::fd::AsRawFd::as_raw_fd(&self.lock)
    }

    /// Where the result is, symbolic links followed.
    pub fn place(&self) -> &Path {
        &self.place
    }

    /// Path at which a result is made before it takes its place.
    pub fn workshop(&self) -> PathBuf {
        self.beside.join("new")
    }

    /// Puts what was made in the [`workshop`](Self::workshop) in place, and removes what was there.
    ///
    /// Whenever the process dies, the place holds the old result or the new one, each whole. Where the
    /// system cannot exchange two folders, it may hold none: the next writer then puts the old one back.
    ///
    /// # Errors
    /// [`WriteError::Io`]; the old result is still there unless its removal failed.
    pub fn put_in_place(&self) -> Result<(), WriteError> {
        self.exchange().map_err(|source| WriteError::Io {
            path: self.asked.clone(),
            source,
        })
    }

    /// Whether a file that was put in place is still there.
    pub fn holds(&self, file: &File) -> bool {
        let named = Handle::from_path(&self.place).ok();
        let held = file.try_clone().and_then(Handle::from_file).ok();
        named.is_some() && named == held
    }

    fn exchange(&self) -> io::Result<()> {
        let new = self.workshop();
        if new.is_file() || !self.place.exists() {
            return fs::rename(&new, &self.place);
        }
        let replaced = if exchanged(&new, &self.place)? {
            new
        } else {
            let old = self.beside.join("old");
            fs::rename(&self.place, &old)?;
            if let Err(error) = fs::rename(&new, &self.place) {
                fs::rename(&old, &self.place)?;
                return Err(error);
            }
            old
        };
        fs::remove_dir_all(replaced)
    }

    /// Sets space aside for the last words of a result on a disk that is full.
    pub(crate) fn reserve(&self, bytes: usize) -> io::Result<()> {
        fs::write(self.beside.join("reserve"), vec![0x5a; bytes])
    }

    /// Gives the space back.
    pub(crate) fn spend_reserve(&self) {
        // Nothing was set aside when the store was never begun.
        let _ = fs::remove_file(self.beside.join("reserve"));
    }

    /// Removes what a dead process left, and puts back the result that it had moved out of the way.
    fn clear_up(&self) -> io::Result<()> {
        let old = self.beside.join("old");
        let is_result = fs::symlink_metadata(&old).is_ok_and(|about| about.is_dir());
        if is_result && !self.place.exists() {
            fs::rename(&old, &self.place)?;
        }
        for name in ["old", "new", "reserve"] {
            let left = self.beside.join(name);
            // A link is removed, never what it leads to.
            let removed = match fs::symlink_metadata(&left) {
                Ok(about) if about.is_dir() => fs::remove_dir_all(&left),
                Ok(_) => fs::remove_file(&left),
                Err(error) => Err(error),
            };
            match removed {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            return;
        }
        // What cannot be removed now is cleared away by the next writer. The name of the lock goes last:
        // whoever finds another file under it than the one he has locked begins anew.
        let _ = self.clear_up();
        let _ = fs::remove_file(self.beside.join("lock"));
        let _ = fs::remove_dir(&self.beside);
    }
}

/// Removes what lies in the place for the folder of a writer, whoever made it, so that a result can be written there.
///
/// # Errors
/// [`WriteError::Busy`] while a process that lives writes there; [`WriteError::Io`].
pub fn take_over(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let io = |source| WriteError::Io {
        path: path.to_owned(),
        source,
    };
    let beside = beside(&followed(path)?).map_err(io)?;
    let removed = match fs::symlink_metadata(&beside) {
        Ok(about) if about.is_dir() => {
            if is_locked(&beside).map_err(io)? {
                let holder = "another process".to_owned();
                let path = path.to_owned();
                return Err(WriteError::Busy { path, holder });
            }
            fs::remove_dir_all(&beside)
        }
        Ok(_) => fs::remove_file(&beside),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    };
    removed.map_err(io)
}

/// Whether a running process is writing a result at this path.
///
/// A result that says `running`, and that nobody writes, was left by a process that was killed.
///
/// # Errors
/// [`WriteError::Io`] when the lock cannot be looked at.
pub fn is_being_written(path: impl AsRef<Path>) -> Result<bool, WriteError> {
    let path = path.as_ref();
    let io = |source| WriteError::Io {
        path: path.to_owned(),
        source,
    };
    let place = followed(path)?;
    is_locked(&beside(&place).map_err(io)?).map_err(io)
}

fn is_locked(beside: &Path) -> io::Result<bool> {
    let name = beside.join("lock");
    // What is no file is no lock: a link may lead anywhere, and a pipe has no end.
    match fs::symlink_metadata(&name) {
        Ok(about) if about.is_file() => {}
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => return Ok(false),
    }
    let lock = match File::open(name) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        opened => opened?,
    };
    match lock.try_lock_shared() {
        Ok(()) => Ok(false),
        Err(TryLockError::WouldBlock) => Ok(true),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// The path with symbolic links followed; its last part need not exist yet.
fn followed(path: &Path) -> Result<PathBuf, WriteError> {
    let io = |source| WriteError::Io {
        path: path.to_owned(),
        source,
    };
    match fs::canonicalize(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        found => return found.map_err(io),
    }
    if let Ok(target) = fs::read_link(path) {
        return Err(WriteError::Dangling {
            path: path.to_owned(),
            target,
        });
    }
    let name = path
        .file_name()
        .ok_or_else(|| io(io::ErrorKind::InvalidFilename.into()))?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    Ok(fs::canonicalize(folder).map_err(io)?.join(name))
}

fn beside(place: &Path) -> io::Result<PathBuf> {
    let name = place.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(".writing");
    Ok(place.with_file_name(hidden))
}

/// Why there is no lock.
enum Refusal {
    /// Somebody has it.
    Held(String),
    /// It was made by somebody else, or is no folder.
    Strange,
    Io(io::Error),
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn lock(beside: &Path) -> Result<File, Refusal> {
    let path = beside.join("lock");
    let mut held = None;
    for _ in 0..TRIES {
        match fs::create_dir(beside) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error.into()),
            _ => {}
        }
        is_own(beside)?;
        let opened = own_file().open(&path);
        let mut file = match opened {
            // The last writer removed the folder in between.
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            opened => opened?,
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut told = String::new();
                let read = File::open(&path).map(|it| it.take(LONGEST).read_to_string(&mut told));
                held = read.is_ok().then_some(told);
                sleep(BETWEEN_TRIES);
                continue;
            }
            Err(TryLockError::Error(error)) => return Err(error.into()),
        }
        // The last writer may have removed the name of what was opened.
        let Ok(named) = Handle::from_path(&path) else {
            continue;
        };
        if named == Handle::from_file(file.try_clone()?)? {
            file.set_len(0)?;
            file.write_all(format!("process {}", std::process::id()).as_bytes())?;
            return Ok(file);
        }
    }
    let holder = held.filter(|text| !text.is_empty());
    Err(Refusal::Held(
        holder.unwrap_or_else(|| "another process".into()),
    ))
}

/// Opens a lock, wherever no link leads from its name.
fn own_file() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(any(target_os = "linux", target_vendor = "apple"))]
    {
        use std::os::unix::fs::OpenOptionsExt;

        use rustix::fs::OFlags;
        let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
        options.custom_flags(flags.bits().cast_signed());
    }
    options
}

/// Refuses a folder for the writer that is none, that another user made, or whose lock leads elsewhere.
fn is_own(beside: &Path) -> Result<(), Refusal> {
    let about = match fs::symlink_metadata(beside) {
        // The last writer removed it in between.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        about => about?,
    };
    #[cfg(any(target_os = "linux", target_vendor = "apple"))]
    let is_mine =
        std::os::unix::fs::MetadataExt::uid(&about) == rustix::process::geteuid().as_raw();
    #[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
    let is_mine = true;
    let lock = fs::symlink_metadata(beside.join("lock"));
    if about.is_dir() && is_mine && lock.map_or(true, |lock| lock.is_file()) {
        Ok(())
    } else {
        Err(Refusal::Strange)
    }
}

/// Exchanges two names in one move; tells whether the system can.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
pub(super) fn exchanged(one: &Path, other: &Path) -> io::Result<bool> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    match renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE) {
        Ok(()) => Ok(true),
        Err(Errno::INVAL | Errno::NOSYS | Errno::NOTSUP) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
pub(super) fn exchanged(_: &Path, _: &Path) -> io::Result<bool> {
    Ok(false)
}
