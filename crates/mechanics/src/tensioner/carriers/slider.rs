//! A straight slide.

use chaindrive_geometry::{Point, Vector};
use chaindrive_quantities::{JsonSchema, Mass, Ratio};
use serde::{Deserialize, Serialize};

use super::{CarriedBodies, CarrierModel, Extension, Weight, require_unit};
use crate::DriveError;

/// Length of its drawn rod in pitches.
const ROD: f64 = 3.0;

/// A straight slide, pushed along its travel.
///
/// ```text
/// x(s) = x₀ + d s
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Slider {
    /// Direction d of the push and of positive s; unit vector.
    #[schemars(
        with = "[Ratio; 2]",
        description = "Direction of the push (x, y), of any length."
    )]
    pub direction: Vector,
    /// Mass without the sprockets that it carries \[kg\]; needed unless locked.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Mass>", extend("exclusiveMinimum" = 0))]
    pub mass: Option<f64>,
}

impl CarrierModel for Slider {
    fn name(&self) -> &'static str {
        "slider"
    }

    /// A rod behind everything that it pushes, seen beyond the tips of a sprocket.
    fn lines(&self, carried: &CarriedBodies<'_>, pitch: f64) -> Vec<[Point; 2]> {
        let middles = carried.faces.iter();
        let middles = middles.map(|face| (face.point_at(0.5 * face.length()), 0.0));
        let pushed = carried.sprockets.iter().copied().chain(middles);
        pushed
            .map(|(end, covered)| [end - self.direction * (covered + ROD * pitch), end])
            .collect()
    }

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

    fn inertia(&self) -> (&'static str, Option<f64>) {
        ("mass", self.mass)
    }

    fn own_weight(&self) -> Option<Weight> {
        Some((self.mass?, Point::origin()))
    }
}
