//! Why results cannot be written.

use std::path::PathBuf;

/// Why a result could not be begun or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum WriteError {
    /// The target holds an earlier result.
    #[error("{}: there is already a result here; choose another name, or have it replaced: `--overwrite`, in Python `overwrite=True`", .path.display())]
    Exists { path: PathBuf },

    /// The target is a file.
    #[error("{}: there is already a file here; choose another name, or pass --overwrite, in Python `overwrite=True`", .path.display())]
    FileExists { path: PathBuf },

    /// The target holds another sweep than the one that was to go on.
    #[error("{}: there is another sweep here: {difference}; choose another name, or ask for it to be replaced", .path.display())]
    OtherSweep { path: PathBuf, difference: String },

    /// The target holds something that this program did not write and will not remove.
    #[error("{}: {found}; choose another name", .path.display())]
    Foreign { path: PathBuf, found: String },

    /// Somebody writes there.
    #[error("{}: {holder} is writing a result here; stop it or wait for its end, or choose another name", .path.display())]
    Busy { path: PathBuf, holder: String },

    /// The folder of a writer beside the target is of another user, or no folder.
    #[error("{}: {} was made by another user, or is no folder with a lock; remove it, or take it over: `--take-over`, in Python `chaindrive.take_over(path)`", .path.display(), .beside.display())]
    Strange { path: PathBuf, beside: PathBuf },

    /// The disk is too small.
    #[error("{}: the recording takes {gigabytes:.1} GB, more than {free:.1} GB of disk can hold: {samples} samples of {values} values; record fewer channels (`record`) or fewer samples (`every`), or write elsewhere", .path.display())]
    NoRoom {
        path: PathBuf,
        gigabytes: f64,
        free: f64,
        samples: f64,
        values: usize,
    },

    /// The target is a symbolic link to what does not exist.
    #[error("{}: this is a symbolic link to {}, which does not exist; remove the link, or choose another name", .path.display(), .target.display())]
    Dangling { path: PathBuf, target: PathBuf },

    /// The name does not say that it is a store.
    #[error("{}: the name of a Zarr store must end in .zarr", .path.display())]
    Name { path: PathBuf },

    /// Somebody has begun a store in this place of an object store, and it is not laid out yet.
    #[error("{}: somebody has begun a result here and not laid it out yet; wait a little, and where that process has died have the result replaced: `overwrite=True`", .path.display())]
    HalfBegun { path: PathBuf },

    /// The name is the address of an object store.
    #[error("{}: this is an address and no folder; `chaindrive.sweep` in Python writes into object stores, everything else onto a disk", .path.display())]
    Address { path: PathBuf },

    /// Somebody took the result away while it was written.
    #[error("{}: {what} was removed or moved while it was written; nothing more is", .path.display())]
    Vanished { path: PathBuf, what: String },

    /// It was said before why nothing more can be written.
    #[error("{}: nothing more is written after a failure", .path.display())]
    GivenUp { path: PathBuf },

    /// The file system refuses.
    #[error("{}: {source}", .path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },

    /// The store refuses, mostly because the disk is full.
    #[error("{}: {source}", .path.display())]
    Store {
        path: PathBuf,
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl WriteError {
    /// The message for the result itself, which knows where it is.
    pub(crate) fn without_path(&self) -> String {
        let reason = match self {
            Self::Io { source, .. } => source.to_string(),
            Self::Store { source, .. } => source.to_string(),
            Self::Vanished { what, .. } => format!("{what} was removed or moved"),
            other => other.to_string(),
        };
        format!("the result could not be written: {reason}")
    }
}
