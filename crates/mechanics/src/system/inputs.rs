//! Setting inputs from outside, and the events that they are.

use chaindrive_integrate::slack;
use serde::{Deserialize, Serialize};

use super::System;
use crate::bodies::{Input, RailSupport, TurnedBy, WheelSupport};
use crate::motion::Kinematics;
use crate::{MemoryError, Motion};

/// A centre that goes on along an axis from where it was at a moment, as somebody has set it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct OnwardCentre {
    sprocket: usize,
    axis: usize,
    from: Kinematics,
    since: f64,
}

fn set(values: &mut Vec<f64>, index: usize, value: f64) {
    if values.len() <= index {
        values.resize(index + 1, 0.0);
    }
    values[index] = value;
}

impl System {
    /// Why an input cannot be set; nothing if it can.
    pub fn refuses(&self, input: Input) -> Option<&'static str> {
        match input {
            Input::Torque { shaft } => match self.bodies.shafts[shaft].turn.by {
                TurnedBy::Coordinate(_) => None,
                TurnedBy::Motion(_) => Some(
                    "its motion is given, and no torque changes it; give it an inertia and no motion",
                ),
            },
            Input::Force { tensioner } => match self.bodies.slides[tensioner].dof {
                Some(_) => None,
                None => Some("it is locked where it was assembled; give it a spring"),
            },
            Input::Centre { sprocket, .. } => match self.bodies.wheels[sprocket].support {
                WheelSupport::Fixed | WheelSupport::Prescribed { .. } => None,
                WheelSupport::Springs { .. } | WheelSupport::Carried(_) => {
                    Some("its centre moves by itself, on springs or with a tensioner")
                }
            },
        }
    }

    /// Plans a change of an input at a time \[s\] not before the present one.
    pub fn plan(&mut self, t: f64, input: Input, value: f64) {
        let planned = &mut self.bodies.inputs.planned;
        let place = planned.partition_point(|(time, ..)| *time <= t);
        planned.insert(place, (t, input, value));
    }

    /// Makes the changes that are due; tells whether there were any.
    pub fn take_due(&mut self, t: f64) -> bool {
        let due = |(time, ..): &(f64, Input, f64)| *time <= t + slack(t);
        let count = self
            .bodies
            .inputs
            .planned
            .iter()
            .take_while(|it| due(it))
            .count();
        let changes: Vec<_> = self.bodies.inputs.planned.drain(..count).collect();
        for (time, input, value) in changes {
            match input {
                Input::Torque { shaft } => set(&mut self.bodies.inputs.torques, shaft, value),
                Input::Force { tensioner } => set(&mut self.bodies.inputs.forces, tensioner, value),
                Input::Centre { sprocket, axis } => self.accelerate(sprocket, axis, time, value),
            }
        }
        count > 0
    }

    fn accelerate(&mut self, sprocket: usize, axis: usize, time: f64, acceleration: f64) {
        if let Some(motion) = self.centre_motion(sprocket, axis) {
            let from = Kinematics {
                acceleration,
                ..motion.at(time)
            };
            *motion = Motion::Onward { from, since: time };
        }
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

    /// Centres that go on as somebody has set them.
    pub(super) fn centres_set(&self) -> Vec<OnwardCentre> {
        let mut found = Vec::new();
        for (sprocket, wheel) in self.bodies.wheels.iter().enumerate() {
            let WheelSupport::Prescribed { x, y } = &wheel.support else {
                continue;
            };
            for (axis, motion) in [x, y].into_iter().enumerate() {
                if let Motion::Onward { from, since } = motion {
                    found.push(OnwardCentre {
                        sprocket,
                        axis,
                        from: *from,
                        since: *since,
                    });
                }
            }
        }
        found
    }

    /// Sets them again.
    pub(super) fn set_centres(&mut self, centres: &[OnwardCentre]) -> Result<(), MemoryError> {
        let sprockets = self.bodies.wheels.len();
        for centre in centres {
            let &OnwardCentre { sprocket, axis, .. } = centre;
            MemoryError::unless_within("a motion of sprocket", sprocket + 1, sprockets)?;
            let motion = self.centre_motion(sprocket, axis);
            *motion.ok_or(MemoryError::Model)? = Motion::Onward {
                from: centre.from,
                since: centre.since,
            };
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
        let mut all = shafts
            .chain(wheels)
            .chain(rails)
            .chain(ends)
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
