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
    use std::hint::black_box;
    use std::time::Instant;

    use nalgebra_sparse::factorization::CscCholesky;
    use nalgebra_sparse::{CooMatrix, CscMatrix};

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

    /// Microseconds of one solution, by blocks and by a sparse factorisation that keeps its pattern, from filling to answer.
    #[test]
    #[ignore = "a measurement: cargo test -p chaindrive-mechanics --lib blocks_and_sparse -- --ignored --nocapture"]
    fn blocks_and_sparse_factors_take_their_time() {
        // Rows of links, and a last link with so many wheels: bicycle, marine engine, and a long chain.
        for (links, border) in [(103, 4), (121, 6), (171, 7)] {
            let size = 3 * links + border;
            let block = Matrix3::new(8.0, 0.3, 0.2, 0.3, 7.0, 0.1, 0.2, 0.1, 9.0);
            let below = Matrix3::new(-0.5, 0.1, 0.3, 0.2, -0.4, 0.1, 0.3, -0.2, -0.6);
            let beside = Vector3::new(0.02, -0.03, 0.01);
            let mut all = CooMatrix::new(size, size);
            let mut both = |i: usize, j: usize, value: f64| {
                all.push(i, j, value);
                if i != j {
                    all.push(j, i, value);
                }
            };
            for i in 0..links {
                for k in 0..3 {
                    (0..=k).for_each(|l| both(3 * i + k, 3 * i + l, block[(k, l)]));
                    if i + 1 < links {
                        (0..3).for_each(|l| both(3 * i + 3 + k, 3 * i + l, below[(k, l)]));
                    }
                    (0..border).for_each(|j| both(3 * links + j, 3 * i + k, beside[k]));
                }
            }
            for j in 0..border {
                (0..=j).for_each(|k| {
                    both(3 * links + j, 3 * links + k, if j == k { 9.0 } else { 0.1 });
                });
            }
            let matrix = CscMatrix::from(&all);
            let mut factor = CscCholesky::factor(&matrix).expect("positive definite");
            let mut values = matrix.values().to_vec();
            let mut x = DMatrix::from_element(size, 1, 1.0);
            let mut blocks = BorderedBlocks::default();
            let mut by_blocks = || {
                blocks.clear(links, border);
                blocks.diagonal.fill(block);
                blocks.below.fill(below);
                blocks.beside.fill(beside);
                blocks.right.fill(Vector3::repeat(1.0));
                blocks.right_border.fill(1.0);
                for j in 0..border {
                    (0..=j).for_each(|k| blocks.corner[(j, k)] = if j == k { 9.0 } else { 0.1 });
                }
                assert!(blocks.solve());
                blocks.right[0][0]
            };
            let mut by_sparse = || {
                values.copy_from_slice(matrix.values());
                factor.refactor(&values).expect("positive definite");
                x.fill(1.0);
                factor.solve_mut(&mut x);
                x[0]
            };
            assert!((by_blocks() - by_sparse()).abs() < 1e-12);
            let time = |solve: &mut dyn FnMut() -> f64| {
                let start = Instant::now();
                (0..300).for_each(|_| {
                    black_box(solve());
                });
                start.elapsed().as_secs_f64() / 300.0 * 1e6
            };
            // Side by side, since other work comes and goes.
            let mut pairs: Vec<[f64; 2]> = (0..7)
                .map(|_| [time(&mut by_blocks), time(&mut by_sparse)])
                .collect();
            pairs.sort_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
            let [blocks, sparse] = pairs[3];
            println!(
                "{links} links, border {border}: blocks {blocks:.1} us, sparse {sparse:.1} us"
            );
            assert!(blocks < sparse);
        }
    }
}
