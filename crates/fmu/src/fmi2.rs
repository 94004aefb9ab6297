//! FMI 2.0: `fmi2Functions.h`.

#![expect(
    clippy::missing_safety_doc,
    reason = "the standard says what callers promise; what can be checked is"
)]

mod absent;
mod location;

use std::ffi::{c_char, c_int, c_uint};

use chaindrive_couple::{Fault, Instance, Phase};

pub use absent::*;

use crate::calls::{DISCARD, OK, instantiate, make_none, named, on};
use crate::fmi3::{debug_logging, read, write};
use crate::logger::{Listener, Logger, Logger2};
use crate::pointers::{Room, array, give, text};
use crate::states;
use crate::units::{self, Handle};

/// `fmi2CallbackFunctions`; the library keeps its own memory and never works behind the importer.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CallbackFunctions {
    /// Takes messages.
    pub logger: Option<Logger2Function>,
    /// Unused.
    pub allocate_memory: Handle,
    /// Unused.
    pub free_memory: Handle,
    /// Unused.
    pub step_finished: Handle,
    /// Handed back with messages.
    pub environment: Handle,
}

/// A logger of FMI 2.0.
pub type Logger2Function = Logger2;

/// Value of `fmi2CoSimulation`.
const CO_SIMULATION: c_int = 1;

/// Values of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
const TERMINATED: c_int = 3;

/// Platform of the types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Switches messages of calls on and off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    instance: Handle,
    logging_on: c_int,
    n_categories: usize,
    categories: *const *const c_char,
) -> c_int {
    // SAFETY: the caller promises an array of so many texts.
    unsafe {
        debug_logging(
            instance,
            "fmi2SetDebugLogging",
            logging_on != 0,
            n_categories,
            categories,
        )
    }
}

/// Makes an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resource_location: *const c_char,
    functions: *const CallbackFunctions,
    _visible: c_int,
    logging_on: c_int,
) -> Handle {
    let function = "fmi2Instantiate";
    // SAFETY: the caller promises the functions, or null.
    let functions = unsafe { array(functions, 1, 1) };
    let functions = functions.ok().and_then(<[_]>::first);
    // SAFETY: the caller promises texts, or null.
    let [name, guid, location] =
        [instance_name, guid, resource_location].map(|it| unsafe { text(it) });
    let logger = Logger::new(
        Listener::Two(functions.and_then(|it| it.logger)),
        functions.map_or(std::ptr::null_mut(), |it| it.environment),
        named(name),
        logging_on != 0,
    );
    if fmu_type != CO_SIMULATION {
        return make_none(function, &logger);
    }
    let guid = guid.and_then(|it| it.to_str().ok());
    let location = location.and_then(|it| it.to_str().ok());
    let path = location.map(location::path);
    instantiate(function, guid, path.as_deref(), logger)
}

/// Lets an instance go; null is no mistake.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(instance: Handle) {
    if !instance.is_null() && !units::free(instance) {
        eprintln!("fmi2FreeInstance: no instance has this handle; it is freed already");
    }
}

/// Says the start time.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    instance: Handle,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: c_int,
    _stop_time: f64,
) -> c_int {
    on(instance, "fmi2SetupExperiment", |_, instance| {
        instance.start_at(start_time)
    })
}

/// Begins the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(instance: Handle) -> c_int {
    on(instance, "fmi2EnterInitializationMode", |_, instance| {
        instance.enter_initialization(instance.time())
    })
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(instance: Handle) -> c_int {
    on(instance, "fmi2ExitInitializationMode", |_, instance| {
        instance.exit_initialization()
    })
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(instance: Handle) -> c_int {
    on(instance, "fmi2Terminate", |_, instance| {
        instance.terminate()
    })
}

/// Goes back to where the instance was made.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(instance: Handle) -> c_int {
    on(instance, "fmi2Reset", |_, instance| {
        instance.reset();
        Ok(())
    })
}

/// Numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
) -> c_int {
    // SAFETY: the caller promises arrays of this length.
    unsafe {
        read(
            instance,
            "fmi2GetReal",
            (references, count),
            (values, count),
            Instance::real,
        )
    }
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    values: *mut c_int,
) -> c_int {
    let get = |it: &mut Instance, reference| {
        it.choice(reference)
            .map(|it| c_int::try_from(it).unwrap_or(c_int::MAX))
    };
    // SAFETY: the caller promises arrays of this length.
    unsafe {
        read(
            instance,
            "fmi2GetInteger",
            (references, count),
            (values, count),
            get,
        )
    }
}

/// Texts; they live as long as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    values: *mut *const c_char,
) -> c_int {
    let get = |it: &mut Instance, reference| it.text(reference).map(std::ffi::CStr::as_ptr);
    // SAFETY: the caller promises arrays of this length.
    unsafe {
        read(
            instance,
            "fmi2GetString",
            (references, count),
            (values, count),
            get,
        )
    }
}

/// Numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    values: *const f64,
) -> c_int {
    let (to, from) = ((references, count), (values, count));
    // SAFETY: the caller promises arrays of this length.
    unsafe { write(instance, "fmi2SetReal", to, from, Instance::set_real) }
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    values: *const c_int,
) -> c_int {
    let (to, from) = ((references, count), (values, count));
    let set = |it: &mut Instance, reference, value| it.set_choice(reference, i64::from(value));
    // SAFETY: the caller promises arrays of this length.
    unsafe { write(instance, "fmi2SetInteger", to, from, set) }
}

/// Slopes of inputs in the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    instance: Handle,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_int {
    let name = "fmi2SetRealInputDerivatives";
    on(instance, name, |_, instance| {
        let most = instance.model().variables().len();
        // SAFETY: the caller promises arrays of this length.
        let references = unsafe { array(references, count, most) }?;
        // SAFETY: the caller promises arrays of this length.
        let orders = unsafe { array(orders, count, most) }?;
        // SAFETY: the caller promises arrays of this length.
        let values = unsafe { array(values, count, most) }?;
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            if *order != 1 {
                return Err(Fault(format!(
                    "a derivative of order {order}; inputs take the first"
                )));
            }
            instance.set_slope(*reference, *value)?;
        }
        Ok(())
    })
}

/// Keeps the state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetFMUstate(instance: Handle, state: *mut Handle) -> c_int {
    states::get(instance, "fmi2GetFMUstate", state)
}

/// Goes back, or on, to a state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(instance: Handle, state: Handle) -> c_int {
    states::set(instance, "fmi2SetFMUstate", state)
}

/// Lets a state go; null is no mistake.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeFMUstate(instance: Handle, state: *mut Handle) -> c_int {
    states::free(instance, "fmi2FreeFMUstate", state)
}

/// Number of bytes of a state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SerializedFMUstateSize(
    instance: Handle,
    state: Handle,
    size: *mut usize,
) -> c_int {
    states::size(instance, "fmi2SerializedFMUstateSize", state, size)
}

/// A state as bytes, for the same build to read back.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SerializeFMUstate(
    instance: Handle,
    state: Handle,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    states::write(instance, "fmi2SerializeFMUstate", state, bytes, size)
}

/// The state that was written down.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DeSerializeFMUstate(
    instance: Handle,
    bytes: *const u8,
    size: usize,
    state: *mut Handle,
) -> c_int {
    states::read(instance, "fmi2DeSerializeFMUstate", bytes, size, state)
}

/// Moves on by a step.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    instance: Handle,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_state_prior: c_int,
) -> c_int {
    on(instance, "fmi2DoStep", |_, instance| {
        instance.step(current_communication_point, communication_step_size)
    })
}

/// The last time that was reached.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    instance: Handle,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    let mut discarded = false;
    let status = on(instance, "fmi2GetRealStatus", |_, instance| {
        discarded = kind != LAST_SUCCESSFUL_TIME;
        // SAFETY: null is refused; otherwise the caller promises room for a number.
        let mut room = unsafe { Room::new(value, 1, 1) }?;
        if !discarded {
            room.put(0, instance.time());
        }
        Ok(())
    });
    if status == OK && discarded {
        DISCARD
    } else {
        status
    }
}

/// Whether the instance wants to end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    instance: Handle,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    let mut discarded = false;
    let status = on(instance, "fmi2GetBooleanStatus", |_, instance| {
        discarded = kind != TERMINATED;
        if !discarded {
            let ended = instance.phase() == Phase::Failed;
            // SAFETY: the caller promises room for a flag, or null.
            unsafe { give(value, c_int::from(ended)) };
        }
        Ok(())
    });
    if status == OK && discarded {
        DISCARD
    } else {
        status
    }
}
