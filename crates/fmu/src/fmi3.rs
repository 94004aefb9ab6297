//! FMI 3.0: `fmi3Functions.h`.
//!
//! Functions of other interfaces, types and modes exist, as importers ask for all of them, and return an error.

#![expect(
    clippy::missing_safety_doc,
    reason = "the standard says what callers promise; what can be checked is"
)]

mod absent;

use std::ffi::{c_char, c_int};
use std::path::Path;

use chaindrive_couple::{Fault, Instance};

pub use absent::*;

use crate::calls::{instantiate, named, on};
use crate::logger::{Listener, Logger, Logger3};
use crate::pointers::{Room, array, give, text};
use crate::states;
use crate::units::{self, Handle};

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Switches messages of calls on and off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Handle,
    logging_on: u8,
    n_categories: usize,
    categories: *const *const c_char,
) -> c_int {
    // SAFETY: the caller promises an array of so many texts.
    unsafe {
        debug_logging(
            instance,
            "fmi3SetDebugLogging",
            logging_on != 0,
            n_categories,
            categories,
        )
    }
}

/// Switches messages of calls on and off, if they are among the categories or none are named.
///
/// # Safety
/// The categories are an array of so many texts.
pub(crate) unsafe fn debug_logging(
    instance: Handle,
    name: &str,
    follows: bool,
    count: usize,
    categories: *const *const c_char,
) -> c_int {
    on(instance, name, |unit, _| {
        // SAFETY: by the contract of this function; there are two categories.
        let categories = unsafe { array(categories, count, 2) }?;
        let among = categories.iter().any(|category| {
            // SAFETY: by the contract of this function.
            unsafe { text(*category) }.is_some_and(|it| it == c"logAll")
        });
        if categories.is_empty() || among {
            unit.logger.follow(follows);
        }
        Ok(())
    })
}

/// Makes an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: u8,
    logging_on: u8,
    _event_mode_used: u8,
    _early_return_allowed: u8,
    _required_intermediate_variables: *const u32,
    _n_required_intermediate_variables: usize,
    environment: Handle,
    log_message: Option<Logger3>,
    _intermediate_update: Handle,
) -> Handle {
    // SAFETY: the caller promises texts, or null.
    let [name, token, path] =
        [instance_name, instantiation_token, resource_path].map(|it| unsafe { text(it) });
    let listener = Listener::Three(log_message);
    let logger = Logger::new(listener, environment, named(name), logging_on != 0);
    let token = token.and_then(|it| it.to_str().ok());
    let path = path.and_then(|it| it.to_str().ok()).map(Path::new);
    instantiate("fmi3InstantiateCoSimulation", token, path, logger)
}

/// Lets an instance go; null is no mistake.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Handle) {
    if !instance.is_null() && !units::free(instance) {
        eprintln!("fmi3FreeInstance: no instance has this handle; it is freed already");
    }
}

/// Begins the initialization at a start time.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: Handle,
    _tolerance_defined: u8,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: u8,
    _stop_time: f64,
) -> c_int {
    on(instance, "fmi3EnterInitializationMode", |_, instance| {
        instance.enter_initialization(start_time)
    })
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitInitializationMode(instance: Handle) -> c_int {
    on(instance, "fmi3ExitInitializationMode", |_, instance| {
        instance.exit_initialization()
    })
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(instance: Handle) -> c_int {
    on(instance, "fmi3Terminate", |_, instance| {
        instance.terminate()
    })
}

/// Goes back to where the instance was made.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(instance: Handle) -> c_int {
    on(instance, "fmi3Reset", |_, instance| {
        instance.reset();
        Ok(())
    })
}

/// Reads values into an array of the importer; the first refusal is told, the others are read all the same.
///
/// # Safety
/// The arrays have so many entries.
pub(crate) unsafe fn read<T: Copy>(
    handle: Handle,
    name: &str,
    (references, count): (*const u32, usize),
    (values, room): (*mut T, usize),
    get: impl Fn(&mut Instance, u32) -> Result<T, Fault>,
) -> c_int {
    on(handle, name, |_, instance| {
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
    })
}

/// Sets values from an array of the importer; the first refusal is told, the others are set all the same.
///
/// # Safety
/// The arrays have so many entries.
pub(crate) unsafe fn write<T: Copy>(
    handle: Handle,
    name: &str,
    (references, count): (*const u32, usize),
    (values, given): (*const T, usize),
    set: impl Fn(&mut Instance, u32, T) -> Result<(), Fault>,
) -> c_int {
    on(handle, name, |_, instance| {
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
    })
}

fn same_length(references: usize, values: usize) -> Result<(), Fault> {
    if references == values {
        return Ok(());
    }
    let uneven =
        format!("{references} value references and {values} values; every variable has one");
    Err(Fault(uneven))
}

/// Numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: Handle,
    references: *const u32,
    n_references: usize,
    values: *mut f64,
    n_values: usize,
) -> c_int {
    let (from, to) = ((references, n_references), (values, n_values));
    // SAFETY: the caller promises arrays of these lengths.
    unsafe { read(instance, "fmi3GetFloat64", from, to, Instance::real) }
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: Handle,
    references: *const u32,
    n_references: usize,
    values: *mut i64,
    n_values: usize,
) -> c_int {
    let (from, to) = ((references, n_references), (values, n_values));
    // SAFETY: the caller promises arrays of these lengths.
    unsafe {
        read(instance, "fmi3GetInt64", from, to, |it, reference| {
            it.choice(reference)
        })
    }
}

/// Texts; they live as long as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    instance: Handle,
    references: *const u32,
    n_references: usize,
    values: *mut *const c_char,
    n_values: usize,
) -> c_int {
    let (from, to) = ((references, n_references), (values, n_values));
    let get = |it: &mut Instance, reference| it.text(reference).map(std::ffi::CStr::as_ptr);
    // SAFETY: the caller promises arrays of these lengths.
    unsafe { read(instance, "fmi3GetString", from, to, get) }
}

/// Numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: Handle,
    references: *const u32,
    n_references: usize,
    values: *const f64,
    n_values: usize,
) -> c_int {
    let (to, from) = ((references, n_references), (values, n_values));
    // SAFETY: the caller promises arrays of these lengths.
    unsafe { write(instance, "fmi3SetFloat64", to, from, Instance::set_real) }
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: Handle,
    references: *const u32,
    n_references: usize,
    values: *const i64,
    n_values: usize,
) -> c_int {
    let (to, from) = ((references, n_references), (values, n_values));
    // SAFETY: the caller promises arrays of these lengths.
    unsafe { write(instance, "fmi3SetInt64", to, from, Instance::set_choice) }
}

/// Keeps the state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetFMUState(instance: Handle, state: *mut Handle) -> c_int {
    states::get(instance, "fmi3GetFMUState", state)
}

/// Goes back, or on, to a state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetFMUState(instance: Handle, state: Handle) -> c_int {
    states::set(instance, "fmi3SetFMUState", state)
}

/// Lets a state go; null is no mistake.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeFMUState(instance: Handle, state: *mut Handle) -> c_int {
    states::free(instance, "fmi3FreeFMUState", state)
}

/// Number of bytes of a state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SerializedFMUStateSize(
    instance: Handle,
    state: Handle,
    size: *mut usize,
) -> c_int {
    states::size(instance, "fmi3SerializedFMUStateSize", state, size)
}

/// A state as bytes, for the same build to read back.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SerializeFMUState(
    instance: Handle,
    state: Handle,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    states::write(instance, "fmi3SerializeFMUState", state, bytes, size)
}

/// The state that was written down.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3DeserializeFMUState(
    instance: Handle,
    bytes: *const u8,
    size: usize,
    state: *mut Handle,
) -> c_int {
    states::read(instance, "fmi3DeserializeFMUState", bytes, size, state)
}

/// Moves on by a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Handle,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_state_prior: u8,
    event_handling_needed: *mut u8,
    terminate_simulation: *mut u8,
    early_return: *mut u8,
    last_successful_time: *mut f64,
) -> c_int {
    on(instance, "fmi3DoStep", |_, instance| {
        let stepped = instance.step(current_communication_point, communication_step_size);
        for flag in [event_handling_needed, terminate_simulation, early_return] {
            // SAFETY: the caller promises room for a flag, or null.
            unsafe { give(flag, 0) };
        }
        // SAFETY: the caller promises room for a time, or null.
        unsafe { give(last_successful_time, instance.time()) };
        stepped
    })
}
