//! FMI 2.0: `fmi2Functions.h`.

#![expect(
    clippy::missing_safety_doc,
    reason = "the standard says what callers promise; what can be checked is"
)]

mod absent;
mod location;

use std::ffi::{CStr, c_char, c_int, c_uint};

use chaindrive_couple::{Fault, Instance, Phase};

pub use absent::*;

use crate::calls::{DISCARD, OK, instantiate, make_none, named, on};
use crate::logger::{Listener, Logger, Logger2};
use crate::pointers::{Room, array, give, text};
use crate::states;
use crate::units::Handle;
use crate::versions::functions;

/// `fmi2CallbackFunctions`; the library keeps its own memory and never works behind the importer's back.
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

functions! { alike:
    fmi2SetDebugLogging(c_int), fmi2FreeInstance,
    fmi2ExitInitializationMode, fmi2Terminate, fmi2Reset,
    fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate,
    fmi2SerializedFMUstateSize, fmi2SerializeFMUstate, fmi2DeSerializeFMUstate
}

functions! { calls:
    /// Says the start time.
    fmi2SetupExperiment(
        _tolerance_defined: c_int, _tolerance: f64, start_time: f64, _stop_time_defined: c_int, _stop_time: f64
    ) = |_, instance| instance.start_at(start_time);
    /// Begins the initialization.
    fmi2EnterInitializationMode() = |_, instance| instance.enter_initialization(instance.time());
}

/// Moves on by a step.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    instance: Handle,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_state_prior: c_int,
) -> c_int {
    let step = [current_communication_point, communication_step_size];
    crate::calls::step(instance, "fmi2DoStep", step, |_| {})
}

functions! { values:
    /// Numbers.
    read fmi2GetReal(*mut f64) = Instance::real;
    /// Enumerations.
    read fmi2GetInteger(*mut c_int) = |instance, reference| {
        let choice = instance.choice(reference);
        choice.map(|it| c_int::try_from(it).unwrap_or(c_int::MAX))
    };
    /// Texts; they live as long as the instance.
    read fmi2GetString(*mut *const c_char) =
        |instance, reference| instance.text(reference).map(CStr::as_ptr);
    /// Numbers.
    write fmi2SetReal(*const f64) = Instance::set_real;
    /// Enumerations.
    write fmi2SetInteger(*const c_int) =
        |instance, reference, value| instance.set_choice(reference, i64::from(value));
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

/// The status of a call for a kind of status; of kinds that the unit does not know nothing is told.
fn status_of_kind(known: bool, status: c_int) -> c_int {
    if status == OK && !known {
        DISCARD
    } else {
        status
    }
}

/// The last time that was reached.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    instance: Handle,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    let known = kind == LAST_SUCCESSFUL_TIME;
    let status = on(instance, "fmi2GetRealStatus", |_, instance| {
        // SAFETY: null is refused; otherwise the caller promises room for a number.
        let mut room = unsafe { Room::new(value, 1, 1) }?;
        if known {
            room.put(0, instance.time());
        }
        Ok(())
    });
    status_of_kind(known, status)
}

/// Whether the instance wants to end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    instance: Handle,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    let known = kind == TERMINATED;
    let status = on(instance, "fmi2GetBooleanStatus", |_, instance| {
        if known {
            let ended = instance.phase() == Phase::Failed;
            // SAFETY: the caller promises room for a flag, or null.
            unsafe { give(value, c_int::from(ended)) };
        }
        Ok(())
    });
    status_of_kind(known, status)
}
