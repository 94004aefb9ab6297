//! States that importers keep: in memory by numbers, and as bytes.
//!
//! ```text
//! "chdrive\n"   length of all, 8 bytes from the least on   the state, as a sealed value
//! ```

use std::sync::{Arc, MutexGuard, PoisonError};

use chaindrive_couple::{Fault, Instance, SavedInstance};

use crate::pointers::{Room, array, give};
use crate::units::{Handle, Unit, handle, number};

const MARK: [u8; 8] = *b"chdrive\n";

/// Bytes before the state.
const HEADING: usize = 16;

/// Most bytes of a state.
const MOST: usize = 1 << 32;

type States<'a> = MutexGuard<'a, std::collections::HashMap<usize, Arc<SavedInstance>>>;

fn states(unit: &Unit) -> States<'_> {
    unit.states.lock().unwrap_or_else(PoisonError::into_inner)
}

fn known(unit: &Unit, state: Handle) -> Result<Arc<SavedInstance>, Fault> {
    let found = states(unit).get(&state.addr()).cloned();
    found
        .ok_or_else(|| Fault("no state has this handle; it was never kept, or is freed".to_owned()))
}

fn bytes(saved: &SavedInstance) -> Vec<u8> {
    let content = saved.to_bytes();
    let length = (HEADING + content.len()) as u64;
    [&MARK[..], &length.to_le_bytes(), &content].concat()
}

/// Keeps a state under the handle that is there, or a new one.
fn put(unit: &Unit, place: *mut Handle, saved: SavedInstance) -> Result<(), Fault> {
    // SAFETY: null is refused; otherwise the standard has a handle there.
    let there = unsafe { array(place.cast_const(), 1, 1) }?;
    let mut states = states(unit);
    let number = match there[0].addr() {
        0 => number(),
        kept if states.contains_key(&kept) => kept,
        _ => {
            let foreign = "the handle is neither null nor that of a state; set it to null";
            return Err(Fault(foreign.to_owned()));
        }
    };
    states.insert(number, Arc::new(saved));
    // SAFETY: it was read above, and the standard lets it be written.
    unsafe { give(place, handle(number)) };
    Ok(())
}

pub(crate) fn get(unit: &Unit, instance: &mut Instance, place: *mut Handle) -> Result<(), Fault> {
    put(unit, place, instance.save()?)
}

pub(crate) fn set(unit: &Unit, instance: &mut Instance, state: Handle) -> Result<(), Fault> {
    instance.restore(known(unit, state)?.as_ref())
}

pub(crate) fn free(unit: &Unit, place: *mut Handle) -> Result<(), Fault> {
    if place.is_null() {
        return Ok(());
    }
    // SAFETY: not null, and the standard has a handle there.
    let there = unsafe { array(place.cast_const(), 1, 1) }?[0];
    if there.is_null() {
        return Ok(());
    }
    known(unit, there)?;
    states(unit).remove(&there.addr());
    // SAFETY: it was read above, and the standard lets it be written.
    unsafe { give(place, std::ptr::null_mut()) };
    Ok(())
}

pub(crate) fn size(unit: &Unit, state: Handle, size: *mut usize) -> Result<(), Fault> {
    let bytes = bytes(known(unit, state)?.as_ref());
    // SAFETY: null is refused; otherwise the standard has room for a length there.
    unsafe { Room::new(size, 1, 1) }?.put(0, bytes.len());
    Ok(())
}

pub(crate) fn write(unit: &Unit, state: Handle, room: *mut u8, size: usize) -> Result<(), Fault> {
    let bytes = bytes(known(unit, state)?.as_ref());
    if size != bytes.len() {
        let needed = bytes.len();
        return Err(Fault(format!(
            "room for {size} bytes; the state has {needed}"
        )));
    }
    // SAFETY: null is refused; otherwise the importer says that so many bytes are there.
    let mut room = unsafe { Room::new(room, size, MOST) }?;
    for (index, byte) in bytes.into_iter().enumerate() {
        room.put(index, byte);
    }
    Ok(())
}

pub(crate) fn read(
    unit: &Unit,
    bytes: *const u8,
    size: usize,
    place: *mut Handle,
) -> Result<(), Fault> {
    let foreign = || Fault("the bytes are no state of a unit".to_owned());
    if size < HEADING {
        return Err(foreign());
    }
    // SAFETY: null is refused; the importer says that more bytes than these are there.
    let heading = unsafe { array(bytes, HEADING, HEADING) }?;
    let (mark, length) = heading.split_at(MARK.len());
    let length = length.iter().rev();
    let length = length.fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
    if mark != MARK || usize::try_from(length) != Ok(size) {
        return Err(foreign());
    }
    // SAFETY: as above; the heading says the same length.
    let whole = unsafe { array(bytes, size, MOST) }?;
    let saved =
        SavedInstance::from_bytes(&whole[HEADING..]).map_err(|error| Fault(error.to_string()))?;
    put(unit, place, saved)
}
