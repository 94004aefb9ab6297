//! A few blocks of two rows in a row or a ring, one after the other.

use chaindrive_geometry::Vector;
use nalgebra::Matrix2;

use crate::lanes::LANES;

/// A symmetric block-tridiagonal system, cyclic where the chain is closed, and its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    pub(super) count: usize,
    pub(super) closed: bool,
    /// Share of its stiffest direction below which a block counts as singular.
    pub(super) singular: f64,
    pub(super) diagonal: [Matrix2<f64>; LANES],
    /// What the blocks were before others were eliminated, by their traces.
    pub(super) whole: [f64; LANES],
    /// Block (i + 1, i); of the last row of a ring that with the first.
    pub(super) below: [Matrix2<f64>; LANES],
    /// Inverses of what the elimination leaves of the diagonal.
    pivots: [Matrix2<f64>; LANES],
    /// Couplings with the last row of a ring, as the elimination leaves them.
    last: [Matrix2<f64>; LANES],
    /// The right-hand side, then the solution.
    pub(super) right: [Vector; LANES],
}

/// Inverse of a symmetric block that had this trace before others were eliminated; none if no more than a share is left in some direction.
fn inverse_of(block: &Matrix2<f64>, whole: f64, singular: f64) -> Option<Matrix2<f64>> {
    // The lesser eigenvalue is det/λ, and λ lies between half the trace and the trace.
    let enough = singular * whole * block.trace();
    (block.determinant() > enough)
        .then(|| block.try_inverse())
        .flatten()
}

impl Ring {
    pub(super) fn new(count: usize, closed: bool, singular: f64) -> Self {
        Self {
            count,
            closed,
            singular,
            ..Self::default()
        }
    }

    /// Number of rows before the last one of a ring.
    fn rows(&self) -> usize {
        self.count - usize::from(self.closed)
    }

    /// Factors the blocks; none where they are singular.
    pub(super) fn eliminate(&mut self) -> Option<()> {
        let count = self.count;
        let rows = self.rows();
        let mut corner = self.diagonal[count - 1];
        self.last[..count].fill(Matrix2::zeros());
        if self.closed {
            self.last[0] += self.below[count - 1].transpose();
            self.last[rows - 1] += self.below[rows - 1];
        }
        let mut left = self.diagonal[0];
        for i in 0..rows {
            let inverse = inverse_of(&left, self.whole[i], self.singular)?;
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
            self.pivots[count - 1] = inverse_of(&corner, self.whole[count - 1], self.singular)?;
        }
        Some(())
    }

    /// The solution in the place of the right-hand side.
    pub(super) fn solve(&mut self) {
        let (count, rows) = (self.count, self.rows());
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
}
