//! Files of a store, on whatever ground: a folder, or objects that a network reaches. `zarrs` reads and writes them whole.

use std::collections::BTreeSet;
use std::fmt::Debug;
use std::ops::Deref;
use std::sync::Arc;

use rayon::ThreadPool;
use rayon::prelude::*;
use zarrs::storage::byte_range::{ByteRangeIterator, extract_byte_ranges};
use zarrs::storage::{
    Bytes, MaybeBytes, MaybeBytesIterator, OffsetBytesIterator, ReadableStorageTraits,
    StorageError, StoreKey, StorePrefix, WritableStorageTraits, store_set_partial_many,
};

use super::fault::Fault;

/// New contents of a file, from what it holds; none where it stays as it is.
pub(crate) type Change<'a> = dyn FnMut(Option<Bytes>) -> Result<Option<Bytes>, Fault> + 'a;

/// Files by key, in a folder or a bucket.
pub(crate) trait Files: Debug + Send + Sync {
    /// Contents of a file, if it is there.
    fn read(&self, key: &StoreKey) -> Result<Option<Bytes>, StorageError>;

    /// Bytes of a file, if it is there.
    fn size(&self, key: &StoreKey) -> Result<Option<u64>, StorageError>;

    /// Puts a file in place, whole or not at all.
    fn put(&self, key: &StoreKey, bytes: &[u8]) -> Result<(), StorageError>;

    /// Removes a file, if it is there.
    fn remove(&self, key: &StoreKey) -> Result<(), StorageError>;

    /// Removes all files.
    fn remove_all(&self) -> Result<(), StorageError> {
        let all = self.held("")?;
        all.iter().try_for_each(|key| self.remove(key))
    }

    /// All files whose names begin so; the prefix is empty or ends in a slash.
    fn held(&self, prefix: &str) -> Result<BTreeSet<StoreKey>, StorageError>;

    /// Changes a file that others change as well: nothing that they put there meanwhile is lost. The change may be asked for
    /// more than once.
    fn change(&self, key: &StoreKey, change: &mut Change<'_>) -> Result<(), Fault>;

    /// Whatever was written and is not there any more, if anything.
    fn missing(&self) -> Option<String>;

    /// Threads for requests that wait for an answer longer than it takes to ask; none where there is nothing to wait for.
    fn waiting(&self) -> Option<&ThreadPool>;
}

/// The files as `zarrs` reads and writes them.
#[derive(Debug)]
pub(crate) struct Ground(Arc<dyn Files>);

/// Where arrays write their chunks.
pub(crate) type Storage = Arc<Ground>;

impl Ground {
    pub(crate) fn of(files: Arc<dyn Files>) -> Arc<Self> {
        Arc::new(Self(files))
    }

    /// Acts on all items, several at a time where that saves waiting, and returns the answers in the order of the items.
    ///
    /// # Errors
    /// One of those that came up.
    pub(crate) fn on_each<T: Sync, A: Send>(
        &self,
        items: &[T],
        act: impl Fn(&T) -> Result<A, Fault> + Send + Sync,
    ) -> Result<Vec<A>, Fault> {
        match self.waiting() {
            None => items.iter().map(act).collect(),
            Some(pool) => pool.install(|| items.par_iter().map(act).collect()),
        }
    }
}

impl Deref for Ground {
    type Target = dyn Files;

    fn deref(&self) -> &Self::Target {
        self.0.as_ref()
    }
}

impl ReadableStorageTraits for Ground {
    fn get(&self, key: &StoreKey) -> Result<MaybeBytes, StorageError> {
        self.read(key)
    }

    fn get_partial_many<'a>(
        &'a self,
        key: &StoreKey,
        byte_ranges: ByteRangeIterator<'a>,
    ) -> Result<MaybeBytesIterator<'a>, StorageError> {
        let Some(bytes) = self.read(key)? else {
            return Ok(None);
        };
        let parts = extract_byte_ranges(&bytes, byte_ranges)?;
        Ok(Some(Box::new(
            parts.into_iter().map(|part| Ok(part.into())),
        )))
    }

    fn size_key(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        self.size(key)
    }

    fn supports_get_partial(&self) -> bool {
        false
    }
}

impl WritableStorageTraits for Ground {
    fn set(&self, key: &StoreKey, value: Bytes) -> Result<(), StorageError> {
        self.put(key, &value)
    }

    fn set_partial_many(
        &self,
        key: &StoreKey,
        offset_values: OffsetBytesIterator,
    ) -> Result<(), StorageError> {
        store_set_partial_many(self, key, offset_values)
    }

    fn erase(&self, key: &StoreKey) -> Result<(), StorageError> {
        self.remove(key)
    }

    fn erase_prefix(&self, prefix: &StorePrefix) -> Result<(), StorageError> {
        let keys = self.held(prefix.as_str())?;
        keys.iter().try_for_each(|key| self.remove(key))
    }

    fn supports_set_partial(&self) -> bool {
        false
    }
}
