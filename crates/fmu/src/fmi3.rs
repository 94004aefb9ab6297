//! FMI 3.0: `fmi3Functions.h`.
//!
//! Functions of other interfaces, types and modes exist, as importers ask for all of them, and return an error.

#![expect(
    clippy::missing_safety_doc,
    reason = "the standard says what callers promise; what can be checked is"
)]

mod absent;

use std::ffi::{CStr, c_char, c_int};
use std::path::Path;

use chaindrive_couple::Instance;

pub use absent::*;

use crate::calls::{instantiate, named};
use crate::logger::{Listener, Logger, Logger3};
use crate::pointers::{give, text};
use crate::states;
use crate::units::Handle;
use crate::versions::functions;

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

functions! { alike:
    fmi3SetDebugLogging(u8), fmi3FreeInstance,
    fmi3ExitInitializationMode, fmi3Terminate, fmi3Reset,
    fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState,
    fmi3SerializedFMUStateSize, fmi3SerializeFMUState, fmi3DeserializeFMUState
}

functions! { calls:
    /// Begins the initialization at a start time.
    fmi3EnterInitializationMode(
        _tolerance_defined: u8, _tolerance: f64, start_time: f64, _stop_time_defined: u8, _stop_time: f64
    ) = |_, instance| instance.enter_initialization(start_time);
}

functions! { values:
    /// Numbers.
    read fmi3GetFloat64(*mut f64, n_values) = Instance::real;
    /// Enumerations.
    read fmi3GetInt64(*mut i64, n_values) = |instance, reference| instance.choice(reference);
    /// Texts; they live as long as the instance.
    read fmi3GetString(*mut *const c_char, n_values) =
        |instance, reference| instance.text(reference).map(CStr::as_ptr);
    /// Numbers.
    write fmi3SetFloat64(*const f64, n_values) = Instance::set_real;
    /// Enumerations.
    write fmi3SetInt64(*const i64, n_values) = Instance::set_choice;
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
    let step = [current_communication_point, communication_step_size];
    crate::calls::step(instance, "fmi3DoStep", step, |instance| {
        for flag in [event_handling_needed, terminate_simulation, early_return] {
            // SAFETY: the caller promises room for a flag, or null.
            unsafe { give(flag, 0) };
        }
        // SAFETY: the caller promises room for a time, or null.
        unsafe { give(last_successful_time, instance.time()) };
    })
}
