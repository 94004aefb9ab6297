//! What both versions of the standard have: functions under names of their own, and arrays of values.

use std::ffi::c_char;

use chaindrive_couple::{Fault, Instance};

use crate::pointers::{Room, array, text};
use crate::units::Unit;

/// Declares functions of the C interface.
///
/// ```text
/// alike    those that have the same parameters in both versions, by their names
/// calls    name(parameters) = |unit, instance| what the call does
/// values   read or write, name(pointer, length) = what is done for one reference; without a length there are as many values as references
/// absent   reason: { name(types of the parameters); … } of calls that are refused
/// ```
macro_rules! functions {
    (alike:
        $debug:ident($flag:ty), $free:ident, $exit:ident, $terminate:ident, $reset:ident,
        $keep:ident, $restore:ident, $drop:ident, $size:ident, $serialize:ident, $deserialize:ident
    ) => {
        /// Switches messages of calls on and off.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $debug(
            instance: $crate::units::Handle,
            logging_on: $flag,
            n_categories: usize,
            categories: *const *const std::ffi::c_char,
        ) -> std::ffi::c_int {
            $crate::calls::on(instance, stringify!($debug), |unit, _| {
                // SAFETY: the caller promises an array of so many texts.
                unsafe { $crate::versions::follow(unit, logging_on != 0, n_categories, categories) }
            })
        }

        /// Lets an instance go; null is no mistake.
        #[unsafe(no_mangle)]
        pub extern "C" fn $free(instance: $crate::units::Handle) {
            $crate::calls::free(stringify!($free), instance);
        }

        /// Ends the simulation; a step that goes on is given up.
        #[unsafe(no_mangle)]
        pub extern "C" fn $terminate(instance: $crate::units::Handle) -> std::ffi::c_int {
            $crate::calls::terminate(instance, stringify!($terminate))
        }

        $crate::versions::functions! { calls:
            /// Ends the initialization.
            $exit() = |_, instance| instance.exit_initialization();
            /// Goes back to where the instance was made.
            $reset() = |_, instance| { instance.reset(); Ok(()) };
            /// Keeps the state.
            $keep(state: *mut Handle) = |unit, instance| states::get(unit, instance, state);
            /// Goes back, or on, to a state.
            $restore(state: Handle) = |unit, instance| states::set(unit, instance, state);
            /// Lets a state go; null is no mistake.
            $drop(state: *mut Handle) = |unit, _| states::free(unit, state);
            /// Number of bytes of a state.
            $size(state: Handle, size: *mut usize) = |unit, _| states::size(unit, state, size);
            /// A state as bytes, for the same build to read back.
            $serialize(state: Handle, bytes: *mut u8, size: usize) =
                |unit, _| states::write(unit, state, bytes, size);
            /// The state that was written down.
            $deserialize(bytes: *const u8, size: usize, state: *mut Handle) =
                |unit, _| states::read(unit, bytes, size, state);
        }
    };
    (calls: $($(#[$about:meta])* $name:ident($($given:ident: $type:ty),*) = $act:expr;)*) => {$(
        $(#[$about])*
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(
            instance: $crate::units::Handle $(, $given: $type)*
        ) -> std::ffi::c_int {
            $crate::calls::on(instance, stringify!($name), $act)
        }
    )*};
    (values: $(
        $(#[$about:meta])* $act:ident $name:ident($values:ty $(, $length:ident)?) = $of_one:expr;
    )*) => {$(
        $(#[$about])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: $crate::units::Handle,
            references: *const u32,
            count: usize,
            values: $values
            $(, $length: usize)?
        ) -> std::ffi::c_int {
            // Where only references are counted there are as many values.
            let [.., length] = [count $(, $length)?];
            $crate::calls::on(instance, stringify!($name), |_, instance| {
                let (references, values) = ((references, count), (values, length));
                // SAFETY: the caller promises arrays of these lengths.
                unsafe { $crate::versions::$act(instance, references, values, $of_one) }
            })
        }
    )*};
    (absent: $($reason:literal: { $($name:ident($($type:ty),*);)* })*) => {$($(
        #[doc = $reason]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(
            instance: $crate::units::Handle $(, _: $type)*
        ) -> std::ffi::c_int {
            $crate::calls::refuse(instance, stringify!($name), $reason)
        }
    )*)*};
}

pub(crate) use functions;

/// Switches messages of calls on and off, if they are among the categories or none are named.
///
/// # Safety
/// The categories are an array of so many texts.
pub(crate) unsafe fn follow(
    unit: &Unit,
    follows: bool,
    count: usize,
    categories: *const *const c_char,
) -> Result<(), Fault> {
    // SAFETY: by the contract of this function; there are three categories.
    let categories = unsafe { array(categories, count, 3) }?;
    let among = categories.iter().any(|category| {
        // SAFETY: by the contract of this function.
        unsafe { text(*category) }.is_some_and(|it| it == c"logAll")
    });
    if categories.is_empty() || among {
        unit.logger.follow(follows);
    }
    Ok(())
}

/// Reads values into an array of the importer; the first refusal is told, the others are read all the same.
///
/// # Safety
/// The arrays have so many entries.
pub(crate) unsafe fn read<T: Copy>(
    instance: &mut Instance,
    (references, count): (*const u32, usize),
    (values, room): (*mut T, usize),
    get: impl Fn(&mut Instance, u32) -> Result<T, Fault>,
) -> Result<(), Fault> {
    same_length(count, room)?;
    let most = instance.model().variables().len();
    // SAFETY: by the contract of this function.
    let references = unsafe { array(references, count, most) }?;
    // SAFETY: by the contract of this function.
    let mut values = unsafe { Room::new(values, room, most) }?;
    let mut refused = Ok(());
    for (index, reference) in references.iter().enumerate() {
        match get(instance, *reference) {
            Ok(value) => values.put(index, value),
            Err(fault) => refused = refused.and(Err(fault)),
        }
    }
    refused
}

/// Sets values from an array of the importer; the first refusal is told, the others are set all the same.
///
/// # Safety
/// The arrays have so many entries.
pub(crate) unsafe fn write<T: Copy>(
    instance: &mut Instance,
    (references, count): (*const u32, usize),
    (values, given): (*const T, usize),
    set: impl Fn(&mut Instance, u32, T) -> Result<(), Fault>,
) -> Result<(), Fault> {
    same_length(count, given)?;
    let most = instance.model().variables().len();
    // SAFETY: by the contract of this function.
    let references = unsafe { array(references, count, most) }?;
    // SAFETY: by the contract of this function.
    let values = unsafe { array(values, given, most) }?;
    let mut refused = Ok(());
    for (reference, value) in references.iter().zip(values) {
        refused = refused.and(set(instance, *reference, *value));
    }
    refused
}

fn same_length(references: usize, values: usize) -> Result<(), Fault> {
    if references == values {
        return Ok(());
    }
    let uneven =
        format!("{references} value references and {values} values; every variable has one");
    Err(Fault(uneven))
}
