//! Reactions of joints that hold the ends of links together: two unknowns a joint.
//!
//! ```text
//! J A⁻¹ Jᵀ λ = r,     J x = P_pin − P_hole of every joint,   λ: force on the pin
//! ```
//!
//! A has one block a link: its mass and inertia, or what an implicit step makes of them. Neighbours are coupled through the
//! link between them: a cyclic block-tridiagonal system, factored once for all right-hand sides.

use std::ops::Range;

use chaindrive_geometry::Vector;
use nalgebra::{Matrix2, Vector3};

use super::posture::Posture;
use super::{JointMates, Linkage, Mate, cross, turned};

/// The factors, and a right-hand side that becomes the solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reactions {
    /// Joints with two sides, one after the other.
    held: Range<usize>,
    closed: bool,
    diagonal: Vec<Matrix2<f64>>,
    /// Block (i + 1, i); of the last joint of a closed chain that with the first.
    below: Vec<Matrix2<f64>>,
    /// Inverses of what the elimination leaves of the diagonal.
    pivots: Vec<Matrix2<f64>>,
    /// Couplings with the last joint of a closed chain, as the elimination leaves them.
    last: Vec<Matrix2<f64>>,
    /// r, then λ.
    pub(super) right: Vec<Vector>,
}

/// One side of a joint: its link with place along it, or the frame.
pub(super) struct Limb {
    pub(super) body: Option<usize>,
    pub(super) arm: Vector,
    pub(super) sign: f64,
}

impl Limb {
    /// Force and moment on the body under a force on the pin.
    #[inline(always)]
    pub(super) fn load(&self, force: Vector) -> Vector3<f64> {
        let push = force * self.sign;
        Vector3::new(push.x, push.y, cross(self.arm, push))
    }
}

/// Hole and pin of a joint, with the sign of the joint force on them.
#[inline(always)]
pub(super) fn limbs(mates: [Mate; 2], posture: &Posture) -> [Limb; 2] {
    [(mates[0], -1.0), (mates[1], 1.0)].map(|(mate, sign)| match mate {
        Mate::Link { link, end } => Limb {
            body: Some(link),
            arm: posture.arm(link, end),
            sign,
        },
        Mate::Ground(_) => Limb {
            body: None,
            arm: Vector::zeros(),
            sign,
        },
    })
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

/// Joints with two sides: all but free and pulled ends of a strand.
fn held(joints: &[JointMates]) -> Range<usize> {
    let first = joints.iter().position(|joint| joint.pair.is_some());
    let last = joints.iter().rposition(|joint| joint.pair.is_some());
    first
        .zip(last)
        .map_or(0..0, |(first, last)| first..last + 1)
}

impl Reactions {
    /// Sets up J A⁻¹ Jᵀ and factors it; false if it is singular. `between` is the motion of the first place on a link under
    /// a force at the second.
    pub(super) fn factor(
        &mut self,
        linkage: &Linkage,
        posture: &Posture,
        between: impl Fn(usize, Vector, Vector) -> Matrix2<f64>,
    ) -> bool {
        self.held = held(&linkage.joints);
        self.closed = linkage.closed;
        let count = self.held.len();
        for blocks in [
            &mut self.diagonal,
            &mut self.below,
            &mut self.pivots,
            &mut self.last,
        ] {
            blocks.clear();
            blocks.resize(count, Matrix2::zeros());
        }
        self.right.resize(count, Vector::zeros());
        for (row, joint) in self.held.clone().enumerate() {
            let Some(mates) = linkage.joints[joint].pair else {
                continue;
            };
            let own = limbs(mates, posture);
            for limb in &own {
                if let Some(body) = limb.body {
                    self.diagonal[row] += between(body, limb.arm, limb.arm);
                }
            }
            // The next joint in the row: it shares the link of this number.
            let next = self.held.start + (row + 1) % count;
            let Some(mates) = linkage.joints[next].pair.filter(|_| count > 1) else {
                continue;
            };
            for to in limbs(mates, posture) {
                for from in &own {
                    if from.body == Some(joint) && to.body == Some(joint) {
                        let block = between(joint, to.arm, from.arm);
                        self.below[row] = block * (from.sign * to.sign);
                    }
                }
            }
        }
        let sound = self.eliminate().is_some();
        if !sound {
            // No forces keep these joints together: whoever asks for them learns that they are not numbers.
            self.pivots.fill(Matrix2::repeat(f64::NAN));
        }
        sound
    }

    /// Joints with two sides, one after the other.
    pub(super) fn held(&self) -> Range<usize> {
        self.held.clone()
    }

    /// Number of rows before the last one of a closed chain.
    fn rows(&self) -> usize {
        self.diagonal.len() - usize::from(self.closed)
    }

    fn eliminate(&mut self) -> Option<()> {
        let count = self.diagonal.len();
        if count == 0 {
            return Some(());
        }
        let rows = self.rows();
        let mut corner = self.diagonal[count - 1];
        if self.closed {
            self.last[0] += self.below[count - 1].transpose();
            self.last[rows - 1] += self.below[rows - 1];
        }
        let mut left = self.diagonal[0];
        for i in 0..rows {
            let inverse = inverse_of(&left, &self.diagonal[i])?;
            self.pivots[i] = inverse;
            if i + 1 < rows {
                let e = self.below[i];
                left = self.diagonal[i + 1] - e * inverse * e.transpose();
                if self.closed {
                    let fill = self.last[i] * inverse * e.transpose();
                    self.last[i + 1] -= fill;
                }
            }
            if self.closed {
                corner -= self.last[i] * inverse * self.last[i].transpose();
            }
        }
        if self.closed {
            self.pivots[count - 1] = inverse_of(&corner, &self.diagonal[count - 1])?;
        }
        Some(())
    }

    /// λ of the right-hand side, in its place.
    pub(super) fn solve(&mut self) {
        let count = self.diagonal.len();
        if count == 0 {
            return;
        }
        let rows = self.rows();
        let right = &mut self.right;
        let mut corner = right[count - 1];
        for i in 0..rows {
            let through = self.pivots[i] * right[i];
            if i + 1 < rows {
                right[i + 1] -= self.below[i] * through;
            }
            if self.closed {
                corner -= self.last[i] * through;
            }
        }
        if self.closed {
            right[count - 1] = self.pivots[count - 1] * corner;
        }
        for i in (0..rows).rev() {
            let mut rest = right[i];
            if i + 1 < rows {
                rest -= self.below[i].transpose() * right[i + 1];
            }
            if self.closed {
                rest -= self.last[i].transpose() * right[count - 1];
            }
            right[i] = self.pivots[i] * rest;
        }
    }

    /// Joints with two sides, each with the row of its unknowns and its sides.
    pub(super) fn each<'a>(
        &self,
        linkage: &'a Linkage,
        posture: &'a Posture,
    ) -> impl Iterator<Item = (usize, usize, [Limb; 2])> + use<'a> {
        let joints = self.held.clone().enumerate();
        joints.filter_map(|(row, joint)| {
            let mates = linkage.joints[joint].pair?;
            Some((row, joint, limbs(mates, posture)))
        })
    }
}

/// I/m + (ẑ × r)(ẑ × s)ᵀ/I: how a place on a free body gives way to a force at another.
pub(super) fn mobility(mass: f64, inertia: f64, place: Vector, force: Vector) -> Matrix2<f64> {
    Matrix2::identity() / mass + turned(place) * turned(force).transpose() / inertia
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of two-by-two blocks against the dense system.
    #[test]
    fn cyclic_solution_is_exact() {
        let identity = Matrix2::identity();
        let e = Matrix2::new(-0.3, 0.1, 0.05, -0.4);
        let right: Vec<Vector> = (0..4)
            .map(|i| Vector::new(f64::from(i), 1.0 - f64::from(i)))
            .collect();
        let mut reactions = Reactions {
            held: 0..4,
            closed: true,
            diagonal: vec![identity * 2.0; 4],
            below: vec![e, e * 0.5, e * 0.7, e * 0.9],
            pivots: vec![Matrix2::zeros(); 4],
            last: vec![Matrix2::zeros(); 4],
            right: right.clone(),
        };
        assert!(reactions.eliminate().is_some());
        reactions.solve();
        let Reactions {
            diagonal,
            below,
            right: x,
            ..
        } = &reactions;
        for i in 0..4 {
            let before = (i + 3) % 4;
            let after = (i + 1) % 4;
            let found =
                diagonal[i] * x[i] + below[before] * x[before] + below[i].transpose() * x[after];
            assert!((found - right[i]).norm() < 1e-13, "row {i}");
        }
    }
}
