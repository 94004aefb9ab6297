//! The `chaindrive` command: Ctrl-C and the exit code; everything else is in the library.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Blocks that begin where a cache line does: whole registers of states and contacts are then read at once, where the system's
/// allocator leaves it to chance (up to a tenth of a step).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let asked = Arc::new(AtomicBool::new(false));
    let heard = Arc::clone(&asked);
    let installed = ctrlc::set_handler(move || {
        if heard.swap(true, Ordering::Relaxed) {
            // Asked twice: results on disk are whole at any time.
            std::process::exit(chaindrive_cli::INTERRUPTED.into());
        }
    });
    if let Err(error) = installed {
        eprintln!("Ctrl-C will stop the program at once: {error}");
    }
    let interrupted = || asked.load(Ordering::Relaxed);
    ExitCode::from(chaindrive_cli::run(std::env::args_os(), &interrupted))
}
