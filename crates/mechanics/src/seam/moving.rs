//! Points that move with coordinates.

use chaindrive_geometry::{Point, Vector};
use serde::{Deserialize, Serialize};

/// Derivatives of a point by one coordinate: entry, first and second.
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

    /// Coordinates that move it.
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
