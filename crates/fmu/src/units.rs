//! Instances by the numbers that importers hold.

use std::collections::HashMap;
use std::ffi::c_void;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use chaindrive_couple::{Instance, SavedInstance};

use crate::logger::Logger;

/// What C takes for a pointer: a number, never followed.
pub(crate) type Handle = *mut c_void;

/// An instance and what belongs to it.
#[derive(Debug)]
pub(crate) struct Unit {
    pub(crate) instance: Mutex<Instance>,
    pub(crate) logger: Logger,
    /// States that the importer keeps.
    pub(crate) states: Mutex<HashMap<usize, Arc<SavedInstance>>>,
    /// Whether the step that goes on is to be given up.
    pub(crate) gives_up: AtomicBool,
}

static UNITS: RwLock<Option<HashMap<usize, Arc<Unit>>>> = RwLock::new(None);

/// The next number. None is given out twice, so that a freed one is known as such.
static NEXT: AtomicUsize = AtomicUsize::new(1);

/// A number that nobody has, aligned as a pointer would be.
pub(crate) fn number() -> usize {
    NEXT.fetch_add(1, Ordering::Relaxed) << 4
}

/// The number as C takes it.
pub(crate) fn handle(number: usize) -> Handle {
    std::ptr::without_provenance_mut(number)
}

/// Keeps an instance.
pub(crate) fn keep(instance: Instance, logger: Logger) -> Handle {
    let number = number();
    let unit = Unit {
        instance: Mutex::new(instance),
        logger,
        states: Mutex::default(),
        gives_up: AtomicBool::new(false),
    };
    let mut units = UNITS.write().unwrap_or_else(PoisonError::into_inner);
    units.get_or_insert_default().insert(number, Arc::new(unit));
    handle(number)
}

/// The instance of a number, if there is one.
pub(crate) fn find(handle: Handle) -> Option<Arc<Unit>> {
    let units = UNITS.read().unwrap_or_else(PoisonError::into_inner);
    units.as_ref()?.get(&handle.addr()).cloned()
}

/// Lets an instance go; tells whether there was one.
pub(crate) fn free(handle: Handle) -> bool {
    let mut units = UNITS.write().unwrap_or_else(PoisonError::into_inner);
    let freed = units
        .as_mut()
        .and_then(|units| units.remove(&handle.addr()));
    drop(units);
    freed.is_some()
}
