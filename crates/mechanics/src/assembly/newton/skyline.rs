//! Cholesky's factor of a symmetric matrix in its skyline: every row from its first entry to the diagonal.
//!
//! ```text
//! A = L Lᵀ,   Lᵢⱼ = (Aᵢⱼ − Σ Lᵢₖ Lⱼₖ) / Lⱼⱼ,   Lᵢᵢ = √(Aᵢᵢ − Σ Lᵢₖ²),   k < j
//! ```
//!
//! L has the skyline of A, so there is no pattern to be found. A folded ring of rollers has rows as short as its band and
//! the border of bodies a few long ones: time and memory grow with the number of rollers.
//!
//! # Source
//! A. Jennings, *Comput. J.* **9**, 1966, 281–285.

use std::ops::Range;

/// A factor L of a positive definite matrix.
#[derive(Debug)]
pub(super) struct Skyline {
    /// First column of every row.
    first: Vec<usize>,
    /// Places of the diagonals among the values.
    diagonal: Vec<usize>,
    values: Vec<f64>,
}

impl Skyline {
    /// Factorises the sum of entries (row, column, value) and a diagonal; none if it is not positive definite. Of entries
    /// beside the diagonal those of the lower half count.
    pub(super) fn factor(entries: &[(usize, usize, f64)], diagonal: &[f64]) -> Option<Self> {
        let mut matrix = Self::sum(entries, diagonal);
        matrix.factorise().then_some(matrix)
    }

    fn sum(entries: &[(usize, usize, f64)], diagonal: &[f64]) -> Self {
        let mut first: Vec<usize> = (0..diagonal.len()).collect();
        for &(i, j, _) in entries {
            first[i] = first[i].min(j);
        }
        let mut count = 0;
        let places = first.iter().enumerate().map(|(i, first)| {
            count += i - first + 1;
            count - 1
        });
        let places: Vec<usize> = places.collect();
        let mut values = vec![0.0; count];
        for (place, value) in places.iter().zip(diagonal) {
            values[*place] = *value;
        }
        for &(i, j, value) in entries.iter().filter(|(i, j, _)| j <= i) {
            values[places[i] + j - i] += value;
        }
        Self {
            first,
            diagonal: places,
            values,
        }
    }

    /// Places of columns of a row among the values.
    fn columns(&self, row: usize, columns: Range<usize>) -> Range<usize> {
        let behind = self.diagonal[row] + columns.start - row;
        behind..behind + columns.len()
    }

    fn factorise(&mut self) -> bool {
        for (i, &first) in self.first.iter().enumerate() {
            let own = self.diagonal[i] + first - i;
            let (before, row) = self.values.split_at_mut(own);
            let (row, pivot) = row[..=i - first].split_at_mut(i - first);
            // Column by column of the row: each needs those before it.
            for j in first..i {
                let common = first.max(self.first[j]);
                let (known, rest) = row.split_at_mut(j - first);
                let others = &before[self.diagonal[j] + common - j..=self.diagonal[j]];
                let (diagonal, others) = others.split_last().expect("the diagonal is there");
                rest[0] = (rest[0] - dot(&known[common - first..], others)) / diagonal;
            }
            let pivot = &mut pivot[0];
            *pivot -= dot(row, row);
            // Not a number is no pivot either.
            if pivot.is_nan() || *pivot <= 0.0 {
                return false;
            }
            *pivot = pivot.sqrt();
        }
        true
    }

    /// Solves A x = b in place.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let rows = self.first.iter().zip(&self.diagonal);
        // L y = b, and then Lᵀ x = y.
        for (i, (&first, &diagonal)) in rows.clone().enumerate() {
            let row = &self.values[self.columns(i, first..i)];
            x[i] = (x[i] - dot(row, &x[first..i])) / self.values[diagonal];
        }
        for (i, (&first, &diagonal)) in rows.enumerate().rev() {
            x[i] /= self.values[diagonal];
            let (before, from) = x.split_at_mut(i);
            let row = &self.values[self.columns(i, first..i)];
            for (x, value) in before[first..].iter_mut().zip(row) {
                *x -= value * from[0];
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// A band with a border, against a dense solution.
    #[test]
    fn agrees_with_a_dense_solution() {
        let (band, size) = (30, 33);
        let mut dense = DMatrix::<f64>::zeros(size, size);
        let mut entries = Vec::new();
        for i in 0..size {
            for j in 0..i {
                // Two parts of a sum for every entry, and the other half, which must not count twice.
                let value = ((3 * i + 7 * j) as f64).sin();
                if i - j < 4 || (i >= band && j % 5 == 2) {
                    entries.extend([(i, j, 0.5 * value), (j, i, value), (i, j, 0.5 * value)]);
                    (dense[(i, j)], dense[(j, i)]) = (value, value);
                }
            }
            entries.push((i, i, 4.0));
            dense[(i, i)] = 16.0;
        }
        let right: Vec<f64> = (0..size).map(|i| (i as f64).cos()).collect();
        let mut found = right.clone();
        let factor =
            Skyline::factor(&entries, &vec![12.0; size]).expect("dominated by its diagonal");
        factor.solve(&mut found);
        let exact = dense.lu().solve(&DVector::from(right)).expect("regular");
        for (found, exact) in found.iter().zip(&exact) {
            assert!((found - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_none() {
        for value in [0.0, -1.0, f64::NAN] {
            assert!(Skyline::factor(&[(0, 0, 1.0), (1, 1, value)], &[0.0; 2]).is_none());
        }
        assert!(Skyline::factor(&[(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0)], &[0.0; 2]).is_none());
    }
}
