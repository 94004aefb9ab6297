//! Ideal joints: the forces that keep the ends of neighbouring links together.
//!
//! ```text
//! J M⁻¹ Jᵀ λ = −(J a + J̇ v − s̈ + 2 α ċ + α² c),     a ← a + M⁻¹ Jᵀ λ
//! c = P_pin − P_hole,   λ: force on the pin
//! ```
//!
//! Two unknowns a joint, neighbours coupled through the link between them: a cyclic
//! block-tridiagonal system, solved exactly. The rate α draws what rounding and the time stepping
//! leave of c back to zero.
//!
//! # Source
//! J. Baumgarte, *Comput. Methods Appl. Mech. Eng.* **1**, 1972, 1–16 (stabilisation).

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;
use nalgebra::{Matrix2, Vector2, Vector3};

use super::{JointState, Linkage, Mate, cross, supplied, turned};
use crate::End;
use crate::energy::Flow;

/// Ideal joints.
#[derive(Clone, Debug)]
pub(crate) struct Hinges {
    /// Rate α of the stabilisation \[1/s\].
    pub(crate) rate: f64,
}

/// One side of a hinge: its link with place along it, or the frame.
struct Limb {
    body: Option<usize>,
    arm: Vector,
    sign: f64,
}

impl Hinges {
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
            for limb in limbs(&mates, joint_state) {
                if let Some(body) = limb.body {
                    let push = force * limb.sign;
                    joint_state.forces[body] += Vector3::new(push.x, push.y, cross(limb.arm, push));
                }
            }
            let [hole, pin] = mates.map(|mate| linkage.part(mate, at, &joint_state.posture));
            rates[Flow::Motions as usize] += supplied(&mates, force, &hole, &pin);
        }
    }

    /// Writes down the joint forces that keep the ends together under the forces on the bodies.
    pub(super) fn find(&self, linkage: &Linkage, at: Moment<'_>, joint_state: &mut JointState) {
        let held: Vec<usize> = (0..linkage.joints.len())
            .filter(|&joint| linkage.joints[joint].pair.is_some())
            .collect();
        joint_state.hinge_forces.clear();
        joint_state
            .hinge_forces
            .resize(linkage.joints.len(), Vector::zeros());
        let count = held.len();
        if count == 0 {
            return;
        }
        let mut diagonal = vec![Matrix2::zeros(); count];
        let mut below = vec![Matrix2::zeros(); count];
        let mut right = vec![Vector2::zeros(); count];
        for (row, &joint) in held.iter().enumerate() {
            let Some(mates) = linkage.joints[joint].pair else {
                continue;
            };
            let [hole, pin] = mates.map(|mate| linkage.part(mate, at, &joint_state.posture));
            // 2 α ċ + α² c
            let mut drift = (pin.velocity - hole.velocity) * (2.0 * self.rate)
                + (pin.place - hole.place) * (self.rate * self.rate);
            for (mate, part, sign) in [(mates[0], &hole, -1.0), (mates[1], &pin, 1.0)] {
                match part.body {
                    Some(body) => {
                        let b = &linkage.bodies[body];
                        let across = turned(part.arm);
                        diagonal[row] +=
                            Matrix2::identity() / b.mass + across * across.transpose() / b.inertia;
                        let f = &joint_state.forces[body];
                        // J a + J̇ v = F/m + α ẑ × r − ω² r
                        let acceleration = Vector::new(f.x, f.y) / b.mass
                            + across * (f.z / b.inertia)
                            - part.arm * (part.spin * part.spin);
                        drift += acceleration * sign;
                    }
                    None => drift += ground_acceleration(linkage, mate, at) * sign,
                }
            }
            right[row] = -drift;
            // The next joint in the row, where one link joins the two.
            let next = (row + 1) % count;
            if count > 1
                && let Some(coupling) = coupling(linkage, joint_state, joint, held[next])
            {
                below[row] = coupling;
            }
        }
        let closed = linkage.closed;
        // Where no forces keep the joints together there is no motion either: what is not a number stops the run.
        let forces = solve(&diagonal, &below, &right, closed)
            .unwrap_or_else(|| vec![Vector::repeat(f64::NAN); count]);
        for (&joint, force) in held.iter().zip(&forces) {
            joint_state.hinge_forces[joint] = *force;
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

/// Hole and pin of a joint, with the sign of the joint force on them.
#[inline(always)]
fn limbs(mates: &[Mate; 2], joint_state: &JointState) -> [Limb; 2] {
    [(mates[0], -1.0), (mates[1], 1.0)].map(|(mate, sign)| match mate {
        Mate::Link { link, end } => Limb {
            body: Some(link),
            arm: joint_state.posture.arm(link, end),
            sign,
        },
        Mate::Ground(_) => Limb {
            body: None,
            arm: Vector::zeros(),
            sign,
        },
    })
}

/// Block (second, first) of J M⁻¹ Jᵀ: through the link that has both joints.
fn coupling(
    linkage: &Linkage,
    joint_state: &JointState,
    first: usize,
    second: usize,
) -> Option<Matrix2<f64>> {
    let (a, b) = (linkage.joints[first].pair?, linkage.joints[second].pair?);
    let mut sum = None;
    // The link between joint k and the next one is link k.
    for from in limbs(&a, joint_state) {
        for to in limbs(&b, joint_state) {
            if from.body == Some(first) && to.body == Some(first) {
                let body = &linkage.bodies[first];
                let block = Matrix2::identity() / body.mass
                    + turned(to.arm) * turned(from.arm).transpose() / body.inertia;
                sum = Some(block * (from.sign * to.sign));
            }
        }
    }
    sum
}

/// Share of its stiffest direction below which a block counts as singular: a strand that is straight between two
/// supports to within 1e-6 of its length.
const SINGULAR: f64 = 1e-12;

/// Inverse of a symmetric block that was `whole` before others were eliminated; none if nothing is left in some direction.
fn inverse_of(block: &Matrix2<f64>, whole: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    // The lesser eigenvalue is det/λ, and λ lies between half the trace and the trace.
    let enough = SINGULAR * whole.trace() * block.trace();
    (block.determinant() > enough)
        .then(|| block.try_inverse())
        .flatten()
}

/// Solves the tridiagonal system, cyclic where `closed`; block `below[i]` is (i + 1, i). None if it is singular.
fn solve(
    diagonal: &[Matrix2<f64>],
    below: &[Matrix2<f64>],
    right: &[Vector2<f64>],
    closed: bool,
) -> Option<Vec<Vector2<f64>>> {
    let count = diagonal.len();
    let row = if closed { count - 1 } else { count };
    let mut d = diagonal.to_vec();
    let mut b = right.to_vec();
    // Couplings with the last joint of a closed chain.
    let mut w = vec![Matrix2::zeros(); row];
    let mut corner = diagonal[count - 1];
    let mut corner_right = right[count - 1];
    if closed {
        w[0] += below[count - 1].transpose();
        w[row - 1] += below[row - 1];
    }
    let mut inverse = vec![Matrix2::zeros(); row];
    for i in 0..row {
        inverse[i] = inverse_of(&d[i], &diagonal[i])?;
        let through = inverse[i] * b[i];
        if i + 1 < row {
            let e = below[i];
            d[i + 1] -= e * inverse[i] * e.transpose();
            b[i + 1] -= e * through;
            if closed {
                let fill = w[i] * inverse[i] * e.transpose();
                w[i + 1] -= fill;
            }
        }
        if closed {
            corner -= w[i] * inverse[i] * w[i].transpose();
            corner_right -= w[i] * through;
        }
    }
    let mut x = vec![Vector2::zeros(); count];
    if closed {
        x[count - 1] = inverse_of(&corner, &diagonal[count - 1])? * corner_right;
    }
    for i in (0..row).rev() {
        let mut rest = b[i];
        if i + 1 < row {
            rest -= below[i].transpose() * x[i + 1];
        }
        if closed {
            rest -= w[i].transpose() * x[count - 1];
        }
        x[i] = inverse[i] * rest;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of two-by-two blocks against the dense system.
    #[test]
    fn cyclic_solution_is_exact() {
        let identity = Matrix2::identity();
        let e = Matrix2::new(-0.3, 0.1, 0.05, -0.4);
        let diagonal = vec![identity * 2.0; 4];
        let below = vec![e, e * 0.5, e * 0.7, e * 0.9];
        let right: Vec<Vector2<f64>> = (0..4)
            .map(|i| Vector2::new(f64::from(i), 1.0 - f64::from(i)))
            .collect();
        let x = solve(&diagonal, &below, &right, true).unwrap();
        for i in 0..4 {
            let before = (i + 3) % 4;
            let after = (i + 1) % 4;
            let found =
                diagonal[i] * x[i] + below[before] * x[before] + below[i].transpose() * x[after];
            assert!((found - right[i]).norm() < 1e-13, "row {i}");
        }
    }
}
