//! Zarr stores, on a disk or in an object store: their files, who may write them, what they hold.

mod bucket;
mod claim;
mod fault;
mod files;
mod folder;
mod inspect;
mod names;
mod store;
mod target;
mod track;
mod write_error;

use serde_json::{Map, Value};

use crate::channel::unit_attribute;

pub use bucket::{Object, Objects};
pub use claim::{Claim, is_being_written, take_over};
pub(crate) use fault::Fault;
pub(crate) use files::{Ground, Storage};
pub(crate) use folder::Folder;
pub(crate) use inspect::inspect;
pub(crate) use names::{CHECKPOINT, CHOICES, GROUP, LAYOUT, RECIPE};
pub(crate) use store::Store;
pub(crate) use target::{bucket, group};
pub(crate) use track::{
    StoredArray, Track, ZSTD_LEVEL, metadata, samples_per_chunk, store_chains, store_labels,
    store_metadata,
};
pub use write_error::WriteError;

/// Fate of an earlier result of the same name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and the new one is refused.
    #[default]
    Keep,
    /// It is removed. Anything but a result of this program stays in any case.
    Replace,
}

impl Existing {
    /// Replaced where somebody asked for that.
    pub fn overwriting(overwrite: bool) -> Self {
        if overwrite { Self::Replace } else { Self::Keep }
    }
}

/// Attributes of an array: its unit, and its name in words.
pub(crate) fn about(unit: &str, text: &str) -> Map<String, Value> {
    let entries = [(unit_attribute(unit), unit), ("long_name", text)];
    entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value.into()))
        .collect()
}
