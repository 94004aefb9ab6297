//! Tensioners, compiled: a carrier with its coordinate and what it carries.

use chaindrive_geometry::{Point, Vector};

use crate::chains::Way;
use crate::tensioner::{Extension, Reduced, Slopes, Weight};
use crate::{Carrier, Push, PushForce};

/// A tensioner in the system.
#[derive(Clone, Debug)]
pub(crate) struct Slide {
    pub(crate) name: String,
    pub(crate) carrier: Carrier,
    pub(crate) push: Push,
    /// Its own inertia \[kg or kg m²\].
    pub(crate) own: f64,
    /// Inertia at assembly with all that it carries \[kg or kg m²\].
    pub(crate) inertia: f64,
    /// Degree of freedom; none while locked.
    pub(crate) dof: Option<usize>,
    /// Place of its push's state among the first-order states; none without one.
    pub(crate) state: Option<usize>,
    /// Masses that it carries.
    pub(crate) carried: Vec<Weight>,
}

/// Where a carrier is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pose {
    pub(crate) coordinate: f64,
    pub(crate) rate: f64,
}

impl Slide {
    pub(crate) fn pose(&self, q: &[f64], v: &[f64]) -> Pose {
        self.dof.map_or_else(Pose::default, |dof| Pose {
            coordinate: q[dof],
            rate: v[dof],
        })
    }

    /// Place and velocity of a point that is at `at` when s = 0.
    pub(crate) fn carry(&self, pose: Pose, at: Point) -> (Point, Vector) {
        let (place, first) = self.carrier.carry(pose.coordinate, at);
        (place, first * pose.rate)
    }

    /// Generalised force of a force at a carried point.
    pub(crate) fn project(&self, pose: Pose, force: [f64; 2], place: Point) -> f64 {
        let [first, _] = self.carrier.ways(pose.coordinate, place);
        first.x * force[0] + first.y * force[1]
    }

    /// How a carried point goes on with the coordinate; none where it stands still.
    pub(crate) fn way(&self, pose: Pose, place: Point) -> Option<Way> {
        let entry = self.dof?;
        let [first, second] = self.carrier.ways(pose.coordinate, place);
        (first != Vector::zeros()).then_some(Way {
            entry,
            first,
            second,
        })
    }

    /// The coordinate that turns what it carries, and how far; none where it does not turn.
    pub(crate) fn turn(&self) -> Option<(usize, f64)> {
        let turning = self.carrier.turning();
        let turns = turning.abs() > 0.0;
        self.dof.filter(|_| turns).map(|dof| (dof, turning))
    }

    /// State of its push; nothing without one.
    fn state(&self, z: &[f64]) -> f64 {
        self.state.map_or(0.0, |state| z[state])
    }

    /// The push, and the lever by which it acts on the coordinate.
    pub(crate) fn pushed(&self, pose: Pose, z: &[f64]) -> (PushForce, f64) {
        let Extension { length, lever } = self.carrier.extension(pose.coordinate);
        let force = self.push.force(length, lever * pose.rate, self.state(z));
        (force, lever)
    }

    /// What the push stores \[J\].
    pub(crate) fn stored(&self, pose: Pose, z: &[f64]) -> f64 {
        let Extension { length, .. } = self.carrier.extension(pose.coordinate);
        self.push.energy(length, self.state(z))
    }

    /// Pressure in the push \[Pa\], where there is one.
    pub(crate) fn pressure(&self, pose: Pose, z: &[f64]) -> Option<f64> {
        let Extension { length, .. } = self.carrier.extension(pose.coordinate);
        self.push.pressure(length, self.state(z))
    }

    /// What a state of the push adds to the derivatives by the coordinate.
    pub(crate) fn slopes(&self, pose: Pose, z: &[f64]) -> Slopes {
        if self.state.is_none() {
            return Slopes::default();
        }
        let Extension { length, lever } = self.carrier.extension(pose.coordinate);
        let slopes = self.push.slopes(length, self.state(z));
        // Q = F ∂x/∂s: stiffness by the square of the lever, flows and forces by itself
        Slopes {
            stiffness: slopes.stiffness * lever * lever,
            by_state: slopes.by_state * lever,
            flow: slopes.flow * lever,
            settling: slopes.settling,
            largest: [slopes.largest[0] * lever * lever, slopes.largest[1]],
        }
    }

    /// The state at which nothing flows in the push.
    pub(crate) fn settled(&self, pose: Pose) -> Option<f64> {
        let Extension { length, .. } = self.carrier.extension(pose.coordinate);
        self.push.settled(length)
    }

    /// Square of the push's lever over the inertia at assembly \[1/kg\].
    pub(crate) fn lightness(&self) -> f64 {
        let lever = self.carrier.extension(0.0).lever;
        lever * lever / self.inertia
    }

    /// ω² of the push's spring alone.
    pub(crate) fn own_rate(&self) -> f64 {
        self.push.stiffness() * self.lightness()
    }

    /// Inertia as it now is.
    pub(crate) fn reduced(&self, pose: Pose) -> Reduced {
        self.carrier
            .reduced(pose.coordinate, self.own, &self.carried)
    }

    /// Generalised force of the weight of all that it moves.
    pub(crate) fn weight(&self, pose: Pose, gravity: Vector) -> f64 {
        self.carrier
            .weight(pose.coordinate, self.own, &self.carried, gravity)
    }

    /// Masses whose weight moves it, and where they are at assembly.
    pub(crate) fn weights(&self) -> impl Iterator<Item = Weight> {
        let own = self.carrier.own_weight(self.own);
        self.carried.iter().copied().chain(own)
    }
}
