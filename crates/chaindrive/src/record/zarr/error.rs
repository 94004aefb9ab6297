//! What goes wrong in a store, before the path is known.

use zarrs::array::{ArrayCreateError, ArrayError};
use zarrs::group::GroupCreateError;
use zarrs::storage::StorageError;

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
