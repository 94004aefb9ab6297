//! Derivatives of the energy, and what a chain adds to them: the language of statics and modes.

use chaindrive_geometry::{Point, Vector};
use nalgebra::{DVector, Matrix2};
use serde::{Deserialize, Serialize};

/// A coordinate that is unknown in equilibrium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknown {
    /// Its place in the state, or in the chain's part of it.
    pub(crate) entry: usize,
    /// Squared lever \[m²\] that turns its unit into metres: 1 for places.
    pub(crate) lever: f64,
}

/// How far a point goes with one coordinate: entry, first and second derivative.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Way {
    pub(crate) entry: usize,
    pub(crate) first: Vector,
    pub(crate) second: Vector,
}

impl Way {
    /// Whether the point goes along a curve.
    pub(crate) fn bends(&self) -> bool {
        self.second != Vector::zeros()
    }
}

/// A point of a chain, and how it moves with the chain's coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    pub(crate) place: Point,
    ways: [Way; 3],
    count: usize,
}

impl Moving {
    /// A point whose coordinates x and y stand in the state themselves.
    pub(crate) fn free(place: Point, [x, y]: [usize; 2]) -> Self {
        let way = |entry, first| Way {
            entry,
            first,
            second: Vector::zeros(),
        };
        let (x, y) = (way(x, Vector::x()), way(y, Vector::y()));
        Self {
            place,
            ways: [x, y, y],
            count: 2,
        }
    }

    /// A point of a rigid body with coordinates x, y, φ from `first` on, `arm` away from its centre of mass.
    pub(crate) fn on_body(centre: Point, first: usize, arm: Vector) -> Self {
        let mut moving = Self::free(centre + arm, [first, first + 1]);
        moving.ways[2] = Way {
            entry: first + 2,
            // ∂P/∂φ = ẑ × r,   ∂²P/∂φ² = −r
            first: Vector::new(-arm.y, arm.x),
            second: -arm,
        };
        moving.count = 3;
        moving
    }

    /// A point that stays.
    pub(crate) fn held(place: Point) -> Self {
        Self {
            count: 0,
            ..Self::free(place, [0, 0])
        }
    }

    /// What moves it.
    pub(crate) fn ways(&self) -> &[Way] {
        &self.ways[..self.count]
    }

    /// The same with entries counted from `first` on.
    pub(crate) fn behind(mut self, first: usize) -> Self {
        for way in &mut self.ways {
            way.entry += first;
        }
        self
    }
}

/// How much of the outer loads acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) gravity: f64,
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
