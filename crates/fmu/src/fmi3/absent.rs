//! Functions of other interfaces, types and modes: they return an error.

use std::ffi::{c_char, c_int, c_void};

use crate::calls::{make_none, named};
use crate::logger::{Listener, Logger, Logger3};
use crate::pointers::text;
use crate::units::Handle;
use crate::versions::functions;

type Refs = *const u32;

functions! { absent:
    "the unit has no variables of this type": {
        fmi3GetFloat32(Refs, usize, *mut f32, usize);
        fmi3GetInt8(Refs, usize, *mut i8, usize);
        fmi3GetUInt8(Refs, usize, *mut u8, usize);
        fmi3GetInt16(Refs, usize, *mut i16, usize);
        fmi3GetUInt16(Refs, usize, *mut u16, usize);
        fmi3GetInt32(Refs, usize, *mut i32, usize);
        fmi3GetUInt32(Refs, usize, *mut u32, usize);
        fmi3GetUInt64(Refs, usize, *mut u64, usize);
        fmi3GetBoolean(Refs, usize, *mut u8, usize);
        fmi3GetBinary(Refs, usize, *mut usize, *mut *const u8, usize);
        fmi3GetClock(Refs, usize, *mut u8);
        fmi3SetFloat32(Refs, usize, *const f32, usize);
        fmi3SetInt8(Refs, usize, *const i8, usize);
        fmi3SetUInt8(Refs, usize, *const u8, usize);
        fmi3SetInt16(Refs, usize, *const i16, usize);
        fmi3SetUInt16(Refs, usize, *const u16, usize);
        fmi3SetInt32(Refs, usize, *const i32, usize);
        fmi3SetUInt32(Refs, usize, *const u32, usize);
        fmi3SetUInt64(Refs, usize, *const u64, usize);
        fmi3SetBoolean(Refs, usize, *const u8, usize);
        fmi3SetString(Refs, usize, *const *const c_char, usize);
        fmi3SetBinary(Refs, usize, *const usize, *const *const u8, usize);
        fmi3SetClock(Refs, usize, *const u8);
    }
    "the unit has no clocks": {
        fmi3GetIntervalDecimal(Refs, usize, *mut f64, *mut c_int);
        fmi3GetIntervalFraction(Refs, usize, *mut u64, *mut u64, *mut c_int);
        fmi3GetShiftDecimal(Refs, usize, *mut f64);
        fmi3GetShiftFraction(Refs, usize, *mut u64, *mut u64);
        fmi3SetIntervalDecimal(Refs, usize, *const f64);
        fmi3SetIntervalFraction(Refs, usize, *const u64, *const u64);
        fmi3SetShiftDecimal(Refs, usize, *const f64);
        fmi3SetShiftFraction(Refs, usize, *const u64, *const u64);
        fmi3ActivateModelPartition(u32, f64);
    }
    "the unit has no arrays whose entries depend on others": {
        fmi3GetNumberOfVariableDependencies(u32, *mut usize);
        fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize);
    }
    "the unit has no derivatives": {
        fmi3GetDirectionalDerivative(Refs, usize, Refs, usize, *const f64, usize, *mut f64, usize);
        fmi3GetAdjointDerivative(Refs, usize, Refs, usize, *const f64, usize, *mut f64, usize);
        fmi3GetOutputDerivatives(Refs, usize, *const i32, *mut f64, usize);
    }
    "the unit has no structural parameters": {
        fmi3EnterConfigurationMode();
        fmi3ExitConfigurationMode();
    }
    "the unit has no event mode; inputs and parameters are set between two steps": {
        fmi3EnterEventMode();
        fmi3EnterStepMode();
        fmi3EvaluateDiscreteStates();
        fmi3UpdateDiscreteStates(*mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64);
    }
    "the unit has co-simulation only": {
        fmi3EnterContinuousTimeMode();
        fmi3CompletedIntegratorStep(u8, *mut u8, *mut u8);
        fmi3SetTime(f64);
        fmi3SetContinuousStates(*const f64, usize);
        fmi3GetContinuousStateDerivatives(*mut f64, usize);
        fmi3GetEventIndicators(*mut f64, usize);
        fmi3GetContinuousStates(*mut f64, usize);
        fmi3GetNominalsOfContinuousStates(*mut f64, usize);
        fmi3GetNumberOfEventIndicators(*mut usize);
        fmi3GetNumberOfContinuousStates(*mut usize);
    }
}

/// Declares functions that make no instance.
macro_rules! instances {
    ($($name:ident($($unused:ty),*);)*) => {$(
        /// Makes no instance: the unit has co-simulation only.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance_name: *const c_char,
            _instantiation_token: *const c_char,
            _resource_path: *const c_char,
            _visible: u8,
            _logging_on: u8,
            environment: Handle,
            log_message: Option<Logger3>
            $(, _: $unused)*
        ) -> Handle {
            // SAFETY: the caller promises a text, or null.
            let name = named(unsafe { text(instance_name) });
            let logger = Logger::new(Listener::Three(log_message), environment, name, false);
            make_none(stringify!($name), &logger)
        }
    )*};
}

instances! {
    fmi3InstantiateModelExchange();
    fmi3InstantiateScheduledExecution(*mut c_void, *mut c_void, *mut c_void);
}
