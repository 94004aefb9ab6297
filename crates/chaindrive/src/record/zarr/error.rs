//! Why results cannot be written.

use std::path::PathBuf;

use zarrs::array::{ArrayCreateError, ArrayError};
use zarrs::group::GroupCreateError;
use zarrs::storage::StorageError;

/// Why a result store could not be made or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum WriteError {
    /// The target holds an earlier result.
    #[error("{}: there is already a result here; choose another name, or ask for it to be replaced", .path.display())]
    Exists { path: PathBuf },

    /// The target holds something that this program did not write and will not remove.
    #[error("{}: {found}; choose another name", .path.display())]
    Foreign { path: PathBuf, found: String },

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

/// What goes wrong below, before the path is known.
#[derive(Debug, thiserror::Error)]
pub(super) enum Fault {
    #[error(transparent)]
    Storage(#[from] StorageError),
    #[error(transparent)]
    Array(#[from] ArrayError),
    #[error(transparent)]
    ArrayCreate(#[from] ArrayCreateError),
    #[error(transparent)]
    GroupCreate(#[from] GroupCreateError),
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}
