//! The `chaindrive` command: signals and the exit code; everything else is in the library.

use std::io;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use chaindrive_cli::INTERRUPTED;
use signal_hook::consts::signal;
use signal_hook::flag;

/// Blocks that begin where a cache line does: whole registers of states and contacts are then read at once, where the system's
/// allocator leaves it to chance (up to a tenth of a step).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let asked = Arc::new(AtomicBool::new(false));
    for number in stopping() {
        if let Err(error) = listen(number, &asked) {
            eprintln!("signal {number} will stop the program at once: {error}");
        }
    }
    let interrupted = || asked.load(Ordering::Relaxed);
    ExitCode::from(chaindrive_cli::run(std::env::args_os(), &interrupted))
}

/// Asked twice, the program stops at once: what is on disk says truly what it is at any time.
fn listen(number: i32, asked: &Arc<AtomicBool>) -> io::Result<()> {
    // In the order of registration: the first signal passes this by and sets the flag.
    flag::register_conditional_shutdown(number, INTERRUPTED.into(), Arc::clone(asked))?;
    flag::register(number, Arc::clone(asked)).map(drop)
}

/// The signals that stop a run and keep what there is.
#[cfg(unix)]
fn stopping() -> Vec<i32> {
    let mut signals = vec![signal::SIGINT, signal::SIGTERM];
    // `nohup` has the end of the terminal ignored, and that is to stay.
    if !ignores(signal::SIGHUP) {
        signals.push(signal::SIGHUP);
    }
    signals
}

#[cfg(not(unix))]
fn stopping() -> Vec<i32> {
    vec![signal::SIGINT, signal::SIGTERM]
}

/// Whether a signal is ignored, where the system writes that down.
#[cfg(unix)]
fn ignores(number: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (number - 1) & 1 == 1)
}
