//! Many simulations that move at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};

use super::Simulation;
use crate::interruptible::LOOK;
use crate::{SimulationError, caught};

/// Moves simulations on to a time \[s\], on all cores; what came of each, in their order.
///
/// `stop` is asked every 50 ms on the calling thread. Simulations that are stopped stand where they are and can go on from there.
///
/// # Errors
/// Of each simulation, those of [`Simulation::move_to`], and [`SimulationError::Interrupted`].
///
/// # Example
///
/// ```
/// use chaindrive::{Run, Scene, Simulation, step_many};
///
/// let drive = Scene::preset("marine_two_sprockets")?.drive()?;
/// let one = Simulation::start(&drive, &Run::default())?;
/// let mut all = vec![one; 4];
/// let mut moving: Vec<&mut Simulation> = all.iter_mut().collect();
/// for moved in step_many(&mut moving, 1e-3, &|| false) {
///     moved?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn step_many(
    simulations: &mut [&mut Simulation],
    t: f64,
    stop: &dyn Fn() -> bool,
) -> Vec<Result<(), SimulationError>> {
    let stopped = AtomicBool::new(false);
    let (sender, receiver) = channel();
    let mut results: Vec<_> = simulations.iter().map(|_| Ok(())).collect();
    let mut fault = None;
    rayon::in_place_scope(|scope| {
        for (index, simulation) in simulations.iter_mut().enumerate() {
            let (sender, stopped) = (sender.clone(), &stopped);
            scope.spawn(move |_| {
                let stop = || stopped.load(Ordering::Relaxed);
                let moved = caught(|| simulation.move_to(t, &stop));
                // Whoever waits takes all of them.
                let _ = sender.send((index, moved));
            });
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok((index, Ok(moved))) => results[index] = moved,
                Ok((_, Err(found))) => fault = Some(found),
                Err(RecvTimeoutError::Timeout) => {
                    stopped.fetch_or(stop(), Ordering::Relaxed);
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    });
    if let Some(fault) = fault {
        fault.resume();
    }
    results
}
