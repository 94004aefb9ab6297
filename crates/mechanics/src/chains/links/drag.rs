//! Drag of oil or air across rigid links.
//!
//! ```text
//! F = −b ℓ v_n n   in the middle of a link,   M = −b ℓ³ ω/12,   P = b ℓ v_n² + b ℓ³ ω²/12
//! ```
//!
//! That is −b v_n on every piece of the link. Every method takes it explicitly.

use nalgebra::Vector3;

use super::{JointState, Linkage};
use crate::joints::{cross, turned};

impl Linkage {
    /// Adds the drag to the forces on the links, and returns the power \[W\] lost by it.
    pub(super) fn drag_forces(&self, joint_state: &mut JointState) -> f64 {
        let mut loss = 0.0;
        for link in 0..self.series.links {
            let [first, second] = [0, 1].map(|end| joint_state.posture.tip(link, end));
            let line = second.arm - first.arm;
            let length = line.norm();
            let across = turned(line) / length;
            // v_n in the middle, and ω = n·(v₁ − v₀)/ℓ
            let speed = 0.5 * across.dot(&(first.velocity + second.velocity));
            let turning = across.dot(&(second.velocity - first.velocity)) / length;
            let force = across * (-self.drag * length * speed);
            let moment = -self.drag * length.powi(3) / 12.0 * turning;
            let middle = (first.arm + second.arm) * 0.5;
            joint_state.forces[link] +=
                Vector3::new(force.x, force.y, cross(middle, force) + moment);
            loss += self.drag * length * speed * speed - moment * turning;
        }
        loss
    }

    /// Largest damping rate of a link by itself \[1/s\].
    pub(super) fn drag_rate(&self) -> f64 {
        self.drag * self.shapes.most_dragged
    }
}
