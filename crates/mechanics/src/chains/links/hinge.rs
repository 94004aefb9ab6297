//! Ideal joints: the forces that keep the ends of neighbouring links together.
//!
//! ```text
//! J M⁻¹ Jᵀ λ = −(J a + J̇ v − s̈ + 2 α ċ + α² c),     a ← a + M⁻¹ Jᵀ λ
//! c = P_pin − P_hole,   λ: force on the pin
//! ```
//!
//! The rate α draws what rounding and the time stepping leave of c back to zero.
//!
//! # Source
//! J. Baumgarte, *Comput. Methods Appl. Mech. Eng.* **1**, 1972, 1–16 (stabilisation).

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::reactions::{limbs, mobility};
use super::{JointState, Linkage, Mate, supplied, turned};
use crate::End;
use crate::energy::Flow;

/// Ideal joints.
#[derive(Clone, Debug)]
pub(crate) struct Hinges {
    /// Rate α of the stabilisation \[1/s\].
    pub(crate) rate: f64,
}

impl Hinges {
    /// Factors J M⁻¹ Jᵀ where the links are. Where nothing can keep the joints together their forces are not numbers, which
    /// stops the run.
    pub(super) fn factor(linkage: &Linkage, joint_state: &mut JointState) {
        let JointState {
            reactions,
            posture,
            hinge_forces,
            ..
        } = joint_state;
        reactions.factor(linkage, posture, |link, place, force| {
            let body = &linkage.bodies[link];
            mobility(body.mass, body.inertia, place, force)
        });
        hinge_forces.clear();
        hinge_forces.resize(linkage.joints.len(), Vector::zeros());
    }

    /// Adds the joint forces to those on the bodies and writes them down by joint.
    pub(crate) fn hold(
        &self,
        linkage: &Linkage,
        at: Moment<'_>,
        rates: &mut [f64],
        joint_state: &mut JointState,
    ) {
        self.find(linkage, at, joint_state);
        for (index, joint) in linkage.joints.iter().enumerate() {
            let Some(mates) = joint.pair else {
                continue;
            };
            let force = joint_state.hinge_forces[index];
            for limb in limbs(mates, &joint_state.posture) {
                if let Some(body) = limb.body {
                    joint_state.forces[body] += limb.load(force);
                }
            }
            let [hole, pin] = mates.map(|mate| linkage.part(mate, at, &joint_state.posture));
            rates[Flow::Motions as usize] += supplied(&mates, force, &hole, &pin);
        }
    }

    /// Writes down the joint forces that keep the ends together under the forces on the bodies.
    pub(super) fn find(&self, linkage: &Linkage, at: Moment<'_>, joint_state: &mut JointState) {
        let JointState {
            reactions,
            posture,
            hinge_forces,
            forces,
            ..
        } = joint_state;
        for (row, joint) in reactions.held().enumerate() {
            let Some(mates) = linkage.joints[joint].pair else {
                continue;
            };
            let [hole, pin] = mates.map(|mate| linkage.part(mate, at, posture));
            // 2 α ċ + α² c
            let mut drift = (pin.velocity - hole.velocity) * (2.0 * self.rate)
                + (pin.place - hole.place) * (self.rate * self.rate);
            for (mate, part, sign) in [(mates[0], &hole, -1.0), (mates[1], &pin, 1.0)] {
                match part.body {
                    Some(body) => {
                        let b = &linkage.bodies[body];
                        let across = turned(part.arm);
                        let f = &forces[body];
                        // J a + J̇ v = F/m + α ẑ × r − ω² r
                        let acceleration = Vector::new(f.x, f.y) / b.mass
                            + across * (f.z / b.inertia)
                            - part.arm * (part.spin * part.spin);
                        drift += acceleration * sign;
                    }
                    None => drift += ground_acceleration(linkage, mate, at) * sign,
                }
            }
            reactions.right[row] = -drift;
        }
        reactions.solve();
        for (joint, force) in reactions.held().zip(&reactions.right) {
            hinge_forces[joint] = *force;
        }
    }
}

fn ground_acceleration(linkage: &Linkage, mate: Mate, at: Moment<'_>) -> Vector {
    match mate {
        Mate::Ground(end) => match &linkage.ends[end].end {
            End::Driven { x, y } => Vector::new(x.at(at.t).acceleration, y.at(at.t).acceleration),
            End::Free | End::Fixed | End::Pulled { .. } => Vector::zeros(),
        },
        Mate::Link { .. } => Vector::zeros(),
    }
}
