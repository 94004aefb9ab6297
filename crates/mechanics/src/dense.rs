//! Equations of a few unknowns with a full matrix.

use nalgebra::{DMatrix, DVector};

/// x of A x = b in the place of b, with pivots from the column; false if one vanishes. Unlike those of libraries it keeps nothing
/// of its own, so that nothing is allocated.
pub(crate) fn solve_dense(matrix: &mut DMatrix<f64>, right: &mut DVector<f64>) -> bool {
    for i in 0..right.len() {
        let pivot = i + matrix.view_range(i.., i).icamax();
        if matrix[(pivot, i)] == 0.0 {
            return false;
        }
        matrix.swap_rows(i, pivot);
        right.swap_rows(i, pivot);
        let inverse = 1.0 / matrix[(i, i)];
        for k in i + 1..right.len() {
            let factor = matrix[(k, i)] * inverse;
            for j in i + 1..right.len() {
                matrix[(k, j)] -= factor * matrix[(i, j)];
            }
            right[k] -= factor * right[i];
        }
    }
    matrix.solve_upper_triangular_mut(right)
}
