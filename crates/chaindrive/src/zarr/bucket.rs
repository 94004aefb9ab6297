//! A store in a bucket of an object store: whole objects by key, and no folders, locks or renaming.
//!
//! Nobody can see there whether a writer lives, so there is no claim. What takes its place:
//!
//! - the object [`IDENTITY`], which only one can be the first to put: who does, begins the store. Who stores a task or tells how far the
//!   sweep is looks first whether it is still his, and leaves a place alone where another store has been begun meanwhile;
//! - changes on condition: the layout is put only where nobody has put another one since it was read;
//! - the group document comes last, when all that it lists is there.

use std::collections::BTreeSet;
use std::fmt;
use std::hash::{BuildHasher, RandomState};
use std::io;
use std::sync::Arc;

use rayon::{ThreadPool, ThreadPoolBuilder};
use zarrs::storage::{Bytes, StorageError, StoreKey};

use super::fault::Fault;
use super::files::{Change, Files};
use super::names::IDENTITY;

/// Begins every identity.
const MARK: &str = "sweep of chaindrive ";

/// Requests at a time: the answer of an object store takes some 10 to 50 ms (assumed), and a task some sixty of them.
const AT_A_TIME: usize = 16;

/// Times that a change is tried; each time somebody else's got through.
const TRIES: usize = 1000;

/// An object with what tells it from others that were put under its key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Object {
    /// Its contents.
    pub bytes: Vec<u8>,
    /// Its entity tag or generation.
    pub tag: String,
}

/// A place in an object store, such as a prefix within a bucket, in which a sweep may have its store.
///
/// Every object is put whole or not at all, and is there for all readers as soon as it was put. Keys have slashes in
/// them and none in front.
pub trait Objects: fmt::Debug + Send + Sync {
    /// Name for messages.
    fn name(&self) -> String;

    /// An object, if it is there.
    ///
    /// # Errors
    /// The store refuses, as in all that follow.
    fn get(&self, key: &str) -> io::Result<Option<Object>>;

    /// Bytes of an object, if it is there.
    ///
    /// # Errors
    /// The store refuses.
    fn size(&self, key: &str) -> io::Result<Option<u64>>;

    /// Puts an object, whatever was there.
    ///
    /// # Errors
    /// The store refuses.
    fn put(&self, key: &str, bytes: &[u8]) -> io::Result<()>;

    /// Puts an object where the one with this tag is still there, or none if absent; tells whether it did.
    ///
    /// # Errors
    /// The store refuses, or knows no conditions.
    fn put_if(&self, key: &str, bytes: &[u8], tag: Option<&str>) -> io::Result<bool>;

    /// Removes objects in their order, as far as they are there.
    ///
    /// # Errors
    /// The store refuses.
    fn erase(&self, keys: &[String]) -> io::Result<()>;

    /// Keys that begin so; the prefix is empty or ends in a slash.
    ///
    /// # Errors
    /// The store refuses.
    fn list(&self, prefix: &str) -> io::Result<Vec<String>>;
}

/// The objects of one store.
#[derive(Debug)]
pub(crate) struct Bucket {
    objects: Arc<dyn Objects>,
    identity: Vec<u8>,
    waiting: ThreadPool,
}

impl Bucket {
    /// The first to begin a store here; none where somebody was before.
    pub(crate) fn begin(objects: &Arc<dyn Objects>) -> io::Result<Option<Self>> {
        // Keys of hashing are drawn by lot.
        let lots = [(); 2].map(|()| RandomState::new().hash_one(std::process::id()));
        let identity = format!("{MARK}{:016x}{:016x}\n", lots[0], lots[1]).into_bytes();
        let mut first = objects.put_if(IDENTITY, &identity, None)?;
        if !first {
            // Where the answer to a first try was lost, a second one finds its own identity.
            let found = objects.get(IDENTITY)?;
            first = found.is_some_and(|object| object.bytes == identity);
        }
        first.then(|| Self::of(objects, identity)).transpose()
    }

    /// Whether this is the identity of a store of this program.
    pub(crate) fn is_identity(bytes: &[u8]) -> bool {
        bytes.starts_with(MARK.as_bytes())
    }

    /// A store that was begun; none where there is none.
    pub(crate) fn open(objects: &Arc<dyn Objects>) -> io::Result<Option<Self>> {
        let identity = objects.get(IDENTITY)?;
        let identity = identity.map(|object| Self::of(objects, object.bytes));
        identity.transpose()
    }

    fn of(objects: &Arc<dyn Objects>, identity: Vec<u8>) -> io::Result<Self> {
        let pool = ThreadPoolBuilder::new().num_threads(AT_A_TIME).build();
        Ok(Self {
            objects: Arc::clone(objects),
            identity,
            waiting: pool.map_err(io::Error::other)?,
        })
    }
}

impl Files for Bucket {
    fn read(&self, key: &StoreKey) -> Result<Option<Bytes>, StorageError> {
        let found = self.objects.get(key.as_str())?;
        Ok(found.map(|object| object.bytes.into()))
    }

    fn size(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        Ok(self.objects.size(key.as_str())?)
    }

    fn put(&self, key: &StoreKey, bytes: &[u8]) -> Result<(), StorageError> {
        Ok(self.objects.put(key.as_str(), bytes)?)
    }

    fn remove(&self, key: &StoreKey) -> Result<(), StorageError> {
        Ok(self.objects.erase(&[key.to_string()])?)
    }

    fn held(&self, prefix: &str) -> Result<BTreeSet<StoreKey>, StorageError> {
        let keys = self.objects.list(prefix)?.into_iter().map(StoreKey::new);
        keys.collect::<Result<_, _>>()
            .map_err(|error| StorageError::Other(error.to_string()))
    }

    fn change(&self, key: &StoreKey, change: &mut Change<'_>) -> Result<(), Fault> {
        for _ in 0..TRIES {
            let found = self.objects.get(key.as_str())?;
            let (bytes, tag) = found.map_or((None, None), |it| (Some(it.bytes), Some(it.tag)));
            let Some(changed) = change(bytes.map(Bytes::from))? else {
                return Ok(());
            };
            if self
                .objects
                .put_if(key.as_str(), &changed, tag.as_deref())?
            {
                return Ok(());
            }
        }
        let message = format!("`{key}` was changed by others {TRIES} times in a row");
        Err(io::Error::other(message).into())
    }

    fn missing(&self) -> Option<String> {
        match self.objects.get(IDENTITY) {
            Ok(Some(object)) if object.bytes == self.identity => None,
            Ok(_) => Some("the result".into()),
            // Whether it is there shows when it answers again.
            Err(_) => None,
        }
    }

    fn waiting(&self) -> Option<&ThreadPool> {
        Some(&self.waiting)
    }
}
