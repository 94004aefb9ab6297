//! Tensioners, compiled: a carrier with its coordinate and what it carries.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Prediction;

use crate::seam::Way;
use crate::tensioner::{Extension, ReducedInertia, Slopes, Weight};
use crate::{Carrier, Forces, Push, PushForce};

/// A tensioner in the system.
#[derive(Clone, Debug)]
pub(crate) struct Slide {
    pub(crate) name: String,
    pub(crate) carrier: Carrier,
    pub(crate) push: Push,
    /// Inertia at assembly with all that it carries \[kg or kg m²\].
    pub(crate) inertia: f64,
    /// Degree of freedom; none while locked.
    pub(crate) dof: Option<usize>,
    /// Place of its push's state among the first-order states; none without one.
    pub(crate) state: Option<usize>,
    /// Masses that it carries.
    pub(crate) carried: Vec<Weight>,
    /// Forces on it from outside, beside those on the centres that it carries.
    pub(crate) forces: Forces,
    /// Point of it on which they act, at assembly; none of a slide, all points of which move alike.
    pub(crate) forced_at: Option<Point>,
}

/// Pose of a carrier.
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

    /// Mobility of the carrier under a force at a place, as assembled \[1/kg\].
    pub(crate) fn mobility(&self, at: Point) -> f64 {
        let lever = || self.carrier.squared_lever(0.0, at);
        self.dof.map_or(0.0, |_| lever() / self.inertia)
    }

    /// Generalised force of a force at a carried point.
    pub(crate) fn project(&self, pose: Pose, force: [f64; 2], place: Point) -> f64 {
        let [first, _] = self.carrier.ways(pose.coordinate, place);
        first.x * force[0] + first.y * force[1]
    }

    /// Derivatives of a carried point by the coordinate; none where it does not move.
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
    pub(crate) fn state(&self, z: &[f64]) -> f64 {
        self.state.map_or(0.0, |state| z[state])
    }

    /// Rate of its coordinate at the end of a step for which it was predicted, from the acceleration that it was predicted to have.
    ///
    /// ```text
    /// ṡ⁺ = ṡ + ½ h (s̈ − s̈₀)/(1 + ½ h D)
    /// ```
    ///
    /// with the damping rate D of the push at ṡ.
    pub(crate) fn rate_ahead(
        &self,
        pose: Pose,
        state: f64,
        acceleration: f64,
        prediction: Prediction<'_>,
    ) -> f64 {
        let before = self.dof.map_or(0.0, |dof| prediction.a[dof]);
        let half = prediction.half_step;
        pose.rate + half * (acceleration - before) / (1.0 + half * self.damping_at(pose, state))
    }

    /// State of its push at the end of a step for which it was predicted; nothing without one.
    ///
    /// ```text
    /// z⁺ = z + ½ h (ż − ż₀)/(1 + ½ h λ)
    /// ```
    ///
    /// with the rate λ at which z settles where the valves stand as at z.
    pub(crate) fn state_ahead(&self, pose: Pose, z: &[f64], prediction: Prediction<'_>) -> f64 {
        if self.state.is_none() {
            return 0.0;
        }
        let (push, _) = self.pushed(pose, self.state(z));
        let Slopes { settling, .. } = self.slopes(pose, self.state(z));
        let before = self.state(prediction.flow);
        let half = prediction.half_step;
        self.state(z) + half * (push.flow - before) / (1.0 + half * settling)
    }

    /// The push at a state of it, and the lever by which it acts on the coordinate.
    pub(crate) fn pushed(&self, pose: Pose, state: f64) -> (PushForce, f64) {
        let Extension { length, lever } = self.carrier.extension(pose.coordinate);
        let force = self.push.force(length, lever * pose.rate, state);
        (force, lever)
    }

    /// Energy stored in the push \[J\].
    pub(crate) fn stored(&self, pose: Pose, z: &[f64]) -> f64 {
        let Extension { length, .. } = self.carrier.extension(pose.coordinate);
        self.push.energy(length, self.state(z))
    }

    /// Pressure in the push \[Pa\], where there is one.
    pub(crate) fn pressure(&self, pose: Pose, z: &[f64]) -> Option<f64> {
        let Extension { length, .. } = self.carrier.extension(pose.coordinate);
        self.push.pressure(length, self.state(z))
    }

    /// Contribution of the state of the push to the derivatives by the coordinate.
    pub(crate) fn slopes(&self, pose: Pose, state: f64) -> Slopes {
        if self.state.is_none() {
            return Slopes::default();
        }
        let Extension { length, lever } = self.carrier.extension(pose.coordinate);
        let slopes = self.push.slopes(length, state);
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

    /// ω² of the push's spring alone, where it is assembled.
    pub(crate) fn own_rate(&self) -> f64 {
        self.push.stiffness(0.0) * self.lightness()
    }

    /// Damping rate of the push at a rate: its law is made of straight lines.
    fn damping_at(&self, pose: Pose, state: f64) -> f64 {
        let speed = 1e-9_f64.max(1e-6 * pose.rate.abs());
        let faster = Pose {
            rate: pose.rate + speed,
            ..pose
        };
        let [(here, lever), (there, _)] = [pose, faster].map(|pose| self.pushed(pose, state));
        // D = −∂Q/∂ṡ/I,   Q = F ∂x/∂s
        let slope = (here.damping - there.damping) * lever / speed;
        slope.max(0.0) / self.reduced(pose).inertia
    }

    /// Damping rate of the push alone, where it damps most.
    pub(crate) fn own_damping(&self) -> f64 {
        self.push.damping() * self.lightness()
    }

    /// Inertia as it now is.
    pub(crate) fn reduced(&self, pose: Pose) -> ReducedInertia {
        self.carrier.reduced(pose.coordinate, &self.carried)
    }

    /// Generalised force of the weight of all that it moves.
    pub(crate) fn weight(&self, pose: Pose, gravity: Vector) -> f64 {
        self.carrier.weight(pose.coordinate, &self.carried, gravity)
    }

    /// Masses whose weight moves it, and where they are at assembly.
    pub(crate) fn weights(&self) -> impl Iterator<Item = Weight> {
        let own = self.carrier.own_weight();
        self.carried.iter().copied().chain(own)
    }
}
