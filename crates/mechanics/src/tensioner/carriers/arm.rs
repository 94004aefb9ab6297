//! An arm about a pivot.

use chaindrive_geometry::{Point, Vector};
use chaindrive_quantities::{Inertia, JsonSchema, Length, Ratio};
use serde::{Deserialize, Serialize};

use super::{CarriedBodies, CarrierModel, Extension, require_unit};
use crate::DriveError;

/// An arm about a pivot, pushed by a plunger or by a torque.
///
/// ```text
/// x(s) = pivot + R(s) (x₀ − pivot)
/// ```
///
/// Its own weight is left out: where its centre of mass lies is not known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Arm {
    /// Pivot (x, y) \[m\].
    #[schemars(with = "[Length; 2]")]
    pub pivot: Point,
    /// Moment of inertia about the pivot without the sprockets that it carries \[kg m²\]; needed unless locked.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Inertia>", extend("exclusiveMinimum" = 0))]
    pub inertia: Option<f64>,
    /// Where a plunger pushes; without one the push is a torsion spring.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plunger: Option<Plunger>,
}

/// A plunger on an arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plunger {
    /// Point of the arm on which it pushes (x, y), in the assembled position \[m\].
    #[schemars(with = "[Length; 2]")]
    pub at: Point,
    /// Direction of the push; unit vector.
    #[schemars(
        with = "[Ratio; 2]",
        description = "Direction of the push (x, y), of any length."
    )]
    pub direction: Vector,
}

impl Arm {
    /// A point of the arm seen from the pivot, turned by s.
    fn turned(&self, s: f64, at: Point) -> Vector {
        let arm = at - self.pivot;
        let (sine, cosine) = s.sin_cos();
        Vector::new(cosine * arm.x - sine * arm.y, sine * arm.x + cosine * arm.y)
    }
}

/// ẑ × r
fn across(r: Vector) -> Vector {
    Vector::new(-r.y, r.x)
}

impl CarrierModel for Arm {
    fn name(&self) -> &'static str {
        "arm"
    }

    /// From the pivot to all that it carries, and from there to the plunger.
    fn lines(&self, carried: &CarriedBodies<'_>, _pitch: f64) -> Vec<[Point; 2]> {
        let ends = |from: Point| {
            let faces = carried.faces.iter();
            let feet = faces.filter_map(move |face| face.nearest(from, f64::INFINITY));
            let centres = carried.sprockets.iter().map(|(centre, _)| *centre);
            feet.map(|foot| foot.point).chain(centres)
        };
        let nearest =
            |from: Point| ends(from).min_by(|a, b| (a - from).norm().total_cmp(&(b - from).norm()));
        let mut lines: Vec<_> = ends(self.pivot).map(|end| [self.pivot, end]).collect();
        // The plunger pushes on the nearest thing that the arm carries, or on an arm of its own.
        lines.extend(
            self.plunger
                .map(|plunger| [nearest(plunger.at).unwrap_or(self.pivot), plunger.at]),
        );
        lines
    }

    fn plunger(&self) -> Option<Plunger> {
        self.plunger
    }

    fn coordinate_unit(&self) -> &'static str {
        "rad"
    }

    fn push_unit(&self) -> &'static str {
        if self.plunger.is_some() { "N" } else { "N m" }
    }

    fn reach(&self) -> f64 {
        // A bare arm has no length of its own; 0.1 m is that of most.
        self.plunger
            .map_or(0.1, |plunger| (plunger.at - self.pivot).norm().max(1e-3))
    }

    fn check(&self, path: &str) -> Result<(), DriveError> {
        match &self.plunger {
            Some(plunger) => require_unit(plunger.direction, path),
            None => Ok(()),
        }
    }

    fn extension(&self, s: f64) -> Extension {
        match &self.plunger {
            None => Extension {
                length: s,
                lever: 1.0,
            },
            Some(Plunger { at, direction }) => {
                let turned = self.turned(s, *at);
                // x = d·(R(s) r − r),   ∂x/∂s = d·(ẑ × R(s) r)
                Extension {
                    length: direction.dot(&(turned - (at - self.pivot))),
                    lever: direction.dot(&across(turned)),
                }
            }
        }
    }

    fn carry(&self, s: f64, at: Point) -> (Point, Vector) {
        let turned = self.turned(s, at);
        (self.pivot + turned, across(turned))
    }

    fn ways(&self, _: f64, place: Point) -> [Vector; 2] {
        let arm = place - self.pivot;
        // ∂x/∂s = ẑ × r,   ∂²x/∂s² = −r
        [across(arm), -arm]
    }

    fn squared_lever(&self, _: f64, at: Point) -> f64 {
        (at - self.pivot).norm_squared()
    }

    fn inertia(&self) -> (&'static str, Option<f64>) {
        ("inertia", self.inertia)
    }

    fn turning(&self) -> f64 {
        1.0
    }

    fn origin(&self) -> Point {
        self.pivot
    }

    fn assembled_at(&self, s: f64) -> Self {
        let plunger = self.plunger.map(|plunger| Plunger {
            at: self.carry(s, plunger.at).0,
            ..plunger
        });
        Self { plunger, ..*self }
    }

    fn pivot(&self) -> Option<Point> {
        Some(self.pivot)
    }

    fn translated(&self, by: Vector) -> Self {
        let plunger = self.plunger.map(|plunger| Plunger {
            at: plunger.at + by,
            ..plunger
        });
        Self {
            pivot: self.pivot + by,
            plunger,
            ..*self
        }
    }
}
