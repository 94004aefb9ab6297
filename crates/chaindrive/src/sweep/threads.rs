//! Threads of this process that carry tasks out, one after the other and in their order.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::{self, available_parallelism};
use std::time::Duration;

use super::Go;

/// Wall time between two looks at progress and interrupts while no task ends.
const LOOK: Duration = Duration::from_millis(50);

/// Threads that are started where nobody says how many.
pub(super) fn cores() -> usize {
    available_parallelism().map_or(1, usize::from)
}

/// Carries tasks out on `jobs` threads, as many as there are cores if absent.
///
/// `see` is called on the calling thread with every task that has ended and what came of it, and with nothing every 50 ms. Once it
/// says so no task is begun any more, and `carry_out` finds that it is to stop; what has ended meanwhile is still seen.
///
/// # Errors
/// The system refuses threads.
pub(super) fn on_threads<T: Send>(
    tasks: &[usize],
    jobs: Option<usize>,
    carry_out: impl Fn(usize, &AtomicBool) -> T + Sync,
    mut see: impl FnMut(Option<(usize, T)>) -> Go,
) -> io::Result<Go> {
    let jobs = jobs.unwrap_or_else(cores).clamp(1, tasks.len().max(1));
    let stop = AtomicBool::new(false);
    let next = AtomicUsize::new(0);
    let (sender, receiver) = channel();
    let stopped = || stop.load(Ordering::Relaxed);
    thread::scope(|scope| {
        for _ in 0..jobs {
            let sender = sender.clone();
            let (carry_out, stop, next) = (&carry_out, &stop, &next);
            let work = move || {
                // In their order, so that what is finished early is one stretch.
                while !stop.load(Ordering::Relaxed) {
                    let Some(&task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    if sender.send((task, carry_out(task, stop))).is_err() {
                        break; // whoever sees has panicked
                    }
                }
            };
            if let Err(refused) = thread::Builder::new().spawn_scoped(scope, work) {
                stop.store(true, Ordering::Relaxed);
                return Err(refused);
            }
        }
        drop(sender);
        // Dropped where `see` panics, so that the threads end.
        let receiver = receiver;
        loop {
            let ended = match receiver.recv_timeout(LOOK) {
                Ok(ended) => Some(ended),
                Err(RecvTimeoutError::Timeout) if stopped() => continue,
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            };
            if see(ended) == Go::NoFurther {
                stop.store(true, Ordering::Relaxed);
            }
        }
        Ok(if stopped() { Go::NoFurther } else { Go::On })
    })
}
