//! Setting inputs from outside, and the events that they are.

use chaindrive_integrate::slack;
use chaindrive_quantities::ParameterError;
use serde::{Deserialize, Serialize};

use super::System;
use crate::bodies::{Input, RailSupport, TurnedBy, WheelSupport};
use crate::course::{Course, Path};
use crate::kinematics::Kinematics;
use crate::{MemoryError, Motion, Push};

/// A body on a course from outside.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct InputPath {
    body: InputTarget,
    path: Path,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum InputTarget {
    /// A centre along an axis.
    Centre { sprocket: usize, axis: usize },
    /// All shafts of a train.
    Train(usize),
}

impl System {
    /// Why an input cannot be set; nothing if it can.
    pub fn refuses(&self, input: Input) -> Option<&'static str> {
        let tensioner = |index: usize| &self.bodies.slides[index];
        match input {
            Input::Torque { shaft } => match self.bodies.shafts[shaft].turn.by {
                TurnedBy::Coordinate(_) | TurnedBy::Driven { .. } => None,
                TurnedBy::Motion(_) => Some(
                    "its motion is given, and no torque changes it; give it an inertia and no motion, and set its speed until a torque is to act",
                ),
            },
            Input::Speed { .. }
            | Input::Angle { .. }
            | Input::Load { .. }
            | Input::CentreForce { .. } => None,
            Input::Force { tensioner: index } => match tensioner(index).dof {
                Some(_) => None,
                None => Some("it is locked where it was assembled; give it a spring"),
            },
            Input::RollerForce { roller, .. } => {
                let (member, _) = self.member_with(roller);
                let hinged = member.chain.has_reactions();
                hinged.then_some(
                    "its links are joined by ideal hinges, which a force on a roller would open; give the joints a clearance",
                )
            }
            Input::CarrierForce {
                tensioner: index, ..
            } => {
                let slide = tensioner(index);
                let somewhere = slide.carrier.pivot().is_none() || slide.forced_at.is_some();
                (!somewhere).then_some(
                    "an arm does not say on which point of it a force acts; give it `force_at`",
                )
            }
            Input::Preload { tensioner: index } | Input::Stiffness { tensioner: index } => {
                match tensioner(index).push {
                    Push::Spring(_) | Push::TorsionSpring(_) => None,
                    _ => Some("it has no spring"),
                }
            }
            Input::Centre { sprocket, .. } => match self.bodies.wheels[sprocket].support {
                WheelSupport::Fixed | WheelSupport::Prescribed { .. } => None,
                WheelSupport::Springs { .. } | WheelSupport::Carried(_) => {
                    Some("its centre moves by itself, on springs or with a tensioner")
                }
            },
        }
    }

    /// Refuses a course that an input cannot take.
    ///
    /// # Errors
    /// Names what is out of range.
    pub fn check_course(&self, input: Input, course: Course) -> Result<(), ParameterError> {
        let Course { to, over, rate } = course;
        let require = |holds: bool, parameter: &'static str, value: f64, allowed: &'static str| {
            let refused = || ParameterError {
                parameter: parameter.into(),
                value,
                allowed: allowed.into(),
            };
            if holds { Ok(()) } else { Err(refused()) }
        };
        require(to.is_finite(), "value", to, "finite")?;
        require(rate.is_finite(), "rate", rate, "finite")?;
        require(
            over >= 0.0 && over.is_finite(),
            "over",
            over,
            "zero or positive [s]",
        )?;
        match input {
            Input::Angle { .. } => {
                require(over > 0.0, "over", over, "positive: an angle takes time")
            }
            Input::Load { .. } | Input::Preload { .. } | Input::Stiffness { .. } => {
                require(
                    over + rate.abs() <= 0.0,
                    "over",
                    over,
                    "zero: a parameter jumps",
                )?;
                match self.tuned_push(input, to) {
                    Some((_, push)) => push.check(),
                    None => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    /// Plans a change of an input at a time \[s\] not before the present one.
    pub fn plan(&mut self, t: f64, input: Input, course: Course) {
        let planned = &mut self.bodies.inputs.planned;
        let place = planned.partition_point(|(time, ..)| *time <= t);
        planned.insert(place, (t, input, course));
    }

    /// Makes the changes that are due, and ends ramps; tells whether there were any. Coordinates are set where somebody hands them back.
    pub fn take_due(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) -> bool {
        let arrives = self.bodies.arrive(t);
        let due = |(time, ..): &(f64, Input, Course)| *time <= t + slack(t);
        let planned = &mut self.bodies.inputs.planned;
        let count = planned.iter().take_while(|it| due(it)).count();
        let changes: Vec<_> = planned.drain(..count).collect();
        for (_, input, course) in changes {
            match input {
                Input::Torque { shaft } => {
                    self.release(shaft, t, q, v);
                    self.bodies.inputs.set_torque(shaft, t, course);
                }
                Input::Speed { shaft } => {
                    let ratio = self.bodies.shafts[shaft].turn.ratio;
                    let course = Course {
                        to: course.to / ratio,
                        rate: course.rate / ratio,
                        ..course
                    };
                    self.drive(shaft, t, [q, v], |now| Path::driven(now, t, course));
                }
                Input::Angle { shaft } => {
                    let turn = &self.bodies.shafts[shaft].turn;
                    let course = Course {
                        to: (course.to - turn.zero) / turn.ratio,
                        rate: course.rate / turn.ratio,
                        ..course
                    };
                    self.drive(shaft, t, [q, v], |now| Path::placed(now, t, course));
                }
                Input::Force { tensioner } => {
                    self.bodies.inputs.set_force(tensioner, t, course);
                }
                Input::CentreForce { sprocket, axis } => {
                    let inputs = &mut self.bodies.inputs;
                    inputs.set_centre_force(sprocket, axis, t, course);
                }
                Input::CarrierForce { tensioner, axis } => {
                    let inputs = &mut self.bodies.inputs;
                    inputs.set_carrier_force(tensioner, axis, t, course);
                }
                Input::RollerForce { roller, axis } => {
                    let pulled = (roller, self.inertias_of_roller(roller, q));
                    let inputs = &mut self.bodies.inputs;
                    inputs.set_roller_force(pulled, axis, t, course);
                }
                Input::Centre { sprocket, axis } => {
                    if let Some(motion) = self.centre_motion(sprocket, axis) {
                        let path = Path::accelerated(motion.at(t), t, course);
                        *motion = Motion::Onward(Box::new(path));
                    }
                }
                Input::Load { .. } | Input::Preload { .. } | Input::Stiffness { .. } => {
                    self.tune_at(t, input, course.to, q);
                }
            }
        }
        count > 0 || arrives
    }

    /// Takes the turning of a train over; the ideal drive does the work of a jump of its speed.
    ///
    /// ```text
    /// W = ½ Σ i² J (ẋ₁² − ẋ₀²)
    /// ```
    fn drive(
        &mut self,
        shaft: usize,
        t: f64,
        [q, v]: [&[f64]; 2],
        path: impl FnOnce(Kinematics) -> Path,
    ) {
        let turn = &self.bodies.shafts[shaft].turn;
        let (train, now) = (turn.train, turn.driving(t, q, v));
        let path = path(now);
        let inertia = self.bodies.train_inertia(train);
        let speed = path.at(t).rate;
        let work = 0.5 * inertia * (speed * speed - now.rate * now.rate);
        self.bodies.inputs.jumps[0].count(t, work);
        for index in 0..self.bodies.shafts.len() {
            if self.bodies.shafts[index].turn.train == train {
                self.bodies.inputs.set_torque(index, t, Course::default());
            }
        }
        self.bodies.turn_by(train, Some(path));
    }

    /// Hands the turning of a train back to its coordinate, with the angle and speed that it has.
    fn release(&mut self, shaft: usize, t: f64, q: &mut [f64], v: &mut [f64]) {
        let turn = &self.bodies.shafts[shaft].turn;
        if let TurnedBy::Driven { dof, path } = &turn.by {
            let now = path.at(t);
            q[*dof] = now.position;
            v[*dof] = now.rate;
            self.bodies.turn_by(turn.train, None);
        }
    }

    /// Lets coordinates follow what turns in their place.
    pub(super) fn follow(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        for shaft in &self.bodies.shafts {
            if let TurnedBy::Driven { dof, path } = &shaft.turn.by
                && t > path.since()
            {
                let now = path.at(t);
                q[*dof] = now.position;
                v[*dof] = now.rate;
            }
        }
    }

    /// Changes a parameter; what is stored then more than before is work of whoever did it.
    fn tune_at(&mut self, t: f64, input: Input, value: f64, q: &[f64]) {
        if let Some((index, _)) = self.tuned_push(input, value) {
            let still = vec![0.0; q.len()];
            let stored = |system: &Self| {
                let slide = &system.bodies.slides[index];
                slide.stored(slide.pose(q, &still), &[])
            };
            let before = stored(self);
            self.tune(input, value);
            let work = stored(self) - before;
            self.bodies.inputs.jumps[1].count(t, work);
        } else {
            self.tune(input, value);
        }
    }

    fn tune(&mut self, input: Input, value: f64) {
        if let Some((index, push)) = self.tuned_push(input, value) {
            self.bodies.slides[index].push = push;
        } else if let Input::Load { shaft } = input {
            self.bodies.shafts[shaft].load_factor = value;
        }
        self.bodies.inputs.tune(input, value);
        self.bodies.renew_rates();
    }

    /// The tensioner of a parameter, and its push with the value.
    fn tuned_push(&self, input: Input, value: f64) -> Option<(usize, Push)> {
        let (index, stiffens) = match input {
            Input::Preload { tensioner } => (tensioner, false),
            Input::Stiffness { tensioner } => (tensioner, true),
            _ => return None,
        };
        let mut push = self.bodies.slides[index].push;
        let parameter = match &mut push {
            Push::Spring(spring) if stiffens => &mut spring.stiffness,
            Push::Spring(spring) => &mut spring.preload,
            Push::TorsionSpring(spring) if stiffens => &mut spring.stiffness,
            Push::TorsionSpring(spring) => &mut spring.preload,
            _ => return None,
        };
        *parameter = value;
        Some((index, push))
    }

    /// Motion of a centre along an axis, which a fixed one begins at rest; none where it moves by itself.
    fn centre_motion(&mut self, sprocket: usize, axis: usize) -> Option<&mut Motion> {
        let support = &mut self.bodies.wheels[sprocket].support;
        if let WheelSupport::Fixed = support {
            *support = WheelSupport::Prescribed {
                x: Motion::Held,
                y: Motion::Held,
            };
        }
        match support {
            WheelSupport::Prescribed { x, y } => Some(if axis == 0 { x } else { y }),
            WheelSupport::Fixed | WheelSupport::Springs { .. } | WheelSupport::Carried(_) => None,
        }
    }

    /// Bodies on courses that somebody has set.
    pub(super) fn on_courses(&self) -> Vec<InputPath> {
        let mut found = Vec::new();
        for (sprocket, wheel) in self.bodies.wheels.iter().enumerate() {
            let WheelSupport::Prescribed { x, y } = &wheel.support else {
                continue;
            };
            for (axis, motion) in [x, y].into_iter().enumerate() {
                if let Motion::Onward(path) = motion {
                    let body = InputTarget::Centre { sprocket, axis };
                    found.push(InputPath { body, path: **path });
                }
            }
        }
        for shaft in self.bodies.shafts.iter().filter(|it| it.leads) {
            if let TurnedBy::Driven { path, .. } | TurnedBy::Motion(Motion::Onward(path)) =
                &shaft.turn.by
            {
                let body = InputTarget::Train(shaft.turn.train);
                found.push(InputPath { body, path: **path });
            }
        }
        found
    }

    /// Sets them on these courses again, and parameters to their values.
    pub(super) fn set_again(
        &mut self,
        courses: &[InputPath],
        tuned: &[(Input, f64)],
    ) -> Result<(), MemoryError> {
        let [sprockets, shafts, tensioners] = [
            self.bodies.wheels.len(),
            self.bodies.shafts.len(),
            self.bodies.slides.len(),
        ];
        for &InputPath { body, path } in courses {
            match body {
                InputTarget::Centre { sprocket, axis } => {
                    MemoryError::unless_within("a motion of sprocket", sprocket + 1, sprockets)?;
                    let motion = self.centre_motion(sprocket, axis);
                    *motion.ok_or(MemoryError::Model)? = Motion::Onward(Box::new(path));
                }
                InputTarget::Train(leader) => {
                    MemoryError::unless_within("a motion of shaft", leader + 1, shafts)?;
                    self.bodies.turn_by(leader, Some(path));
                }
            }
        }
        for &(input, value) in tuned {
            match input {
                Input::Load { shaft } => {
                    MemoryError::unless_within("a load of shaft", shaft + 1, shafts)?;
                }
                Input::Preload { tensioner } | Input::Stiffness { tensioner } => {
                    MemoryError::unless_within("a spring of tensioner", tensioner + 1, tensioners)?;
                }
                _ => return Err(MemoryError::Model),
            }
            self.tune(input, value);
        }
        Ok(())
    }

    /// Time \[s\] of the first event after t: a change of an input, a knot of a table over time, or t = 0, where the
    /// record begins.
    pub(super) fn event_after(&self, t: f64) -> f64 {
        let earliest = |times: &mut dyn Iterator<Item = Option<f64>>| {
            times.flatten().fold(f64::INFINITY, f64::min)
        };
        let shafts = self.bodies.shafts.iter().map(|shaft| {
            let motion = match &shaft.turn.by {
                TurnedBy::Motion(motion) => motion.next_knot(t),
                TurnedBy::Driven { path, .. } => path.next_knot(t),
                TurnedBy::Coordinate(_) => None,
            };
            let torques = shaft.drive.iter().chain(&shaft.load);
            let knots = torques.map(|torque| torque.next_knot(t));
            Some(earliest(&mut knots.chain([motion])))
        });
        let wheels = self.bodies.wheels.iter().map(|wheel| match &wheel.support {
            WheelSupport::Prescribed { x, y } => Some(knots(x, y, t)),
            _ => None,
        });
        let rails = self.bodies.rails.iter().map(|rail| match &rail.support {
            RailSupport::Prescribed { x, y } => Some(knots(x, y, t)),
            _ => None,
        });
        let ends = self.chains.iter().map(|member| member.chain.next_knot(t));
        let forces = self.bodies.all_forces().map(|force| force.next_knot(t));
        let mut all = shafts
            .chain(wheels)
            .chain(rails)
            .chain(ends)
            .chain(forces)
            .chain([self.bodies.inputs.next_change(t)])
            .chain([(t < 0.0).then_some(0.0)]);
        earliest(&mut all)
    }
}

/// The first knot of either motion.
fn knots(x: &Motion, y: &Motion, t: f64) -> f64 {
    let [x, y] = [x, y].map(|motion| motion.next_knot(t).unwrap_or(f64::INFINITY));
    x.min(y)
}
