//! Errors in a store, before the path is known.

use zarrs::array::{ArrayCreateError, ArrayError};
use zarrs::group::GroupCreateError;
use zarrs::storage::{StorageError, StoreKeyError};

use crate::seal::SealError;

#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    #[error(transparent)]
    Storage(#[from] StorageError),
    #[error(transparent)]
    Key(#[from] StoreKeyError),
    #[error("`{name}` does not hold the samples that the store says it has")]
    Short { name: String },
    #[error(transparent)]
    Array(#[from] ArrayError),
    #[error(transparent)]
    ArrayCreate(#[from] ArrayCreateError),
    #[error(transparent)]
    GroupCreate(#[from] GroupCreateError),
    #[error(transparent)]
    Io(#[from] std::io::Error),
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Seal(#[from] SealError),
}
