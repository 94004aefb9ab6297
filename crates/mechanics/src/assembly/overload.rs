//! Pulls that torques ask of chains. They are named where no equilibrium was found, and before the search where there can be none.

use chaindrive_integrate::Moment;

use super::free_trains::Torques;
use super::start_velocities::spread;
use crate::bodies::TurnedBy;
use crate::drive::{Layout, Parts, Stop};
use crate::system::System;
use crate::{AssemblyError, Pull};

/// Pull \[–\], in breaking loads, beyond which no equilibrium is looked for. *Assumed*: no design errs by so much, and the statics finds after
/// hundreds of iterations that such a chain leaves its teeth.
const HOPELESS: f64 = 10.0;

/// Sum of pulls over the largest one \[–\] beyond which the sum is told. *Assumed*: less is rounding.
const ADDED: f64 = 1.001;

/// Refuses a load that is hopeless. `given` are the torques as they were before those of free trains were balanced.
pub(super) fn check(
    system: &System,
    parts: &Parts,
    at: (&[f64], &Torques),
) -> Result<(), AssemblyError> {
    match overload(parts, &all_pulls(system, parts, at)) {
        Some((share, error)) if share > HOPELESS => Err(error),
        _ => Ok(()),
    }
}

/// The error in words of the load: the chain that a torque asks for more than its breaking load, or else the largest pull that one asks for.
///
/// `given` are the torques as they were before those of free trains were balanced.
pub(super) fn named(
    error: AssemblyError,
    system: &System,
    parts: &Parts,
    at: (&[f64], &Torques),
) -> AssemblyError {
    let AssemblyError::NoEquilibrium {
        stage: stage @ "load",
        residual,
        iterations,
        tensioned,
        ..
    } = error
    else {
        return error;
    };
    let pulls = all_pulls(system, parts, at);
    if let Some((_, error)) = overload(parts, &pulls).filter(|(share, _)| *share > 1.0) {
        return error;
    }
    let largest = pulls.into_iter().map(|(_, pull)| pull);
    let largest = largest.max_by(|a, b| a.pull.total_cmp(&b.pull));
    AssemblyError::NoEquilibrium {
        stage,
        residual,
        iterations,
        tensioned,
        pull: largest.filter(|it| it.pull > 0.0).map(Box::new),
    }
}

/// Pulls on every chain, each with the index of the chain.
fn all_pulls(system: &System, parts: &Parts, (q, given): (&[f64], &Torques)) -> Vec<(usize, Pull)> {
    let own = torques(system, q, None);
    let given = torques(system, q, Some(given));
    let pulls = (0..parts.chains.len()).flat_map(|chain| {
        let pulls = pulls(system, parts, chain, [&own, &given]);
        pulls.into_iter().map(move |pull| (chain, pull))
    });
    pulls.collect()
}

/// The largest pull in breaking loads, and the error that names it. Twice the breaking load of a small chain is worse than a larger pull that its
/// chain carries.
fn overload(parts: &Parts, pulls: &[(usize, Pull)]) -> Option<(f64, AssemblyError)> {
    let breaking = |chain: usize| parts.chains[chain].chain.strength.breaking_load;
    let shares = pulls.iter().filter_map(|(chain, pull)| {
        let breaking = breaking(*chain)?;
        Some((pull.pull / breaking, *chain, pull, breaking))
    });
    let (share, chain, pull, breaking) = shares.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let error = AssemblyError::Overloaded {
        pull: pull.clone(),
        breaking,
    };
    let name = parts.chains[chain].name.as_ref();
    Some((share, error.of_chains(std::iter::once(name))))
}

/// Torque on every shaft \[N m\] where it stands still: of the system, or as given.
fn torques(system: &System, q: &[f64], given: Option<&Torques>) -> Vec<f64> {
    let bodies = &system.bodies;
    let still = vec![0.0; q.len()];
    let at = Moment::stateless(system.begin, q, &still);
    let shafts = bodies.shafts.iter().enumerate();
    let on = shafts.map(|(index, shaft)| {
        let turning = shaft.turn.kinematics(at.t, at.q, at.v);
        let [drive, load] = match given {
            Some(given) => [&given[index][0], &given[index][1]],
            None => [&shaft.drive, &shaft.load],
        };
        bodies.torque(drive, turning, at) + bodies.torque(load, turning, at)
    });
    on.collect()
}

/// Pull of every sprocket on a chain, with all that turns with it through gears, couplings and other chains.
///
/// ```text
/// F = Σ c M/(s R)      c: speed of a shaft over that of the sprocket, s: sense of its turning, R: its pitch radius
/// ```
///
/// A motion gives what the others ask for, where it turns one of the sprockets; of several motions nobody knows what each gives.
fn pulls(system: &System, parts: &Parts, chain: usize, [own, given]: [&[f64]; 2]) -> Vec<Pull> {
    let Layout::Route { stops, .. } = &parts.chains[chain].layout else {
        return Vec::new();
    };
    let cut = Layout::Points {
        positions: Vec::new(),
        velocities: Vec::new(),
    };
    let layouts = parts.chains.iter().enumerate();
    let others = layouts.map(|(index, it)| if index == chain { &cut } else { &it.layout });
    let others: Vec<&Layout> = others.collect();
    let wheels = stops.iter().filter_map(|stop| match stop {
        Stop::Sprocket(index) => Some(&system.bodies.wheels[*index]),
        Stop::Guide(_) => None,
    });
    // Force on the chain along its travel; none where a motion holds it.
    let mut sum = 0.0;
    let mut held = Vec::new();
    let mut found = Vec::new();
    for wheel in wheels {
        let mut ratios = vec![None; own.len()];
        ratios[wheel.shaft] = Some(1.0);
        spread(system, &others, &mut ratios);
        let moved = |(shaft, ratio): (usize, &Option<f64>)| ratio.map(|ratio| (shaft, ratio));
        let train: Vec<(usize, f64)> = ratios.iter().enumerate().filter_map(moved).collect();
        let by_motion = |(shaft, _): &(usize, f64)| {
            matches!(system.bodies.shafts[*shaft].turn.by, TurnedBy::Motion(_))
        };
        if train.iter().any(by_motion) {
            held.push(wheel);
            continue;
        }
        let all = |torques: &[f64]| train.iter().map(|(shaft, c)| c * torques[*shaft]).sum();
        let (torque, given): (f64, f64) = (all(own), all(given));
        sum += torque / (wheel.sense * wheel.pitch_radius);
        found.push(Pull {
            sprocket: wheel.name.clone(),
            given: given.abs(),
            torque: torque.abs(),
            pull: torque.abs() / wheel.pitch_radius,
            is_brought: false,
        });
    }
    let largest = found.iter().map(|it| it.pull).fold(0.0, f64::max);
    // Several loads add up at the sprocket that a motion turns; that of one is told where it acts.
    if let [wheel] = held.as_slice()
        && sum.abs() > ADDED * largest
    {
        let torque = sum.abs() * wheel.pitch_radius;
        found.push(Pull {
            sprocket: wheel.name.clone(),
            given: torque,
            torque,
            pull: sum.abs(),
            is_brought: true,
        });
    }
    found
}
