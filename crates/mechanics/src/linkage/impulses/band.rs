//! A narrow symmetric band with a border.

use super::Linkage;

/// Where an unknown stands.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Row(usize),
    Border(usize),
}

/// Band, border, and one right-hand side.
///
/// Rows are those of the joints, R each, without the last joint of a closed chain, which stands first in the border.
#[derive(Clone, Debug, Default)]
pub(super) struct Band {
    /// Column i of the lower half: entries (i + m, i), m = 0 to 2 R − 1; after the elimination the pivot, and L.
    columns: Vec<[f64; 4]>,
    /// Entries of row i in the border, and its right-hand side behind them; after the substitution the unknown there.
    beside: Vec<f64>,
    pub(super) border: usize,
    /// The border's own equations, in full, right-hand sides behind every row.
    corner: Vec<f64>,
    /// The unknowns of the border, once they are found.
    pub(super) edge: Vec<f64>,
    /// The joint that stands in the border.
    last: usize,
}

impl Band {
    pub(super) fn clear<const R: usize>(&mut self, linkage: &Linkage, wheels: usize) {
        let joints = linkage.joints.len();
        let (held, last) = if linkage.closed {
            (R, joints - 1)
        } else {
            (0, usize::MAX)
        };
        self.last = last;
        self.border = held + wheels;
        let rows = R * joints - held;
        self.columns.clear();
        self.columns.resize(rows, [0.0; 4]);
        self.beside.clear();
        self.beside.resize(rows * (self.border + 1), 0.0);
        self.corner.clear();
        self.corner.resize(self.border * (self.border + 1), 0.0);
        self.edge.resize(self.border, 0.0);
    }

    /// Where the row p of a joint stands.
    #[inline]
    pub(super) fn place<const R: usize>(&self, joint: usize, p: usize) -> Place {
        if joint == self.last {
            Place::Border(p)
        } else {
            Place::Row(R * joint + p)
        }
    }

    /// Adds to an entry and to its mirror image.
    #[inline]
    pub(super) fn add(&mut self, a: Place, b: Place, value: f64) {
        let width = self.border + 1;
        match (a, b) {
            (Place::Row(i), Place::Row(j)) => {
                self.columns[i.min(j)][i.abs_diff(j)] += value;
            }
            (Place::Row(i), Place::Border(j)) | (Place::Border(j), Place::Row(i)) => {
                self.beside[i * width + j] += value;
            }
            (Place::Border(i), Place::Border(j)) => {
                self.corner[i * width + j] += value;
                if i != j {
                    self.corner[j * width + i] += value;
                }
            }
        }
    }

    /// Adds to a right-hand side.
    #[inline]
    pub(super) fn add_right(&mut self, place: Place, value: f64) {
        let width = self.border + 1;
        match place {
            Place::Row(i) => self.beside[i * width + self.border] += value,
            Place::Border(i) => self.corner[i * width + self.border] += value,
        }
    }

    /// L D Lᵀ in place; border and right-hand sides are carried along.
    pub(super) fn factor<const R: usize>(&mut self) -> bool {
        let width = self.border + 1;
        let rows = self.columns.len();
        for i in 0..rows {
            let column = self.columns[i];
            let pivot = column[0];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let inverse = 1.0 / pivot;
            let (done, rest) = self.beside.split_at_mut((i + 1) * width);
            let here = &done[i * width..];
            for m in 1..(2 * R).min(rows - i) {
                let factor = column[m] * inverse;
                for l in m..2 * R {
                    self.columns[i + m][l - m] -= factor * column[l];
                }
                let below = &mut rest[(m - 1) * width..m * width];
                for (below, here) in below.iter_mut().zip(here) {
                    *below -= factor * here;
                }
                self.columns[i][m] = factor;
            }
            // The corner: S −= cᵀ c / d
            for (&value, corner) in here.iter().zip(self.corner.chunks_exact_mut(width)) {
                let scaled = value * inverse;
                for (corner, here) in corner.iter_mut().zip(here) {
                    *corner -= scaled * here;
                }
            }
        }
        self.factor_corner()
    }

    fn factor_corner(&mut self) -> bool {
        let width = self.border + 1;
        for i in 0..self.border {
            let (done, rest) = self.corner.split_at_mut((i + 1) * width);
            let here = &done[i * width..];
            let inverse = 1.0 / here[i];
            if !inverse.is_finite() {
                return false;
            }
            for below in rest.chunks_exact_mut(width) {
                let factor = below[i] * inverse;
                for (below, here) in below[i..].iter_mut().zip(&here[i..]) {
                    *below -= factor * here;
                }
            }
        }
        true
    }

    /// Back through the border, D and Lᵀ.
    pub(super) fn substitute<const R: usize>(&mut self) {
        let width = self.border + 1;
        for i in (0..self.border).rev() {
            let row = &self.corner[i * width..(i + 1) * width];
            let known = row[i + 1..self.border].iter().zip(&self.edge[i + 1..]);
            let sum: f64 = known.map(|(a, x)| a * x).sum();
            self.edge[i] = (row[self.border] - sum) / row[i];
        }
        let rows = self.columns.len();
        for i in (0..rows).rev() {
            let column = self.columns[i];
            let here = &self.beside[i * width..(i + 1) * width];
            let known = here[..self.border].iter().zip(&self.edge);
            let sum: f64 = known.map(|(a, x)| a * x).sum();
            let mut value = (here[self.border] - sum) / column[0];
            for m in 1..(2 * R).min(rows - i) {
                value -= column[m] * self.beside[(i + m) * width + self.border];
            }
            self.beside[i * width + self.border] = value;
        }
    }

    /// The unknown of the row p of a joint.
    #[inline]
    pub(super) fn found<const R: usize>(&self, joint: usize, p: usize) -> f64 {
        self.at(self.place::<R>(joint, p))
    }

    #[inline]
    pub(super) fn at(&self, place: Place) -> f64 {
        match place {
            Place::Row(i) => self.beside[i * (self.border + 1) + self.border],
            Place::Border(i) => self.edge[i],
        }
    }
}
