//! The two sides of joints: what they belong to, where they are, and how they move.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Array;
use serde::{Deserialize, Serialize};

/// One side of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mate {
    /// An end of a link: 0 towards the joint of its own number, 1 towards the next.
    Link { link: usize, end: usize },
    /// A support at an end of the strand.
    Ground(usize),
}

impl Mate {
    /// Whether it lies after its joint.
    pub(crate) fn is_after(self) -> bool {
        matches!(self, Self::Link { end: 0, .. } | Self::Ground(1))
    }
}

/// A joint of the chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointMates {
    /// The hole and the pin; none where the chain simply ends.
    pub(crate) pair: Option<[Mate; 2]>,
    /// The part that carries the roller.
    pub(crate) carrier: Mate,
}

/// One joint end of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tip {
    /// Place \[m\].
    pub(crate) place: Point,
    /// Velocity \[m/s\].
    pub(crate) velocity: Vector,
    /// From the centre of mass \[m\].
    pub(crate) arm: Vector,
}

/// One of the two sides of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Body that it belongs to; none for the frame.
    pub(crate) body: Option<usize>,
    /// Centre of the circle \[m\].
    pub(crate) place: Point,
    /// Its velocity \[m/s\].
    pub(crate) velocity: Vector,
    /// From the body's centre of mass \[m\].
    pub(crate) arm: Vector,
    /// Angular speed of the body \[rad/s\].
    pub(crate) spin: f64,
}

/// One side of every joint, whole lanes: places, velocities, arms from the centre of mass, angular speeds.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Sides {
    pub(crate) x: Array,
    pub(crate) y: Array,
    pub(crate) vx: Array,
    pub(crate) vy: Array,
    pub(crate) arm_x: Array,
    pub(crate) arm_y: Array,
    pub(crate) spin: Array,
}

impl Sides {
    pub(crate) fn all(&mut self) -> [&mut Array; 7] {
        [
            &mut self.x,
            &mut self.y,
            &mut self.vx,
            &mut self.vy,
            &mut self.arm_x,
            &mut self.arm_y,
            &mut self.spin,
        ]
    }

    #[inline(always)]
    pub(crate) fn tip(&self, joint: usize) -> Tip {
        Tip {
            place: Point::new(self.x[joint], self.y[joint]),
            velocity: Vector::new(self.vx[joint], self.vy[joint]),
            arm: self.arm(joint),
        }
    }

    /// From the centre of mass \[m\].
    #[inline(always)]
    pub(crate) fn arm(&self, joint: usize) -> Vector {
        Vector::new(self.arm_x[joint], self.arm_y[joint])
    }

    pub(crate) fn set(&mut self, joint: usize, part: &Part) {
        self.x[joint] = part.place.x;
        self.y[joint] = part.place.y;
        self.vx[joint] = part.velocity.x;
        self.vy[joint] = part.velocity.y;
        self.arm_x[joint] = part.arm.x;
        self.arm_y[joint] = part.arm.y;
        self.spin[joint] = part.spin;
    }
}

impl Part {
    /// An end of a link that turns with this angular speed.
    pub(crate) fn of_link(link: usize, tip: Tip, spin: f64) -> Self {
        Self {
            body: Some(link),
            place: tip.place,
            velocity: tip.velocity,
            arm: tip.arm,
            spin,
        }
    }
}
