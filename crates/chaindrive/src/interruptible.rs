//! Work that nobody can interrupt, without having to wait for its end.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use chaindrive_mechanics::{Assembled, Drive};

use crate::{SimulationError, caught};

/// Wall time between two looks at whoever may want to stop.
pub(crate) const LOOK: Duration = Duration::from_millis(50);

/// Does something on a thread of its own, and gives it up when somebody wants to stop: reading from a pipe, or a chain
/// that settles. The thread is left to itself then. A browser has none: there it is done in place, and nobody interrupts it.
///
/// # Errors
/// [`SimulationError::Interrupted`], or [`SimulationError::Thread`] where the system has none.
pub fn patiently<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    stop: &dyn Fn() -> bool,
) -> Result<T, SimulationError> {
    if cfg!(target_family = "wasm") {
        return Ok(work());
    }
    let (sender, receiver) = channel();
    let begun = std::thread::Builder::new().spawn(move || {
        // Nobody listens any more after an interrupt.
        sender.send(caught(work)).ok();
    });
    begun.map_err(|error| SimulationError::Thread {
        reason: error.to_string(),
    })?;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(fault)) => fault.resume(),
            Err(RecvTimeoutError::Timeout) if stop() => return Err(SimulationError::Interrupted),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Err(SimulationError::Interrupted),
        }
    }
}

/// Assembles a drive on a thread of its own, so that the user need not wait for a chain that settles.
///
/// # Errors
/// [`SimulationError`] when the drive does not assemble, or somebody wants to stop.
pub fn assemble(drive: &Drive, stop: &dyn Fn() -> bool) -> Result<Assembled, SimulationError> {
    let drive = drive.clone();
    Ok(patiently(move || drive.assemble(), stop)??)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Instant;

    #[test]
    fn what_takes_for_ever_is_given_up() {
        let begin = Instant::now();
        let asleep = || std::thread::sleep(Duration::from_mins(1));
        let given_up = patiently(asleep, &|| begin.elapsed() > Duration::from_millis(10));
        assert!(matches!(given_up, Err(SimulationError::Interrupted)));
        assert!(begin.elapsed() < Duration::from_secs(30));
        assert_eq!(patiently(|| 7, &|| false).unwrap(), 7);
    }
}
