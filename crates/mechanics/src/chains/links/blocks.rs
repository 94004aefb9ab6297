//! Symmetric block-tridiagonal systems with a border.
//!
//! ```text
//! ⎡ D₀ E₀ᵀ            W₀ᵀ ⎤
//! ⎢ E₀ D₁  E₁ᵀ        W₁ᵀ ⎥      D: 3×3 blocks of the links, E: their couplings,
//! ⎢     ⋱   ⋱   ⋱      ⋮  ⎥      W: couplings with the border, S: the border itself
//! ⎣ W₀ W₁   ⋯          S  ⎦
//! ```
//!
//! The border holds the wheels and tensioners and, in a closed chain, its last link, which touches
//! both ends of the row. The cost is linear in the links; nothing is pivoted, because M + cC + kK
//! is positive definite wherever the contacts press.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::dense::solve_dense;

/// A system under assembly, and the space for its solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct BorderedBlocks {
    pub(crate) diagonal: Vec<Matrix3<f64>>,
    /// Block (i + 1, i).
    pub(crate) below: Vec<Matrix3<f64>>,
    /// Row `j` of the border at link `i`: entry `i * border + j`.
    pub(crate) beside: Vec<Vector3<f64>>,
    pub(crate) corner: DMatrix<f64>,
    pub(crate) right: Vec<Vector3<f64>>,
    pub(crate) right_border: DVector<f64>,
    inverse: Vec<Matrix3<f64>>,
}

impl BorderedBlocks {
    /// Makes room for `links` blocks and `border` further unknowns; diagonal and right-hand sides are
    /// left to be set.
    pub(crate) fn clear(&mut self, links: usize, border: usize) {
        // Diagonal, right-hand sides and inverses are written before they are read.
        self.diagonal.resize(links, Matrix3::zeros());
        self.inverse.resize(links, Matrix3::zeros());
        self.right.resize(links, Vector3::zeros());
        self.below.clear();
        self.below.resize(links, Matrix3::zeros());
        self.beside.clear();
        self.beside.resize(links * border, Vector3::zeros());
        if self.corner.nrows() == border {
            self.corner.fill(0.0);
            self.right_border.fill(0.0);
        } else {
            self.corner = DMatrix::zeros(border, border);
            self.right_border = DVector::zeros(border);
        }
    }

    /// Solves for the border, once the links are eliminated.
    pub(super) fn solve_border(&mut self) -> bool {
        for j in 0..self.right_border.len() {
            for k in 0..j {
                self.corner[(k, j)] = self.corner[(j, k)];
            }
        }
        // The corner may be indefinite in statics, where contacts bulge: pivots here.
        solve_dense(&mut self.corner, &mut self.right_border)
    }

    /// Solves in place: the right-hand sides become the solution. False if a pivot vanishes.
    pub(crate) fn solve(&mut self) -> bool {
        let links = self.diagonal.len();
        let border = self.right_border.len();
        for i in 0..links {
            let Some(inverse) = self.diagonal[i].try_inverse() else {
                return false;
            };
            self.inverse[i] = inverse;
            let right = inverse * self.right[i];
            let next = i + 1 < links;
            if next {
                let below = self.below[i];
                self.diagonal[i + 1] -= below * inverse * below.transpose();
                self.right[i + 1] -= below * right;
            }
            for j in 0..border {
                // Row j of W D⁻¹
                let row = inverse * self.beside[i * border + j];
                if next {
                    let fill = self.below[i] * row;
                    self.beside[(i + 1) * border + j] -= fill;
                }
                for k in 0..=j {
                    self.corner[(j, k)] -= row.dot(&self.beside[i * border + k]);
                }
                self.right_border[j] -= self.beside[i * border + j].dot(&right);
            }
        }
        if !self.solve_border() {
            return false;
        }
        for i in (0..links).rev() {
            let mut right = self.right[i];
            if i + 1 < links {
                right -= self.below[i].transpose() * self.right[i + 1];
            }
            for j in 0..border {
                right -= self.beside[i * border + j] * self.right_border[j];
            }
            self.right[i] = self.inverse[i] * right;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a dense solution and product of the same matrix, with and without a border.
    #[test]
    fn agrees_with_a_dense_solution() {
        for (links, border) in [(1, 0), (5, 0), (7, 4), (3, 1)] {
            let mut blocks = BorderedBlocks::default();
            blocks.clear(links, border);
            let size = 3 * links + border;
            let mut dense = DMatrix::<f64>::zeros(size, size);
            let mut right = DVector::<f64>::zeros(size);
            let mut state = 0.4_f64;
            let mut next = || {
                state = (state * 997.13 + 0.123).fract();
                state - 0.5
            };
            for i in 0..links {
                let raw = Matrix3::from_fn(|_, _| next());
                let block = raw + raw.transpose() + Matrix3::identity() * 8.0;
                blocks.diagonal[i] = block;
                dense.view_mut((3 * i, 3 * i), (3, 3)).copy_from(&block);
                let force = Vector3::from_fn(|_, _| next());
                blocks.right[i] = force;
                right.rows_mut(3 * i, 3).copy_from(&force);
                if i + 1 < links {
                    let below = Matrix3::from_fn(|_, _| next());
                    blocks.below[i] = below;
                    dense.view_mut((3 * i + 3, 3 * i), (3, 3)).copy_from(&below);
                    dense
                        .view_mut((3 * i, 3 * i + 3), (3, 3))
                        .copy_from(&below.transpose());
                }
                for j in 0..border {
                    let beside = Vector3::from_fn(|_, _| next());
                    blocks.beside[i * border + j] = beside;
                    for k in 0..3 {
                        dense[(3 * links + j, 3 * i + k)] = beside[k];
                        dense[(3 * i + k, 3 * links + j)] = beside[k];
                    }
                }
            }
            for j in 0..border {
                blocks.corner[(j, j)] = 9.0;
                dense[(3 * links + j, 3 * links + j)] = 9.0;
                blocks.right_border[j] = 0.3;
                right[3 * links + j] = 0.3;
            }
            let exact = dense.lu().solve(&right).unwrap();
            assert!(blocks.solve());
            for i in 0..links {
                for k in 0..3 {
                    assert!((blocks.right[i][k] - exact[3 * i + k]).abs() < 1e-13);
                }
            }
            for j in 0..border {
                assert!((blocks.right_border[j] - exact[3 * links + j]).abs() < 1e-13);
            }
        }
    }
}
