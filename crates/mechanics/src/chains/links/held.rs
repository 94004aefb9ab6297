//! Ideal joints in an implicit step: very heavy rows.
//!
//! ```text
//! (M + c C + k K + W Jᵀ J) y = −(c C + k K) b + W Jᵀ (s − J b),   x = b + y
//! ```
//!
//! s is what J x shall be. The rows cost digits, so the system is solved for the difference y from b: what nothing
//! resists, the momentum of a free chain among it, stays to the last bit.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;
use nalgebra::{DVector, Vector3};

use super::implicit::{Row, Sum};
use super::{JointState, Mate, cross};

/// Prescribed value of J x at the hinges.
#[derive(Clone, Copy)]
pub(super) enum Prescribed<'a> {
    /// That of J b.
    Kept,
    /// These values, by joint.
    Given(&'a [Vector]),
}

/// How much stiffer a hinge is than everything else in the matrix.
///
/// J x is then right to about 1e-5 of y, and the stabilisation of the hinges takes the rest. Rounding grows with the
/// square: momentum leaks by 1e-7 of y, and would by a thousandth with 1e7.
const HINGE: f64 = 1e5;

impl Sum<'_> {
    /// Adds W Jᵀ J, and W Jᵀ (s − J b) on the right.
    pub(super) fn add_hinges(
        &mut self,
        joint_state: &JointState,
        weights: Weights,
        b: &[f64],
        asked: Prescribed<'_>,
    ) {
        let linkage = self.linkage;
        let heaviest = linkage
            .bodies
            .iter()
            .fold(0.0_f64, |m, body| m.max(body.mass));
        let stiffest = joint_state.elements.iter().fold(0.0_f64, |m, element| {
            m.max(weights.damping * element.damping + weights.stiffness * element.stiffness)
        });
        let weight = HINGE * (heaviest + stiffest);
        for (index, joint) in linkage.joints.iter().enumerate() {
            let Some(mates) = joint.pair else { continue };
            let sides = mates.map(|mate| match mate {
                Mate::Link { link, end } => Some((link, joint_state.posture.arm(link, end))),
                Mate::Ground(_) => None,
            });
            for direction in [Vector::x(), Vector::y()] {
                let [hole, pin] = sides.map(|side| {
                    side.map(|(body, arm)| {
                        let row = Vector3::new(direction.x, direction.y, cross(arm, direction));
                        let known = Vector3::from_column_slice(&b[3 * body..3 * body + 3]);
                        (body, row, row.dot(&known))
                    })
                });
                if let Prescribed::Given(values) = asked {
                    let there = pin.map_or(0.0, |p| p.2) - hole.map_or(0.0, |h| h.2);
                    let missing = direction.dot(&values[index]) - there;
                    for (side, sign) in [(pin, 1.0), (hole, -1.0)] {
                        if let Some((body, row, _)) = side {
                            self.force(body, row * (sign * weight * missing));
                        }
                    }
                }
                match (pin, hole) {
                    (Some((a, row, _)), Some((b, other, _))) => {
                        self.square(Some(a), row, Row::Body(b, other), weight);
                    }
                    (Some((body, row, _)), None) | (None, Some((body, row, _))) => {
                        self.square(Some(body), row, Row::Nothing, weight);
                    }
                    (None, None) => {}
                }
            }
        }
    }

    /// What the joint forces add to the rotation of the links: λ·arm, where it holds them.
    pub(super) fn add_hinge_turns(&mut self, joint_state: &JointState, weight: f64) {
        for (joint, force) in self.linkage.joints.iter().zip(&joint_state.hinge_forces) {
            let Some(mates) = joint.pair else { continue };
            for (mate, force) in mates.into_iter().zip([-force, *force]) {
                if let Mate::Link { link, end } = mate {
                    let arm = joint_state.posture.arm(link, end);
                    self.add_turn(link, weight * force.dot(&arm).max(0.0));
                }
            }
        }
    }

    /// Takes the product of the matrix so far with b from the right-hand side.
    pub(super) fn subtract_known(&mut self, b: &[f64]) {
        let links = self.linkage.links;
        let body = |index: usize| Vector3::from_column_slice(&b[3 * index..3 * index + 3]);
        let first = 3 * usize::from(self.linkage.closed);
        let edge = DVector::from_fn(self.border, |j, _| {
            if j < first {
                b[3 * (links - 1) + j]
            } else {
                b[self.linkage.coordinates() + j - first]
            }
        });
        for index in 0..self.loose.len() {
            let known = body(links + index);
            let roller = &self.loose[index];
            let mut own = roller.own * known;
            let mut on_link = None;
            if let Some(link) = roller.link {
                own += roller.coupling.transpose() * body(link);
                on_link = Some((link, roller.coupling * known));
            }
            for &(j, row) in &roller.beside {
                own += row * edge[j];
                self.blocks.right_border[j] -= row.dot(&known);
            }
            self.loose[index].right -= own;
            if let Some((link, force)) = on_link {
                self.force(link, -force);
            }
        }
        self.blocks.subtract_product(body, &edge);
    }
}
