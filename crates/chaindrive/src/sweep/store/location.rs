//! Location of the store of a sweep.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::zarr::{GROUP, Objects, WriteError};

/// A place for the store of a sweep.
#[derive(Clone, Debug)]
pub enum StoreLocation {
    /// A path on a disk.
    Disk(PathBuf),
    /// A place in an object store.
    Objects(Arc<dyn Objects>),
}

impl StoreLocation {
    /// Whether something is there.
    pub(super) fn is_taken(&self) -> Result<bool, WriteError> {
        match self {
            Self::Disk(path) => Ok(path.symlink_metadata().is_ok()),
            Self::Objects(objects) => match objects.size(GROUP) {
                Ok(found) => Ok(found.is_some()),
                Err(source) => Err(WriteError::Io {
                    path: objects.name().into(),
                    source,
                }),
            },
        }
    }
}

impl From<&Path> for StoreLocation {
    fn from(path: &Path) -> Self {
        Self::Disk(path.to_owned())
    }
}

impl From<&Arc<dyn Objects>> for StoreLocation {
    fn from(objects: &Arc<dyn Objects>) -> Self {
        Self::Objects(Arc::clone(objects))
    }
}
