//! Derivatives of the energy, and what a chain adds to them: the language of statics and modes.

use chaindrive_geometry::Vector;
use nalgebra::{DVector, Matrix2};

use super::moving::Moving;

/// A coordinate that is unknown in equilibrium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknown {
    /// Its place in the state, or in the chain's part of it.
    pub(crate) entry: usize,
    /// Squared lever \[m²\] that turns its unit into metres: 1 for places.
    pub(crate) lever: f64,
}

/// Shares of the outer loads that act.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) gravity: f64,
    /// Of torques, and of forces on chain ends, centres and carriers.
    pub(crate) torque: f64,
}

impl Load {
    /// All of them.
    pub(crate) const FULL: Self = Self {
        gravity: 1.0,
        torque: 1.0,
    };
}

/// Gradient and Hessian of the energy.
#[derive(Clone, Debug)]
pub(crate) struct Balance {
    pub(crate) gradient: DVector<f64>,
    pub(crate) entries: Vec<(usize, usize, f64)>,
    /// Contacts closed on every sprocket.
    pub(crate) contacts: Vec<usize>,
    /// Tensions of links, or forces in joints \[N\]: what the residual is measured by.
    pub(crate) tensions: Vec<f64>,
}

/// Collects derivatives by state entry; those of held entries are dropped.
#[derive(Debug)]
pub(crate) struct Sum<'a> {
    /// State entry → row.
    pub(crate) row: &'a [Option<usize>],
    /// Entry of the state from which entries are counted.
    pub(crate) first: usize,
    pub(crate) balance: Balance,
}

impl Sum<'_> {
    /// Adds to ∂E/∂q.
    pub(crate) fn force(&mut self, entry: usize, value: f64) {
        if let Some(row) = self.row[self.first + entry] {
            self.balance.gradient[row] += value;
        }
    }

    /// Adds to ∂²E/∂q².
    pub(crate) fn stiffen(&mut self, first: usize, second: usize, value: f64) {
        let [i, j] = [first, second].map(|entry| self.row[self.first + entry]);
        if let (Some(i), Some(j)) = (i, j) {
            self.balance.entries.push((i, j, value));
        }
    }

    /// Adds a symmetric block of ∂²E/∂q² for a few entries.
    pub(crate) fn stiffen_all<const N: usize>(
        &mut self,
        entries: [usize; N],
        value: impl Fn(usize, usize) -> f64,
    ) {
        let rows = entries.map(|entry| self.row[self.first + entry]);
        for (i, row) in rows.iter().enumerate() {
            let Some(row) = *row else { continue };
            for (j, column) in rows.iter().enumerate() {
                if let Some(column) = *column {
                    self.balance.entries.push((row, column, value(i, j)));
                }
            }
        }
    }

    /// Adds an energy whose derivative with the place of a point is `gradient`.
    pub(crate) fn pull(&mut self, point: &Moving, gradient: Vector) {
        for way in point.ways() {
            self.force(way.entry, gradient.dot(&way.first));
            if way.bends() {
                self.stiffen(way.entry, way.entry, gradient.dot(&way.second));
            }
        }
    }

    /// Adds an energy of e = P₁ − P₀ with its two derivatives.
    pub(crate) fn stretch(
        &mut self,
        [start, end]: [&Moving; 2],
        gradient: Vector,
        stiffness: &Matrix2<f64>,
    ) {
        self.pull(end, gradient);
        self.pull(start, -gradient);
        for (a, sign) in [(start, -1.0), (end, 1.0)] {
            for (b, other) in [(start, -1.0), (end, 1.0)] {
                for to in a.ways() {
                    let row = stiffness * to.first * (sign * other);
                    for from in b.ways() {
                        self.stiffen(to.entry, from.entry, row.dot(&from.first));
                    }
                }
            }
        }
    }
}
