//! A straight slide.

use chaindrive_geometry::{Point, Vector};

use super::{Carries, Extension, Weight, require_unit};
use crate::DriveError;

/// A straight slide, pushed along its travel.
///
/// ```text
/// x(s) = x₀ + d s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// Direction d of travel for positive s; unit vector.
    pub direction: Vector,
}

impl Carries for Slider {
    fn coordinate_unit(&self) -> &'static str {
        "m"
    }

    fn reach(&self) -> f64 {
        1.0
    }

    fn check(&self, path: &str) -> Result<(), DriveError> {
        require_unit(self.direction, path)
    }

    fn extension(&self, s: f64) -> Extension {
        Extension {
            length: s,
            lever: 1.0,
        }
    }

    fn carry(&self, s: f64, at: Point) -> (Point, Vector) {
        (at + self.direction * s, self.direction)
    }

    fn ways(&self, _: f64, _: Point) -> [Vector; 2] {
        [self.direction, Vector::zeros()]
    }

    fn squared_lever(&self, _: f64, _: Point) -> f64 {
        1.0
    }

    fn turning(&self) -> f64 {
        0.0
    }

    fn origin(&self) -> Point {
        Point::origin()
    }

    fn own_weight(&self, inertia: f64) -> Option<Weight> {
        Some((inertia, Point::origin()))
    }
}
