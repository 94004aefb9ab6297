//! One closed contact, as the forces it exerts and as rows of the implicit system.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Mount;

/// The other side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Partner {
    /// Something that does not answer: the frame, or a bush whose motion is given.
    Ground,
    /// A body of the chain.
    Body(usize),
    /// A wheel or rail, by its place among the mounts.
    Mount(usize),
}

/// A closed contact between a body `a` and its partner `b`.
///
/// ```text
/// n from b's material into a's, seen from the centre of a's circle outward: a is pressed along −n
/// closing = n·(v_a − v_b),   slip = t·(v_a − v_b) + ℓ_a ω_a − ℓ_b ω_b,   t = ẑ × n
/// on a:  −F n + R t,  moment  arm × (−F n + R t) + ℓ_a R
/// ```
///
/// v is the velocity of the circles' centres, arm leads from a body's centre of mass to it, and ℓ
/// from there along n to the touching point, which is the same for both.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Element {
    /// Joint that it stands at.
    pub(crate) joint: usize,
    pub(crate) a: Option<usize>,
    pub(crate) b: Partner,
    pub(crate) arm_a: Vector,
    pub(crate) arm_b: Vector,
    /// Centre of b's arc from its centre of mass, or from the origin of its frame \[m\].
    pub(crate) pivot_b: Vector,
    pub(crate) lever_a: f64,
    pub(crate) lever_b: f64,
    pub(crate) normal: Vector,
    /// Normal force F \[N\].
    pub(crate) force: f64,
    /// Friction R \[N\] on a along t.
    pub(crate) rub: f64,
    /// ∂F/∂δ \[N/m\].
    pub(crate) stiffness: f64,
    /// ∂F/∂δ̇ \[N s/m\].
    pub(crate) damping: f64,
    /// −∂R/∂slip \[N s/m\].
    pub(crate) drag: f64,
    /// The same as a secant, |R/slip|: with it a step cannot carry the slip beyond zero, where the tangent of
    /// a saturated friction would let it chatter.
    pub(crate) secant: f64,
    /// Stiffness across, from the turning of the normal \[N/m\].
    pub(crate) across: f64,
    /// Closing speed \[m/s\].
    pub(crate) closing: f64,
}

/// `ẑ·(a × b)`.
pub(crate) fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// ẑ × v.
pub(crate) fn turned(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

impl Element {
    /// Weights of its normal and its tangent in the matrix of a step of one solution, where the forces by themselves would change
    /// its slip by `change`.
    ///
    /// ```text
    /// c d + k ∂F/∂δ,   c r + k F/|e|
    /// ```
    ///
    /// r is the secant where friction is about to stop the slip, and the slope where the slip grows: the secant would hold it back
    /// with more than the friction. Below `soft` \[N/m\] F/|e| is left to the forces, as chains of rigid links say.
    pub(crate) fn step_weights(&self, weights: Weights, soft: f64, change: f64) -> [f64; 2] {
        let drag = if self.rub * change > 0.0 {
            self.secant
        } else {
            self.drag.min(self.secant)
        };
        [
            weights.damping * self.damping + weights.stiffness * self.stiffness,
            weights.damping * drag + weights.stiffness * self.stiffly_across(soft),
        ]
    }

    /// F/|e| \[N/m\] where it holds, and with no less than `soft`.
    pub(crate) fn stiffly_across(&self, soft: f64) -> f64 {
        if self.across > soft { self.across } else { 0.0 }
    }

    pub(crate) fn tangent(&self) -> Vector {
        turned(self.normal)
    }

    /// Force on a \[N\].
    pub(crate) fn push(&self) -> Vector {
        self.tangent() * self.rub - self.normal * self.force
    }

    /// Moment on a about its centre of mass \[N m\].
    pub(crate) fn moment_a(&self, push: Vector) -> f64 {
        cross(self.arm_a, push) + self.lever_a * self.rub
    }

    /// Moment on b about its centre of mass, or about the origin of its frame \[N m\].
    pub(crate) fn moment_b(&self, push: Vector) -> f64 {
        -cross(self.arm_b, push) - self.lever_b * self.rub
    }
}

/// A row over the unknowns of the partner.
#[derive(Clone, Copy)]
pub(crate) enum Row {
    Nothing,
    Body(usize, Vector3<f64>),
    /// Coordinates of wheels and tensioners, unused ones `usize::MAX`.
    Border([(usize, f64); 3]),
}

/// Derivatives of the partner's motion along a direction at the circle's centre, with a lever for its rotation.
pub(crate) fn partner_row(
    element: &Element,
    mounts: &[Mount],
    direction: Vector,
    lever: f64,
) -> Row {
    match element.b {
        Partner::Ground => Row::Nothing,
        Partner::Body(body) => Row::Body(
            body,
            Vector3::new(
                direction.x,
                direction.y,
                cross(element.arm_b, direction) + lever,
            ),
        ),
        Partner::Mount(index) => {
            let mount = &mounts[index];
            let mut entries = [(usize::MAX, 0.0); 3];
            for (entry, shift) in entries.iter_mut().zip(&mount.shifts) {
                if let Some((j, shift)) = shift {
                    *entry = (*j, direction.dot(shift));
                }
            }
            if let Some((j, ratio)) = mount.turn {
                entries[2] = (j, (direction.dot(&turned(element.arm_b)) + lever) * ratio);
            }
            Row::Border(entries)
        }
    }
}
