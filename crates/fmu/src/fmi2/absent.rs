//! Functions of model exchange, other types and steps behind the importer: they return an error.

use std::ffi::{c_char, c_int, c_uint, c_void};

use crate::versions::functions;

type Refs = *const c_uint;

functions! { absent:
    "the unit has no variables of this type": {
        fmi2GetBoolean(Refs, usize, *mut c_int);
        fmi2SetBoolean(Refs, usize, *const c_int);
        fmi2SetString(Refs, usize, *const *const c_char);
    }
    "the unit has no derivatives": {
        fmi2GetDirectionalDerivative(Refs, usize, Refs, usize, *const f64, *mut f64);
        fmi2GetRealOutputDerivatives(Refs, usize, *const c_int, *mut f64);
    }
    "a step is over when the call returns": {
        fmi2CancelStep();
        fmi2GetStatus(c_int, *mut c_int);
        fmi2GetIntegerStatus(c_int, *mut c_int);
        fmi2GetStringStatus(c_int, *mut *const c_char);
    }
    "the unit has co-simulation only": {
        fmi2EnterEventMode();
        fmi2NewDiscreteStates(*mut c_void);
        fmi2EnterContinuousTimeMode();
        fmi2CompletedIntegratorStep(c_int, *mut c_int, *mut c_int);
        fmi2SetTime(f64);
        fmi2SetContinuousStates(*const f64, usize);
        fmi2GetDerivatives(*mut f64, usize);
        fmi2GetEventIndicators(*mut f64, usize);
        fmi2GetContinuousStates(*mut f64, usize);
        fmi2GetNominalsOfContinuousStates(*mut f64, usize);
    }
}
