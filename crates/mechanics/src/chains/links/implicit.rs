//! (M + c C + k K) x = M b: the linear system of an implicit step.
//!
//! ```text
//! C = Σ d Jₙᵀ Jₙ + Σ r J_sᵀ J_s,      K = Σ k Jₙᵀ Jₙ + Σ F/|e| J_tᵀ J_t + …
//! ```
//!
//! Jₙ, J_t and J_s give closing speed, motion of the circles' centres across, and slip from the velocities. C is
//! symmetric: that friction also follows the normal force is left to the explicit part. Free rollers touch
//! their bush and a wheel only; they are eliminated first and leave the links' pattern as it is.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;

use super::equations::Sum;
use super::ideal_joints::HingeTarget;
use super::{Joining, JointState, Linkage};
use crate::bodies::GroupBodies;
use crate::chains::links::Work;

/// Share of a link's mass that a step need not carry across a contact. *Assumed*.
const SOFT: f64 = 0.05;

impl Linkage {
    /// x ← (M + c C + k K)⁻¹ M x of the chain and, after it, the bodies, at the state that the record was left by.
    pub(super) fn implicit_step(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        work: &mut Work,
        x: &mut [f64],
    ) -> bool {
        let Work {
            joint_state,
            impulses,
            ..
        } = work;
        let weights = if weights.once && !self.carries() {
            Weights {
                stiffness: 0.0,
                ..weights
            }
        } else {
            weights
        };
        if let Joining::Hinges(hinges) = &self.joining {
            let share = hinges.share(weights);
            return self.solve_held(bodies, weights, joint_state, x, HingeTarget::Kept(share));
        }
        if weights.once {
            return self.step(bodies, weights, joint_state, impulses, x);
        }
        self.eliminate(bodies, weights, joint_state, x)
    }

    /// Whether steps of one solution add the contact stiffness to the inertia: in joints with play. Free rollers between two contacts,
    /// lighter than what they would have to carry, strike twice as hard then.
    pub(crate) fn carries(&self) -> bool {
        matches!(self.joining, Joining::Clearance(_)) && self.free_rollers.is_none()
    }

    /// Stiffness across a contact \[N/m\] up to which a step leaves it to the forces at its beginning, none below zero.
    ///
    /// ```text
    /// h²/4 k ≤ m/20   ⇒   ω h ≤ 0.45
    /// ```
    ///
    /// A mode that slow errs by a hundredth of its frequency either way, and the seat of a tooth holds a roller across with no more, which
    /// spares a row a tooth.
    pub(super) fn soft(&self, weights: Weights) -> f64 {
        SOFT * self.shapes.lightest[0] / weights.stiffness
    }

    /// The least change of coordinates or velocities, of which there are `count`, that moves every pin towards its hole by what is
    /// given; least in kinetic energy.
    pub(crate) fn nearest(
        &self,
        bodies: GroupBodies<'_>,
        joint_state: &mut JointState,
        towards: &[Vector],
        count: usize,
    ) -> Option<Vec<f64>> {
        let none = Weights {
            once: false,
            damping: 0.0,
            stiffness: 0.0,
        };
        let mut change = vec![0.0; count];
        let asked = HingeTarget::Given(towards);
        self.solve_held(bodies, none, joint_state, &mut change, asked)
            .then_some(change)
    }

    pub(super) fn eliminate(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &mut JointState,
        x: &mut [f64],
    ) -> bool {
        let mut equations = std::mem::take(&mut joint_state.equations);
        // The last link of a closed chain touches both ends of the row, and stands in the border.
        let row = self.series.links - usize::from(self.series.is_closed());
        let mut sum = Sum::new(self, &mut equations, row, x);
        sum.add_masses(bodies, weights, x);
        self.each_element(joint_state, |element| {
            sum.add(element, &joint_state.mounts, weights, x);
        });
        let solved = sum.eliminate_rollers() && sum.blocks.solve();
        if solved {
            sum.read(x);
        }
        joint_state.equations = equations;
        solved
    }
}
