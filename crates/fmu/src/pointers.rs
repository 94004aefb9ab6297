//! Arrays and texts of C.

use std::ffi::{CStr, c_char};

use chaindrive_couple::Fault;

fn check<T>(pointer: *const T, count: usize, most: usize) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault("a null pointer where an array is needed".to_owned()));
    }
    if !pointer.is_aligned() {
        return Err(Fault("a pointer that no array of its type has".to_owned()));
    }
    if count > most {
        return Err(Fault(format!(
            "{count} values in one call; there are at most {most}"
        )));
    }
    Ok(())
}

/// An array of C of at most so many entries.
///
/// # Safety
/// A pointer that is not null is valid for `count` reads while the slice lives.
pub(crate) unsafe fn array<'a, T: Copy>(
    pointer: *const T,
    count: usize,
    most: usize,
) -> Result<&'a [T], Fault> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer, count, most)?;
    // SAFETY: not null, aligned, and valid for so many reads by the contract of this function.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Room for values that C reads afterwards.
#[derive(Debug)]
pub(crate) struct Room<T> {
    pointer: *mut T,
    count: usize,
}

impl<T: Copy> Room<T> {
    /// Room for so many values.
    ///
    /// # Safety
    /// A pointer that is not null is valid for `count` writes while the room lives.
    pub(crate) unsafe fn new(pointer: *mut T, count: usize, most: usize) -> Result<Self, Fault> {
        if count > 0 {
            check(pointer, count, most)?;
        }
        Ok(Self { pointer, count })
    }

    /// Writes a value; one past the end is left out.
    pub(crate) fn put(&mut self, index: usize, value: T) {
        if index < self.count {
            // SAFETY: within the room, so that the place is in the same allocation.
            let place = unsafe { self.pointer.add(index) };
            // SAFETY: valid for writes by the contract of `new`.
            unsafe { place.write(value) };
        }
    }
}

/// Writes a value that C may have no use for.
///
/// # Safety
/// A pointer that is not null is valid for a write.
pub(crate) unsafe fn give<T: Copy>(pointer: *mut T, value: T) {
    if !pointer.is_null() && pointer.is_aligned() {
        // SAFETY: not null, aligned, and valid by the contract of this function.
        unsafe { pointer.write(value) };
    }
}

/// A text of C; none of a null pointer.
///
/// # Safety
/// A pointer that is not null leads to a text that ends with a zero byte, and is valid while the text lives.
pub(crate) unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: not null, and a text that ends by the contract of this function.
    Some(unsafe { CStr::from_ptr(pointer) })
}
