//! Inputs that act on a drive from outside while it moves: torques, forces and motions that somebody sets.
//!
//! A value holds from the moment at which it is set until another one is. Every change is an event: a step lands on its
//! time, and the next one begins with the new forces.

use serde::{Deserialize, Serialize};

/// Inputs that can be set from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Input {
    /// Torque on a free shaft \[N m\], counter-clockwise positive, beside those of the scene.
    Torque {
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
}

/// The values at present, and the changes to come.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Inputs {
    pub(crate) torques: Vec<f64>,
    pub(crate) forces: Vec<f64>,
    /// Changes to come, the earliest first: of equal times in the order of their planning.
    pub(crate) planned: Vec<(f64, Input, f64)>,
}

impl Inputs {
    /// Torque on a shaft \[N m\].
    pub(crate) fn torque(&self, shaft: usize) -> f64 {
        self.torques.get(shaft).copied().unwrap_or(0.0)
    }

    /// Force on a tensioner \[N or N m\].
    pub(crate) fn force(&self, tensioner: usize) -> f64 {
        self.forces.get(tensioner).copied().unwrap_or(0.0)
    }

    /// Time of the first change after t \[s\].
    pub(crate) fn next_change(&self, t: f64) -> Option<f64> {
        let mut times = self.planned.iter().map(|(time, ..)| *time);
        times.find(|time| *time > t)
    }
}
