//! Torques between rigid links: friction of ideal joints, and viscous damping of all.

use chaindrive_integrate::{Moment, kernel};
use pulp::Simd;

use super::hinge::Hinges;
use super::posture::Posture;
use super::{Joining, JointState, Linkage};
use crate::joints::{JointLosses, Joints, Resistance, Turns};
use crate::lanes::{Lane, Lanes, Wide, padded};

impl Linkage {
    /// Adds the torques of the joints to those on the links.
    pub(super) fn resist(
        &self,
        joints: &Joints,
        at: Moment<'_>,
        rates: &mut [f64],
        joint_state: &mut JointState,
        found: &mut Resistance,
    ) {
        // After the joints whole lanes; pins with clearance rub in their bushes.
        joint_state.normal.clear();
        joint_state.normal.resize(padded(self.joints.len()), 0.0);
        match &self.joining {
            Joining::Hinges(hinges) if joints.rub() => self.press(hinges, at, joint_state),
            // What rubs beside the pin is pressed as the pin is.
            Joining::Clearance(_) if joints.rub() => {
                let JointState { normal, pins, .. } = joint_state;
                let count = normal.len().min(pins.force.len());
                normal[..count].copy_from_slice(&pins.force[..count]);
            }
            Joining::Hinges(_) | Joining::Clearance(_) => {}
        }
        let (posture, normal) = (&joint_state.posture, &joint_state.normal);
        let registers = self.series.registers;
        let losses = registers.dispatch(torques(joints, posture, normal, at.t, &mut *found));
        losses.add_to(rates);
        let torque = &mut found.torque;
        if self.series.is_closed() {
            // After the last link is the first joint again.
            torque[self.series.links] = torque[0];
        }
        let links = joint_state.forces[..self.series.links].iter_mut();
        for (force, ends) in links.zip(torque.windows(2)) {
            force.z += ends[0] - ends[1];
        }
    }

    /// Normal forces \[N\] of pins in ideal joints: those without friction.
    ///
    /// Friction changes them by the share μ r/p of itself, a hundredth, which is left out here: their torques are those of these
    /// forces, and what they do and lose is exact.
    fn press(&self, hinges: &Hinges, at: Moment<'_>, joint_state: &mut JointState) {
        hinges.find(self, at, joint_state);
        let JointState {
            normal,
            hinge_forces,
            ..
        } = joint_state;
        for (normal, force) in normal.iter_mut().zip(hinge_forces) {
            *normal = force.norm();
        }
    }

    /// ω² and D of links that turn to and fro against their neighbours.
    ///
    /// ```text
    /// I φ̈_i = M_i − M_{i+1},   M_i = −σ (φ_i − φ_{i−1}) − c (ω_i − ω_{i−1}):   ω² ≤ 4 σ/I,   D ≤ 4 c/I
    /// ```
    pub(super) fn joint_rates(&self, slopes: [f64; 2]) -> [f64; 2] {
        slopes.map(|slope| 4.0 * slope / self.shapes.least_inertia)
    }
}

kernel!(
    /// The torques of all joints.
    fn torques<'a, S: Simd>(
        w: Wide<S>,
        joints: &'a Joints,
        posture: &'a Posture,
        normal: &'a [f64],
        t: f64,
        found: &'a mut Resistance,
    ) -> JointLosses {
        let n = normal.len();
        let Posture { before, after, .. } = posture;
        let spins = Spins {
            before: w.lanes(&before.spin[..n]),
            after: w.lanes(&after.spin[..n]),
            normal: w.lanes(normal),
        };
        joints.resist(w, t, found, &spins)
    }
);

/// Angular speeds of the links before and after every joint, and the force on its pin.
struct Spins<'a, S: Simd> {
    before: Lanes<'a, S>,
    after: Lanes<'a, S>,
    normal: Lanes<'a, S>,
}

impl<S: Simd> Turns<S> for Spins<'_, S> {
    #[inline(always)]
    fn at(&self, _w: Wide<S>, lane: usize) -> [Lane<S>; 2] {
        let rate = self.after.get(lane) - self.before.get(lane);
        [rate, self.normal.get(lane)]
    }
}
