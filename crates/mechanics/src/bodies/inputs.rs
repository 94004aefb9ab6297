//! Inputs that act on a drive from outside while it moves: torques, forces, motions and parameters that somebody sets.
//!
//! A course holds from the moment at which it is set until another one is. Every change is an event: a step lands on its
//! time, and the next one begins with the new forces.

use serde::{Deserialize, Serialize};

use crate::course::{Course, Ramp};

/// Inputs that can be set from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Input {
    /// Torque on a shaft \[N m\], counter-clockwise positive, beside those of the scene; it ends a speed or angle that was set.
    Torque {
        /// Index of the shaft.
        shaft: usize,
    },
    /// Speed of a shaft \[rad/s\], counter-clockwise positive, whatever torque that takes; it ends torques that were set.
    Speed {
        /// Index of the shaft.
        shaft: usize,
    },
    /// Angle of a shaft \[rad\], to which it comes within the time of the course and where its speed is the rate.
    Angle {
        /// Index of the shaft.
        shaft: usize,
    },
    /// Generalised force on a tensioner that moves \[N, or N m on an arm\], beside its push.
    Force {
        /// Index of the tensioner.
        tensioner: usize,
    },
    /// Acceleration of a fixed or moved centre along x (0) or y (1) \[m/s²\]; it goes on from where it is, at the
    /// speed it has.
    Centre {
        /// Index of the sprocket.
        sprocket: usize,
        /// Axis.
        axis: usize,
    },
    /// Force on the centre of a sprocket along x (0) or y (1) \[N\], beside those of the scene.
    CentreForce {
        /// Index of the sprocket.
        sprocket: usize,
        /// Axis.
        axis: usize,
    },
    /// Force on a carrier along x (0) or y (1) \[N\], where those of the scene act, beside them.
    CarrierForce {
        /// Index of the tensioner.
        tensioner: usize,
        /// Axis.
        axis: usize,
    },
    /// Force on the centre of a roller along x (0) or y (1) \[N\]: a hand at the chain.
    RollerForce {
        /// Index of the roller, counted over all chains.
        roller: usize,
        /// Axis.
        axis: usize,
    },
    /// Factor on the loads of a shaft \[–\], 1 at the start.
    Load {
        /// Index of the shaft.
        shaft: usize,
    },
    /// Preload of the spring of a tensioner \[N or N m\].
    Preload {
        /// Index of the tensioner.
        tensioner: usize,
    },
    /// Stiffness of the spring of a tensioner \[N/m or N m/rad\].
    Stiffness {
        /// Index of the tensioner.
        tensioner: usize,
    },
}

/// The courses at present, and the changes to come.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Inputs {
    torques: Vec<Ramp>,
    forces: Vec<Ramp>,
    /// Along x, then y of every body.
    centre_forces: Vec<Ramp>,
    carrier_forces: Vec<Ramp>,
    /// Forces on rollers that somebody has pulled at.
    roller_forces: Vec<RollerForce>,
    /// Parameters that are no more those of the scene.
    pub(crate) tuned: Vec<(Input, f64)>,
    /// Changes to come, the earliest first: of equal times in the order of their planning.
    pub(crate) planned: Vec<(f64, Input, Course)>,
    /// Work of speeds that jumped \[J\], and of parameters that were changed.
    pub(crate) jumps: [Jumps; 2],
}

/// Force from outside on a roller.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RollerForce {
    /// Number of the roller over all chains.
    pub(crate) roller: usize,
    /// Along x and y \[N\].
    ramps: [Ramp; 2],
    /// Inertias that go with the coordinates of the roller, in their order \[kg or kg m²\].
    pub(crate) inertias: Vec<f64>,
}

impl RollerForce {
    /// Force along x and y \[N\].
    pub(crate) fn at(&self, t: f64) -> [f64; 2] {
        self.ramps.map(|ramp| ramp.at(t))
    }
}

/// Work that was done in no time.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Jumps {
    /// Before the last moment, and at it \[J\].
    work: [f64; 2],
    moment: f64,
}

impl Jumps {
    /// Counts work \[J\] at a time \[s\].
    pub(crate) fn count(&mut self, t: f64, work: f64) {
        if t > self.moment {
            self.work = [self.work[0] + self.work[1], 0.0];
            self.moment = t;
        }
        self.work[1] += work;
    }

    /// The work until a time \[s\] not before the last moment but one.
    pub(crate) fn until(&self, t: f64) -> f64 {
        let [before, last] = self.work;
        if t >= self.moment {
            before + last
        } else {
            before
        }
    }
}

impl Inputs {
    /// Torque on a shaft \[N m\].
    pub(crate) fn torque(&self, shaft: usize, t: f64) -> f64 {
        self.torques.get(shaft).map_or(0.0, |ramp| ramp.at(t))
    }

    /// Force on a tensioner \[N or N m\].
    pub(crate) fn force(&self, tensioner: usize, t: f64) -> f64 {
        self.forces.get(tensioner).map_or(0.0, |ramp| ramp.at(t))
    }

    /// Force on the centre of a sprocket \[N\]; none before one was set.
    pub(crate) fn centre_force(&self, sprocket: usize, t: f64) -> Option<[f64; 2]> {
        pair(&self.centre_forces, sprocket, t)
    }

    /// Force on a carrier \[N\]; none before one was set.
    pub(crate) fn carrier_force(&self, tensioner: usize, t: f64) -> Option<[f64; 2]> {
        pair(&self.carrier_forces, tensioner, t)
    }

    /// Forces on rollers that somebody has pulled at.
    pub(crate) fn roller_forces(&self) -> &[RollerForce] {
        &self.roller_forces
    }

    /// Sets a force on a roller along an axis on its course; `inertias` go with the coordinates of the roller.
    pub(crate) fn set_roller_force(
        &mut self,
        (roller, inertias): (usize, Vec<f64>),
        axis: usize,
        t: f64,
        to: Course,
    ) {
        let forces = &mut self.roller_forces;
        let place = forces.iter().position(|known| known.roller == roller);
        let place = place.unwrap_or_else(|| {
            forces.push(RollerForce {
                roller,
                ramps: Default::default(),
                inertias,
            });
            forces.len() - 1
        });
        let ramp = &mut forces[place].ramps[axis];
        *ramp = Ramp::new(ramp.at(t), t, to);
    }

    /// Sets a force on a centre along an axis on its course.
    pub(crate) fn set_centre_force(&mut self, sprocket: usize, axis: usize, t: f64, to: Course) {
        set(&mut self.centre_forces, 2 * sprocket + axis, t, to);
    }

    /// Sets a force on a carrier along an axis on its course.
    pub(crate) fn set_carrier_force(&mut self, tensioner: usize, axis: usize, t: f64, to: Course) {
        set(&mut self.carrier_forces, 2 * tensioner + axis, t, to);
    }

    /// Sets a torque on its course.
    pub(crate) fn set_torque(&mut self, shaft: usize, t: f64, course: Course) {
        set(&mut self.torques, shaft, t, course);
    }

    /// Sets a force on its course.
    pub(crate) fn set_force(&mut self, tensioner: usize, t: f64, course: Course) {
        set(&mut self.forces, tensioner, t, course);
    }

    /// Remembers the value of a parameter.
    pub(crate) fn tune(&mut self, input: Input, value: f64) {
        self.tuned.retain(|(known, _)| *known != input);
        self.tuned.push((input, value));
    }

    /// Time of the first change after t \[s\], or end of a ramp.
    pub(crate) fn next_change(&self, t: f64) -> Option<f64> {
        let mut times = self.planned.iter().map(|(time, ..)| *time);
        let planned = times.find(|time| *time > t);
        let points = self.centre_forces.iter().chain(&self.carrier_forces);
        let rollers = self.roller_forces.iter().flat_map(|it| &it.ramps);
        let ramps = self.torques.iter().chain(&self.forces).chain(points);
        let ramps = ramps.chain(rollers);
        let ends = ramps.filter_map(|ramp| ramp.next_knot(t));
        ends.chain(planned).reduce(f64::min)
    }
}

/// Values along both axes; none before any ramp of the list was set.
fn pair(ramps: &[Ramp], index: usize, t: f64) -> Option<[f64; 2]> {
    let along = |axis: usize| ramps.get(2 * index + axis).map(|ramp| ramp.at(t));
    let x = along(0)?;
    Some([x, along(1).unwrap_or(0.0)])
}

fn set(ramps: &mut Vec<Ramp>, index: usize, t: f64, course: Course) {
    if ramps.len() <= index {
        ramps.resize(index + 1, Ramp::default());
    }
    ramps[index] = Ramp::new(ramps[index].at(t), t, course);
}
