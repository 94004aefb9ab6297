//! From rest to a steady speed, where torques turn a drive.

use chaindrive_mechanics::{Assembled, EventKinds};

use super::criterion::DRIFT;
use super::refused;
use super::sums::{Sums, add};
use crate::run_in::Onlooker;
use crate::{Run, RunIn, Simulation, SimulationError};

/// Steps of the first stretch, *assumed*: stretches double until they are long enough.
const FIRST: f64 = 512.0;
/// Steps of a run-up at most, *assumed*: after that a time has to be given.
const MOST: f64 = 2e6;
/// Looks a stretch: teeth and orders average out over them.
const LOOKS: u32 = 64;

/// Moves a drive from rest until torques and what resists them have brought it to its speed: in stretches that double the time so far, until the mean
/// speeds of all sprockets over the last are those of the stretch before, to the share that may drift.
pub(super) fn run_up(
    start: &Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<Assembled, SimulationError> {
    let silent = Run {
        run_in: RunIn::None,
        events: EventKinds::default(),
        watched: false,
        ..run.clone()
    };
    let mut moving = Simulation::from_assembled(start.clone(), &silent)?;
    let step = moving.method().step();
    let (mut stretch, longest) = (FIRST * step, MOST * step);
    let stop = || onlooker.stop();
    let mut before = Vec::new();
    while moving.time() < longest {
        let begin = moving.time();
        let mut speeds = Vec::new();
        for look in 1..=LOOKS {
            let time = begin + f64::from(look) / f64::from(LOOKS) * stretch;
            let seen = moving.look(time, &stop)?;
            add(&mut speeds, seen.sprocket_speed.iter().copied());
            onlooker.see_run_in(time / longest);
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        let speeds: Vec<f64> = speeds.iter().map(Sums::mean).collect();
        let is_same = |(now, before): (&f64, &f64)| (now - before).abs() <= DRIFT * now.abs();
        let end = moving.as_start();
        let has_turned = end.slowest_circuit() <= stretch;
        if has_turned && !before.is_empty() && speeds.iter().zip(&before).all(is_same) {
            return Ok(end);
        }
        before = speeds;
        // As long as all before.
        stretch = moving.time();
    }
    Err(refused(
        "no torque brings this drive to a steady speed: give a time",
    ))
}
