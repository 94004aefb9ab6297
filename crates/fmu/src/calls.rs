//! Calls: numbers looked up, panics caught, refusals told.

use std::ffi::{CString, c_int};
use std::path::Path;
use std::sync::TryLockError;
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use chaindrive_couple::{Fault, Instance, Model, caught};

use crate::logger::Logger;
use crate::units::{Handle, Unit, find, keep};

/// Status of a call, the same numbers in both versions of the standard.
pub(crate) const OK: c_int = 0;
/// The call was made, and something is to be known about it.
pub(crate) const WARNING: c_int = 1;
/// The call was made, and did not do all.
pub(crate) const DISCARD: c_int = 2;
/// The call was refused.
pub(crate) const ERROR: c_int = 3;
/// The instance is lost.
pub(crate) const FATAL: c_int = 4;

/// Category of warnings, of refusals, and of calls that were made.
const WARNED: &str = "logStatusWarning";
const REFUSED: &str = "logStatusError";
const CALLED: &str = "logAll";

/// Wall time for which a step is waited for that is to be given up, and between two looks at it. A step looks every 50 ms.
const PATIENCE: Duration = Duration::from_secs(5);
const LOOK: Duration = Duration::from_millis(5);

/// Makes a call on an instance.
pub(crate) fn on(
    handle: Handle,
    function: &str,
    act: impl FnOnce(&Unit, &mut Instance) -> Result<(), Fault>,
) -> c_int {
    warned(handle, function, |unit, instance| {
        act(unit, instance).map(|()| None)
    })
}

/// Moves an instance on; [`terminate`] gives it up.
pub(crate) fn step(
    handle: Handle,
    function: &str,
    [from, length]: [f64; 2],
    then: impl FnOnce(&Instance),
) -> c_int {
    warned(handle, function, |unit, instance| {
        unit.gives_up.store(false, Ordering::Relaxed);
        let stop = || unit.gives_up.load(Ordering::Relaxed);
        let stepped = instance.step_until(from, length, &stop);
        then(instance);
        stepped
    })
}

/// Ends the simulation. A step that another thread waits for is given up first.
pub(crate) fn terminate(handle: Handle, function: &str) -> c_int {
    if let Some(unit) = find(handle) {
        let begin = Instant::now();
        while matches!(unit.instance.try_lock(), Err(TryLockError::WouldBlock))
            && begin.elapsed() < PATIENCE
        {
            unit.gives_up.store(true, Ordering::Relaxed);
            sleep(LOOK);
        }
    }
    on(handle, function, |_, instance| instance.terminate())
}

/// Makes a call that may have something to be known about.
fn warned(
    handle: Handle,
    function: &str,
    act: impl FnOnce(&Unit, &mut Instance) -> Result<Option<String>, Fault>,
) -> c_int {
    let Some(unit) = find(handle) else {
        // There is nobody else to tell it to.
        eprintln!("{function}: no instance has this handle; it was never made, or is freed");
        return ERROR;
    };
    let made = caught(|| match unit.instance.try_lock() {
        Ok(mut instance) => act(&unit, &mut instance).map_err(|fault| (ERROR, fault.0)),
        Err(TryLockError::WouldBlock) => {
            let busy = "another thread is in a call of this instance";
            Err((ERROR, busy.to_owned()))
        }
        Err(TryLockError::Poisoned(_)) => {
            let lost = "the instance was lost in a call before; free it";
            Err((FATAL, lost.to_owned()))
        }
    });
    let (status, message) = match made {
        Ok(Ok(Some(warning))) => {
            unit.logger
                .tell(WARNING, WARNED, &format!("{function}: {warning}"));
            return WARNING;
        }
        Ok(Ok(None)) => {
            if unit.logger.follows() {
                unit.logger.tell(OK, CALLED, function);
            }
            return OK;
        }
        Ok(Err(refused)) => refused,
        Err(fault) => (FATAL, fault.to_string()),
    };
    // The instance is free again: an importer may call it from its logger.
    unit.logger
        .tell(status, REFUSED, &format!("{function}: {message}"));
    status
}

/// Refuses a call that co-simulation has no use for.
pub(crate) fn refuse(handle: Handle, function: &str, reason: &str) -> c_int {
    on(handle, function, |_, _| Err(Fault(reason.to_owned())))
}

/// Makes an instance of the unit whose resources lie in a folder; null where there is none.
pub(crate) fn instantiate(
    function: &str,
    token: Option<&str>,
    resources: Option<&Path>,
    logger: Logger,
) -> Handle {
    let made = caught(|| {
        let resources = resources.ok_or("the folder of the resources is missing")?;
        let token = token.ok_or("the token of modelDescription.xml is missing")?;
        let model = Model::of_resources(resources).map_err(|error| error.to_string())?;
        let token = token.trim_matches(['{', '}']);
        if token != model.token() {
            let own = model.token();
            return Err(format!(
                "the token {token} is of another unit; this one has {own}"
            ));
        }
        Ok(Instance::new(model))
    });
    let message = match made {
        Ok(Ok(instance)) => return keep(instance, logger),
        Ok(Err(reason)) => reason,
        Err(fault) => fault.to_string(),
    };
    logger.tell(ERROR, REFUSED, &format!("{function}: {message}"));
    std::ptr::null_mut()
}

/// Refuses to make an instance of another kind.
pub(crate) fn make_none(function: &str, logger: &Logger) -> Handle {
    let reason = "the unit has co-simulation only";
    logger.tell(ERROR, REFUSED, &format!("{function}: {reason}"));
    std::ptr::null_mut()
}

/// Name of an instance in messages.
pub(crate) fn named(name: Option<&std::ffi::CStr>) -> CString {
    name.unwrap_or(c"drive").to_owned()
}

/// Lets an instance go.
pub(crate) fn free(function: &str, handle: Handle) {
    if handle.is_null() {
        return;
    }
    match caught(|| crate::units::free(handle)) {
        Ok(true) => {}
        Ok(false) => {
            eprintln!("{function}: no instance has this handle; it is freed already");
        }
        Err(fault) => eprintln!("{function}: {fault}"),
    }
}
