//! Trains that no motion turns: their speed at the start, the speed at which their torques balance, and how they speed up.
//!
//! Torques that do not balance have no static state: the train speeds up, and what they do to the chains is left of them when every
//! shaft has taken its share.
//!
//! ```text
//! Σ c (M − J c α) = 0,   α = Σ c M / Σ c² J      c: speed of a shaft over that of the first one
//! ```
//!
//! The mass of the chains is left out of J: it is felt as soon as they move.

use chaindrive_integrate::Moment;

use super::start_velocities::spread;
use crate::bodies::{Bodies, Shaft};
use crate::course::Path;
use crate::drive::{Layout, Parts, Rotation, StartSpeed};
use crate::system::System;
use crate::{Action, AssemblyError, Course, Torque};

/// Shafts that chains, gears and couplings join and no motion turns.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeTrain {
    /// Its shafts by their index in the drive, each with its speed over that of the first one \[–\].
    pub shafts: Vec<(usize, f64)>,
    /// Speed of the first one where the simulation begins \[rad/s\].
    pub speed: f64,
    /// Sum of all torques at that speed, as one on the first shaft \[N m\].
    pub torque: f64,
    /// Moment of inertia of all shafts, as that of the first one \[kg m²\].
    pub inertia: f64,
    /// Speed of the first one at which the torques balance \[rad/s\], in the mean over a turn; none where they never do.
    pub working_point: Option<f64>,
    /// Whether a strand with ends runs over a sprocket of it, and may hold it.
    is_held: bool,
}

/// The trains of a system that stands at `q`, and their speeds at the start.
///
/// # Errors
/// Speeds that contradict each other, or a working point that there is not.
pub(super) fn free_trains(
    system: &System,
    parts: &Parts,
    q: &[f64],
    driven: &[Option<f64>],
) -> Result<Vec<FreeTrain>, AssemblyError> {
    let asked = |index: usize| match &parts.shafts[index].rotation {
        Rotation::Free { start, .. } => *start,
        Rotation::Prescribed(_) => StartSpeed::Joined,
    };
    for (index, speed) in driven.iter().enumerate() {
        if let Some(speed) = speed {
            agrees(parts, index, asked(index), *speed)?;
        }
    }
    let layouts: Vec<&Layout> = parts.chains.iter().map(|it| &it.layout).collect();
    let mut known: Vec<bool> = driven.iter().map(Option::is_some).collect();
    let mut found = Vec::new();
    for first in 0..known.len() {
        if known[first] {
            continue;
        }
        let mut ratios = vec![None; known.len()];
        ratios[first] = Some(1.0);
        spread(system, &layouts, &mut ratios);
        let shafts = ratios.iter().enumerate();
        let shafts: Vec<(usize, f64)> = shafts.filter_map(|(at, c)| Some((at, (*c)?))).collect();
        for (shaft, _) in &shafts {
            known[*shaft] = true;
        }
        found.push(FreeTrain::of(system, parts, q, shafts, &asked)?);
    }
    Ok(found)
}

impl FreeTrain {
    fn of(
        system: &System,
        parts: &Parts,
        q: &[f64],
        shafts: Vec<(usize, f64)>,
        asked: &dyn Fn(usize) -> StartSpeed,
    ) -> Result<Self, AssemblyError> {
        let bodies = &system.bodies;
        let runs = |index: &usize, wheel: usize| parts.sprockets[wheel].shaft == *index;
        let mut strands = parts.chains.iter();
        let mut train = Self {
            // J = Σ c² J
            inertia: shafts
                .iter()
                .map(|(i, c)| c * c * inertia(system, *i))
                .sum(),
            is_held: strands.any(|placed| {
                let mut on = placed.sprockets.iter();
                let holds = |wheel: &usize| shafts.iter().any(|(index, _)| runs(index, *wheel));
                matches!(placed.layout, Layout::Points { .. }) && on.any(holds)
            }),
            working_point: working_point(bodies, &shafts, system.begin),
            speed: 0.0,
            torque: 0.0,
            shafts,
        };
        let given = train
            .shafts
            .iter()
            .find_map(|(index, c)| match asked(*index) {
                StartSpeed::Joined => None,
                StartSpeed::Given(speed) => Some(Ok(speed / c)),
                StartSpeed::WorkingPoint => {
                    Some(
                        train
                            .working_point
                            .ok_or_else(|| AssemblyError::NoWorkingPoint {
                                shafts: train.names(parts),
                            }),
                    )
                }
            });
        train.speed = given.transpose()?.unwrap_or(0.0);
        for (index, c) in &train.shafts {
            agrees(parts, *index, asked(*index), c * train.speed)?;
        }
        let torques = train.torques(system, q);
        // M = Σ c M
        train.torque = train
            .shafts
            .iter()
            .zip(&torques)
            .map(|((_, c), torque)| c * torque)
            .sum();
        Ok(train)
    }

    /// Names of its shafts.
    pub fn names(&self, parts: &Parts) -> Vec<String> {
        self.shafts
            .iter()
            .map(|(index, _)| parts.shaft_name(*index))
            .collect()
    }

    /// Acceleration of the first shaft at the start \[rad/s²\], the mass of the chains left aside.
    pub fn acceleration(&self) -> f64 {
        // α = Σ c M / Σ c² J
        self.torque / self.inertia
    }

    /// Torque on each of its shafts at the start \[N m\].
    fn torques(&self, system: &System, q: &[f64]) -> Vec<f64> {
        let bodies = &system.bodies;
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(system.begin, q, &still);
        let torque = |(index, c): &(usize, f64)| {
            let shaft = &bodies.shafts[*index];
            let mut turning = shaft.turn.kinematics(at.t, at.q, at.v);
            turning.rate = c * self.speed;
            let given =
                bodies.torque(&shaft.drive, turning, at) + bodies.torque(&shaft.load, turning, at);
            given + bodies.idle_torque(*index, at.t, turning.rate)
        };
        self.shafts.iter().map(torque).collect()
    }

    /// Whether its torques alone set it in motion: no strand holds it, and its torques balance in the mean over a turn, not at an angle.
    fn sets_off(&self, system: &System) -> bool {
        let shafts = &system.bodies.shafts;
        let mut torques = torques_of(shafts, &self.shafts);
        let turns = torques.any(|(torque, _)| torque.turns_with_an_angle());
        let seeks = turns && self.speed == 0.0 && self.working_point == Some(0.0);
        !self.is_held && !seeks
    }
}

/// Torques of the shafts of a system, by shaft: those that drive and those that load.
pub(super) type Torques = Vec<[Vec<Torque>; 2]>;

/// Puts constant torques, which balance, in the place of those of free trains, for a static state; returns those that were there, and a
/// shaft of every such train.
pub(super) fn balance(
    system: &mut System,
    trains: &[FreeTrain],
    q: &[f64],
) -> (Torques, Vec<usize>) {
    let shafts = system.bodies.shafts.iter();
    let before = shafts
        .map(|it| [it.drive.clone(), it.load.clone()])
        .collect();
    let free: Vec<&FreeTrain> = trains.iter().filter(|it| it.sets_off(system)).collect();
    let mut moving = Vec::new();
    for train in free {
        let torques = train.torques(system, q);
        // What rounding leaves is no acceleration.
        let sum: f64 = torques
            .iter()
            .zip(&train.shafts)
            .map(|(m, (_, c))| (c * m).abs())
            .sum();
        let balanced = train.torque.abs() <= ROUNDING * sum;
        if balanced && train.speed == 0.0 {
            continue;
        }
        moving.push(train.shafts[0].0);
        for ((index, c), torque) in train.shafts.iter().zip(torques) {
            // M − J c α
            let share = inertia(system, *index) * c * train.acceleration();
            let shaft = &mut system.bodies.shafts[*index];
            if shaft.drive.is_empty() && shaft.load.is_empty() && share == 0.0 && torque == 0.0 {
                continue;
            }
            shaft.drive.clear();
            let value = torque - share;
            shaft.load = vec![Action::Constant { value }.into()];
        }
    }
    (before, moving)
}

/// Holds shafts where they stand, one of every train that moves: it is settled at the phase at which it was laid. Left free it would turn, in
/// thousands of short steps, to the phase at which its chains have the least energy.
pub(super) fn hold(system: &mut System, moving: &[usize], q: &[f64]) {
    let still = vec![0.0; q.len()];
    for shaft in moving {
        let turn = &system.bodies.shafts[*shaft].turn;
        let now = turn.driving(system.begin, q, &still);
        let path = Path::driven(now, system.begin, Course::default());
        let train = turn.train;
        system.bodies.turn_by(train, Some(path));
    }
}

/// Lets them go.
pub(super) fn let_go(system: &mut System, moving: &[usize]) {
    for shaft in moving {
        let train = system.bodies.shafts[*shaft].turn.train;
        system.bodies.turn_by(train, None);
    }
}

/// Share of all torques of a train that rounding may leave of their sum.
const ROUNDING: f64 = 1e-12;

/// Puts the torques back.
pub(super) fn restore_torques(system: &mut System, torques: Torques) {
    for (shaft, [drive, load]) in system.bodies.shafts.iter_mut().zip(torques) {
        (shaft.drive, shaft.load) = (drive, load);
    }
}

/// Moment of inertia of a shaft with its sprockets \[kg m²\].
fn inertia(system: &System, index: usize) -> f64 {
    let bodies = &system.bodies;
    let on_it = bodies.wheels.iter().filter(|wheel| wheel.shaft == index);
    bodies.shafts[index].inertia + on_it.map(|wheel| wheel.inertia).sum::<f64>()
}

/// Relative difference up to which two speeds are the same: a gear ratio written with nine digits.
const SAME: f64 = 1e-8;

fn agrees(parts: &Parts, index: usize, asked: StartSpeed, turns: f64) -> Result<(), AssemblyError> {
    let StartSpeed::Given(speed) = asked else {
        return Ok(());
    };
    if (speed - turns).abs() <= SAME * speed.abs().max(turns.abs()) {
        return Ok(());
    }
    Err(AssemblyError::StartSpeed {
        shaft: parts.shaft_name(index),
        asked: speed,
        turns,
    })
}

/// Speeds that are tried a decade where no table has a point.
const A_DECADE: i32 = 20;
/// Decades of speed that are tried \[rad/s\].
const DECADES: std::ops::Range<i32> = -3..6;

/// All torques on some shafts, each with the speed of its shaft over that of the first one.
fn torques_of<'s>(
    all: &'s [Shaft],
    shafts: &'s [(usize, f64)],
) -> impl Iterator<Item = (&'s Torque, f64)> {
    let own = |(index, c): &'s (usize, f64)| all[*index].torques().map(move |it| (it, *c));
    shafts.iter().flat_map(own)
}

/// Speed \[rad/s\] of the first of some shafts at which their torques balance, coming up from rest the way that they drive; 0 where they
/// balance at rest, none where they never do.
///
/// ```text
/// F(ω) = Σ c M̄(c ω) = 0      M̄: mean over a turn; bearings carry no chain
/// ```
fn working_point(bodies: &Bodies, shafts: &[(usize, f64)], t: f64) -> Option<f64> {
    let torques = || torques_of(&bodies.shafts, shafts);
    let sum = |speed: f64| {
        let given = torques().map(|(torque, c)| c * torque.mean(t, c * speed));
        let lost = shafts.iter();
        let lost = lost.map(|(index, c)| c * bodies.idle_torque(*index, t, c * speed));
        given.sum::<f64>() + lost.sum::<f64>()
    };
    let at_rest = sum(0.0);
    if at_rest == 0.0 {
        return Some(0.0);
    }
    let way = at_rest.signum();
    let knots =
        torques().flat_map(|(torque, c)| torque.speeds().iter().map(move |speed| way * speed / c));
    let steps = (DECADES.start * A_DECADE..=DECADES.end * A_DECADE)
        .map(|step| 10_f64.powf(f64::from(step) / f64::from(A_DECADE)));
    let mut speeds: Vec<f64> = knots.filter(|it| *it > 0.0).chain(steps).collect();
    speeds.sort_by(f64::total_cmp);
    let drives = |speed: f64| way * sum(way * speed) > 0.0;
    let mut fast = speeds.iter().position(|speed| !drives(*speed)).map(|at| {
        let slow = if at == 0 { 0.0 } else { speeds[at - 1] };
        [slow, speeds[at]]
    })?;
    // Halved until nothing is between.
    for _ in 0..200 {
        let middle = 0.5 * (fast[0] + fast[1]);
        fast[usize::from(!drives(middle))] = middle;
    }
    Some(way * fast[1])
}
