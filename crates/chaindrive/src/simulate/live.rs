//! Stepping from outside: read at any time, set what acts on the drive, go back to where one was.

use std::time::Duration;

use chaindrive_mechanics::{Assembled, Course, Input, Observation};

use super::snapshot::PreviousState;
use super::{Moving, STEPS_PER_LOOK, Simulation};
use crate::clock::Instant;
use crate::interruptible::LOOK;
use crate::{Channel, SimulationError, Stepping};

/// Inputs that can be set while a drive moves, by the names of the scene.
///
/// A [`Course`] holds until another one is set; at the start nothing acts beside what the scene says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Control {
    /// Torque on a shaft without a given motion, by its name or that of a sprocket on it \[N m\], counter-clockwise positive,
    /// beside the torques of the scene. It ends a speed or angle of the shaft.
    Torque(String),
    /// Speed of a shaft \[rad/s\], by its name or that of a sprocket on it, counter-clockwise positive: an ideal drive gives the torque
    /// that it takes, and the work of a jump. It ends torques that were set on the shaft.
    Speed(String),
    /// Angle of a shaft \[rad\], as the channels `shaft_angle` and, for a sprocket, `sprocket_angle` have it. It comes there within the
    /// time of the course along a cubic without a jump of speed, and passes at the rate of the course.
    Angle(String),
    /// Force on a tensioner \[N, or N m on an arm\] towards positive coordinates, beside its push.
    Force(String),
    /// Force on the centre of a sprocket along x \[N\], by the name of the sprocket, beside those of the scene; or on a carrier where those of the
    /// scene act, by its place `tensioners.NAME`; or on a roller, `rollers.NUMBER`, counted from 0 over all chains.
    ForceX(String),
    /// The same along y.
    ForceY(String),
    /// Acceleration of the centre of a sprocket along x \[m/s²\]: the centre goes on from where it is.
    CentreX(String),
    /// The same along y.
    CentreY(String),
    /// A parameter that the scene lists under `tunable`, by its place: `sprockets.NAME.load`, a factor on its loads,
    /// `tensioners.NAME.push.preload` \[N or N m\] or `tensioners.NAME.push.stiffness` \[N/m or N m/rad\]. It jumps.
    Parameter(String),
}

/// Changes that may come at the time that is stepped to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Changes {
    /// They may: the state before the last step is kept.
    AtTheEnd,
    /// Samples are taken, and nobody goes back.
    None,
}

impl Simulation {
    /// Moves on to a time \[s\] and reads everything off the drive there.
    ///
    /// The method takes its own steps and the state at t is interpolated: a run in a hundred pieces is the run in one,
    /// bit for bit. After the end of the run it goes on.
    ///
    /// # Errors
    /// [`SimulationError::Past`] for a time before the last reading, and what keeps the motion from going on.
    ///
    /// # Example
    ///
    /// ```
    /// use chaindrive::{Control, Run, Scene, Simulation};
    ///
    /// let scene = Scene::preset("marine_two_sprockets")?;
    /// let mut simulation = Simulation::start(&scene.drive()?, &Run::default())?;
    /// let before = simulation.advance_to(1e-3)?.sprocket_speed[1];
    /// simulation.set(&Control::Torque("camshaft".into()), 2e5)?;
    /// let after = simulation.advance_to(2e-3)?.sprocket_speed[1];
    /// assert!(after > before + 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn advance_to(&mut self, t: f64) -> Result<&Observation, SimulationError> {
        while !self.advance_towards(t, Duration::MAX)? {}
        Ok(&self.observation)
    }

    /// As [`advance_to`](Self::advance_to), but for at most about `budget` of wall time; tells whether the time is
    /// reached and read.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_towards(&mut self, t: f64, budget: Duration) -> Result<bool, SimulationError> {
        let reached = self.come_towards(t, budget)?;
        if reached {
            self.observe(t);
        }
        Ok(reached)
    }

    /// Advances to a time \[s\]; only [views](super::View) are read. `stop` is asked every 50 ms.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to), and [`SimulationError::Interrupted`].
    pub fn move_to(&mut self, t: f64, stop: &dyn Fn() -> bool) -> Result<(), SimulationError> {
        while !self.come_towards(t, LOOK)? {
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        self.read = t;
        Ok(())
    }

    fn come_towards(&mut self, t: f64, budget: Duration) -> Result<bool, SimulationError> {
        if !(t >= self.read && t.is_finite()) {
            return Err(SimulationError::Past {
                time: t,
                read: self.read,
            });
        }
        let reached = self.step_towards(t, budget, Changes::AtTheEnd)?;
        if reached {
            self.hand_out_ended();
        }
        Ok(reached)
    }

    /// Steps until the state is at a time of the simulation or beyond it, for at most about `budget` of wall time.
    pub(super) fn step_towards(
        &mut self,
        time: f64,
        budget: Duration,
        changes: Changes,
    ) -> Result<bool, SimulationError> {
        let begin = Instant::now();
        let time = self.zero() + time;
        while self.moving.state.t < time && begin.elapsed() < budget {
            for _ in 0..STEPS_PER_LOOK {
                let Moving { state, stepper, .. } = &self.moving;
                if state.t >= time {
                    break;
                }
                if changes == Changes::None {
                    self.before = None;
                } else if state.t + stepper.next_step() >= time {
                    self.gather();
                    self.before = Some(Box::new(PreviousState::of(self)));
                }
                self.moving.keep_forces_for(time);
                self.moving.step()?;
                self.end_periods();
            }
        }
        self.stepping_time += begin.elapsed().as_secs_f64();
        self.gather();
        Ok(self.moving.state.t >= time)
    }

    /// Sets what acts on the drive from the time of the last reading on.
    ///
    /// The change is an event: a step lands on its time. If the last step went beyond, it is taken again, shorter.
    ///
    /// # Errors
    /// [`SimulationError::Control`]: nothing has this name, or it cannot be set; a value that is not finite.
    pub fn set(
        &mut self,
        control: &Control,
        course: impl Into<Course>,
    ) -> Result<(), SimulationError> {
        self.set_at(self.read, control, course)
    }

    /// Plans a change for a time \[s\] not before the last reading; see [`set`](Self::set).
    ///
    /// # Errors
    /// As [`set`](Self::set), and [`SimulationError::Past`].
    pub fn set_at(
        &mut self,
        time: f64,
        control: &Control,
        course: impl Into<Course>,
    ) -> Result<(), SimulationError> {
        if !(time >= self.read && time.is_finite()) {
            return Err(SimulationError::Past {
                time,
                read: self.read,
            });
        }
        let input = control.input(&self.assembled)?;
        let course = course.into();
        let checked = self.moving.system.check_course(input, course);
        checked.map_err(|error| control.refused(error.to_string()))?;
        if time < self.time() {
            match self.before.take() {
                Some(before) => self.go_back(*before)?,
                None => {
                    return Err(SimulationError::Past {
                        time,
                        read: self.time(),
                    });
                }
            }
        }
        let time = self.zero() + time;
        // Somebody may yet go back to a time before this plan.
        if let Some(before) = &mut self.before {
            before.plan(time, input, course);
        }
        self.moving.plan(time, input, course)
    }

    /// A channel as it was at the last reading; empty where the drive has nothing of the kind.
    pub fn channel(&self, channel: Channel) -> Vec<f64> {
        let start = self.start_energy.unwrap_or(self.observation.energy);
        let mut values = Vec::new();
        channel.read(&self.observation, &start, &mut values);
        values
    }

    /// Time of the last reading \[s\].
    pub fn read_at(&self) -> f64 {
        self.read
    }
}

impl Moving {
    /// Keeps the forces at the ends of the step in which a time will lie.
    fn keep_forces_for(&mut self, time: f64) {
        let method = self.stepper.method();
        let reach = if Stepping::from(method).is_adaptive() {
            // The next step may be many times as long as this one.
            f64::INFINITY
        } else {
            // Beside what rounding makes of times.
            1.001 * self.stepper.next_step()
        };
        self.system.keep_forces_from(time - reach);
    }

    /// Plans a change, and makes it if it is due.
    pub(super) fn plan(
        &mut self,
        time: f64,
        input: Input,
        course: Course,
    ) -> Result<(), SimulationError> {
        let Self {
            system,
            state,
            stepper,
            ..
        } = self;
        system.plan(time, input, course);
        if system.take_due(state.t, &mut state.q, &mut state.v) {
            stepper
                .jump(system, state)
                .map_err(|error| SimulationError::stepping(error, system))?;
        }
        stepper.look_ahead(system, state);
        Ok(())
    }
}

/// Prefix of the name of a tensioner where a sprocket may be meant as well.
const CARRIERS: &str = "tensioners.";
/// Prefix of the number of a roller.
const ROLLERS: &str = "rollers.";

/// Makes a control of the name of its target.
type OfName = fn(String) -> Control;

impl Control {
    /// Every kind by its name in programs, and what makes it of a name.
    const KINDS: [(&str, OfName); 9] = [
        ("torque", Self::Torque),
        ("speed", Self::Speed),
        ("angle", Self::Angle),
        ("force", Self::Force),
        ("force_x", Self::ForceX),
        ("force_y", Self::ForceY),
        ("centre_x", Self::CentreX),
        ("centre_y", Self::CentreY),
        ("parameter", Self::Parameter),
    ];

    /// The control of a kind, as programs call it: `torque`, `speed`, `angle`, `force`, `force_x`, `force_y`, `centre_x`, `centre_y` or
    /// `parameter`.
    ///
    /// # Errors
    /// [`SimulationError::UnknownName`]: there is no such kind.
    pub fn named(kind: &str, name: &str) -> Result<Self, SimulationError> {
        let known = || Self::KINDS.map(|(kind, _)| kind).join(", ");
        let found = Self::KINDS.iter().find(|(known, _)| *known == kind);
        let (_, control) = found.ok_or_else(|| SimulationError::UnknownName {
            setting: "kind",
            name: kind.to_owned(),
            known: known(),
        })?;
        Ok(control(name.to_owned()))
    }

    /// The input of the drive.
    fn input(&self, assembled: &Assembled) -> Result<Input, SimulationError> {
        let system = &assembled.system;
        let (_, name) = self.target();
        let shaft = || system.shaft_named(name);
        let centre = |axis| {
            let sprocket = system.sprocket_named(name)?;
            Some(Input::Centre { sprocket, axis })
        };
        let force = |axis| {
            if let Some(carrier) = name.strip_prefix(CARRIERS) {
                let tensioner = system.tensioner_named(carrier)?;
                return Some(Input::CarrierForce { tensioner, axis });
            }
            if let Some(number) = name.strip_prefix(ROLLERS) {
                let roller = number.parse().ok()?;
                return (roller < system.rollers()).then_some(Input::RollerForce { roller, axis });
            }
            let sprocket = system.sprocket_named(name)?;
            Some(Input::CentreForce { sprocket, axis })
        };
        let mut tunable = assembled.drive.parts().tunable.iter();
        let input = match self {
            Self::Force(_) => {
                (system.tensioner_named(name)).map(|tensioner| Input::Force { tensioner })
            }
            Self::Torque(_) => shaft().map(|shaft| Input::Torque { shaft }),
            Self::Speed(_) => shaft().map(|shaft| Input::Speed { shaft }),
            Self::Angle(_) => shaft().map(|shaft| Input::Angle { shaft }),
            Self::ForceX(_) => force(0),
            Self::ForceY(_) => force(1),
            Self::CentreX(_) => centre(0),
            Self::CentreY(_) => centre(1),
            Self::Parameter(_) => tunable.find(|it| it.place == name).map(|it| it.input),
        };
        let input = input.ok_or_else(|| self.unknown(assembled))?;
        match system.refuses(input) {
            Some(reason) => Err(self.refused(reason.to_owned())),
            None => Ok(input),
        }
    }

    /// Refuses a name that the drive does not have, and lists those that it has.
    fn unknown(&self, assembled: &Assembled) -> SimulationError {
        let system = &assembled.system;
        let tunable = assembled.drive.parts().tunable.iter();
        let known = match self {
            Self::Force(_) => system.tensioner_names(),
            Self::Torque(_) | Self::Speed(_) | Self::Angle(_) => {
                [system.sprocket_names(), system.shaft_names()].concat()
            }
            Self::ForceX(_) | Self::ForceY(_) => {
                let carriers = system.tensioner_names().into_iter();
                let carriers = carriers.map(|name| format!("{CARRIERS}{name}"));
                let rollers = match system.rollers() {
                    0 => None,
                    count => Some(format!("{ROLLERS}0 to {ROLLERS}{}", count - 1)),
                };
                let sprockets = system.sprocket_names().into_iter();
                sprockets.chain(carriers).chain(rollers).collect()
            }
            Self::CentreX(_) | Self::CentreY(_) => system.sprocket_names(),
            Self::Parameter(_) => tunable.map(|it| it.place.clone()).collect(),
        };
        self.refused(match (known.len(), self) {
            (0, Self::Parameter(_)) => "the scene lists none; name it under `tunable`".to_owned(),
            (0, _) => "there is none in this drive".to_owned(),
            _ => format!("there is none of this name; there are {}", known.join(", ")),
        })
    }

    /// Kind and name of its target.
    fn target(&self) -> (&'static str, &str) {
        match self {
            Self::Force(name) => ("tensioner", name),
            Self::ForceX(name) | Self::ForceY(name) => ("centre, carrier or roller", name),
            Self::Torque(name) | Self::Speed(name) | Self::Angle(name) => ("shaft", name),
            Self::CentreX(name) | Self::CentreY(name) => ("sprocket", name),
            Self::Parameter(place) => ("parameter", place),
        }
    }

    fn refused(&self, reason: String) -> SimulationError {
        let (what, name) = self.target();
        SimulationError::Control {
            what,
            name: name.to_owned(),
            reason,
        }
    }
}
