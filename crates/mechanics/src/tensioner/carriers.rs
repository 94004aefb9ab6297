//! Carriers as a family: this table of contents, and one file a member.
//!
//! A carrier is a rigid body with one coordinate s, zero where it was assembled. It says where it takes a point, how that point goes on and
//! how far the body turns; whoever asks need not know which carrier it is.
//!
//! ```text
//! velocity of a carried point      ẋ = (∂x/∂s) ṡ
//! a force F on it, as one on s     Q = F·∂x/∂s
//! equation of motion               I s̈ + ½ I′ ṡ² = Σ Q,   I(s) = own inertia + Σ m |∂x/∂s|²
//! ```

mod arm;
mod slider;

use chaindrive_geometry::{ArcSpline, GeometryError, Point, Vector};
use chaindrive_quantities::{JsonSchema, check};
use serde::{Deserialize, Serialize};

pub use arm::{Arm, Plunger};
pub use slider::Slider;

use crate::DriveError;

/// How a tensioner moves. At assembly s = 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Carrier {
    /// A straight slide: the coordinate s is the travel \[m\].
    Slider(Slider),
    /// An arm about a pivot: the coordinate s is the angle \[rad\], counter-clockwise.
    Arm(Arm),
}

/// Asks the member, whichever it is.
macro_rules! ask {
    ($carrier:expr, $member:ident => $answer:expr) => {
        match $carrier {
            Carrier::Slider($member) => $answer,
            Carrier::Arm($member) => $answer,
        }
    };
}

/// Questions that a carrier answers.
trait CarrierModel: Copy {
    /// Its kind in one word, as scenes write it.
    fn name(&self) -> &'static str;

    /// Lines from what it moves along or turns about to what it carries. For the eye: the drive knows no shape of a carrier.
    fn lines(&self, carried: &CarriedBodies<'_>, pitch: f64) -> Vec<[Point; 2]>;

    /// The plunger that pushes on it, where there is one to be seen.
    fn plunger(&self) -> Option<Plunger> {
        None
    }

    /// SI unit of the coordinate.
    fn coordinate_unit(&self) -> &'static str;

    /// SI unit of the push.
    fn push_unit(&self) -> &'static str {
        "N"
    }

    /// Length that turns the coordinate into metres \[m\]; 1 for a travel.
    fn reach(&self) -> f64;

    /// Names the first parameter out of range.
    fn check(&self, path: &str) -> Result<(), DriveError>;

    /// Extension of the push at s.
    fn extension(&self, s: f64) -> Extension;

    /// Where a point goes that is at `at` when s = 0, and ∂x/∂s there.
    fn carry(&self, s: f64, at: Point) -> (Point, Vector);

    /// ∂x/∂s and ∂²x/∂s² of the carried point that is at `place` now.
    fn ways(&self, s: f64, place: Point) -> [Vector; 2];

    /// |∂x/∂s|² of a point that is at `at` when s = 0.
    fn squared_lever(&self, s: f64, at: Point) -> f64 {
        self.carry(s, at).1.norm_squared()
    }

    /// Angle by which the body turns for every unit of s \[rad\].
    fn turning(&self) -> f64;

    /// Point of the body, where it is when s = 0, from which carried faces are measured.
    fn origin(&self) -> Point;

    /// The same carrier assembled where it is at s.
    fn assembled_at(&self, s: f64) -> Self {
        let _ = s;
        *self
    }

    /// The point of the frame that it turns about, where it turns.
    fn pivot(&self) -> Option<Point> {
        None
    }

    /// The same carrier on a frame that has moved.
    fn translated(&self, by: Vector) -> Self {
        let _ = by;
        *self
    }

    /// Its own mass \[kg\] or moment of inertia \[kg m²\] that goes with s, where it is given, and the key that gives it.
    fn inertia(&self) -> (&'static str, Option<f64>);

    /// The carrier's own mass and where it is when s = 0, if its weight is to count.
    fn own_weight(&self) -> Option<Weight> {
        None
    }

    /// Inertia that goes with s: the carrier's own inertia and that of the masses it carries.
    fn reduced(&self, s: f64, carried: &[Weight]) -> ReducedInertia {
        let mut reduced = ReducedInertia {
            inertia: self.inertia().1.unwrap_or(0.0),
            slope: 0.0,
        };
        for (mass, at) in carried {
            // I = J + Σ m |∂x/∂s|²,   I′ = 2 Σ m ∂x/∂s·∂²x/∂s²
            reduced.inertia += mass * self.squared_lever(s, *at);
            let [first, second] = self.ways(s, self.carry(s, *at).0);
            reduced.slope += 2.0 * mass * first.dot(&second);
        }
        reduced
    }

    /// Generalised force of the weight of all masses.
    fn weight(&self, s: f64, carried: &[Weight], gravity: Vector) -> f64 {
        let masses = carried.iter().copied().chain(self.own_weight());
        // Q = Σ m g·∂x/∂s
        let pull = |(mass, at): Weight| (gravity * mass).dot(&self.carry(s, at).1);
        masses.map(pull).sum()
    }
}

/// Extension of the push of a carrier, with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extension {
    /// Extension x since assembly \[m, or rad where a torque pushes\].
    pub(crate) length: f64,
    /// Lever ∂x/∂s.
    pub(crate) lever: f64,
}

/// Mass or moment of inertia that goes with s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReducedInertia {
    /// I \[kg or kg m²\].
    pub(crate) inertia: f64,
    /// I′ = ∂I/∂s.
    pub(crate) slope: f64,
}

/// Sprockets that a carrier carries, by centre and radius of the tips \[m\], and faces of guides, where they are when s = 0.
#[derive(Clone, Debug)]
pub(crate) struct CarriedBodies<'a> {
    pub(crate) sprockets: Vec<(Point, f64)>,
    pub(crate) faces: Vec<&'a ArcSpline>,
}

/// A mass \[kg\] and where it is when s = 0.
pub(crate) type Weight = (f64, Point);

/// Its looks.
impl Carrier {
    /// Its kind in one word, as scenes write it.
    pub fn name(&self) -> &'static str {
        ask!(self, carrier => carrier.name())
    }

    /// Lines from what it moves along or turns about to what it carries.
    pub(crate) fn lines(&self, carried: &CarriedBodies<'_>, pitch: f64) -> Vec<[Point; 2]> {
        ask!(self, carrier => carrier.lines(carried, pitch))
    }

    /// The plunger that pushes on it, where there is one to be seen.
    pub(crate) fn plunger(&self) -> Option<Plunger> {
        ask!(self, carrier => carrier.plunger())
    }
}

/// Units and ranges.
impl Carrier {
    /// SI unit of its coordinate.
    pub fn coordinate_unit(&self) -> &'static str {
        ask!(self, carrier => carrier.coordinate_unit())
    }

    /// SI unit of the push on it: without a plunger an arm is pushed by a torque.
    pub fn push_unit(&self) -> &'static str {
        ask!(self, carrier => carrier.push_unit())
    }

    /// Length that turns its coordinate into metres \[m\]; 1 for a travel.
    pub fn reach(&self) -> f64 {
        ask!(self, carrier => carrier.reach())
    }

    /// Its own mass \[kg\] or moment of inertia \[kg m²\] that goes with the coordinate, where it is given, and the key that gives it.
    pub fn inertia(&self) -> (&'static str, Option<f64>) {
        ask!(self, carrier => carrier.inertia())
    }

    /// Names the first parameter out of range.
    pub(crate) fn check(&self, path: &str) -> Result<(), DriveError> {
        check(self).map_err(|source| DriveError::law(path, source))?;
        ask!(self, carrier => carrier.check(path))
    }
}

/// Kinematics.
impl Carrier {
    /// Extension of the push at s.
    pub(crate) fn extension(&self, s: f64) -> Extension {
        ask!(self, carrier => carrier.extension(s))
    }

    /// Where a point goes that is at `at` when s = 0, and ∂x/∂s there.
    pub(crate) fn carry(&self, s: f64, at: Point) -> (Point, Vector) {
        ask!(self, carrier => carrier.carry(s, at))
    }

    /// ∂x/∂s and ∂²x/∂s² of the carried point that is at `place` now.
    pub(crate) fn ways(&self, s: f64, place: Point) -> [Vector; 2] {
        ask!(self, carrier => carrier.ways(s, place))
    }

    /// |∂x/∂s|² of a point that is at `at` when s = 0.
    pub(crate) fn squared_lever(&self, s: f64, at: Point) -> f64 {
        ask!(self, carrier => carrier.squared_lever(s, at))
    }

    /// Angle by which the body turns for every unit of s \[rad\].
    pub(crate) fn turning(&self) -> f64 {
        ask!(self, carrier => carrier.turning())
    }

    /// Point of the body, where it is when s = 0, from which carried faces are measured: one that moves as little as it can.
    pub(crate) fn origin(&self) -> Point {
        ask!(self, carrier => carrier.origin())
    }

    /// A carried face where it is at s.
    pub(crate) fn carry_face(&self, s: f64, face: &ArcSpline) -> Result<ArcSpline, GeometryError> {
        let origin = self.origin();
        let (place, _) = self.carry(s, origin);
        let angle = self.turning() * s;
        let pieces = face.pieces().iter().map(|piece| {
            let piece = piece.translated(-origin.coords);
            piece.rotated(angle).translated(place.coords)
        });
        ArcSpline::open(&pieces.collect::<Vec<_>>())
    }

    /// The same carrier assembled where it is at s.
    pub(crate) fn assembled_at(self, s: f64) -> Self {
        match self {
            Self::Slider(slider) => Self::Slider(slider.assembled_at(s)),
            Self::Arm(arm) => Self::Arm(arm.assembled_at(s)),
        }
    }

    /// The point of the frame that it turns about \[m\], where it turns.
    pub(crate) fn pivot(&self) -> Option<Point> {
        ask!(self, carrier => carrier.pivot())
    }

    /// The same carrier on a frame that has moved by some way \[m\].
    pub(crate) fn translated(self, by: Vector) -> Self {
        match self {
            Self::Slider(slider) => Self::Slider(slider.translated(by)),
            Self::Arm(arm) => Self::Arm(arm.translated(by)),
        }
    }
}

/// Inertia and weight.
impl Carrier {
    /// Inertia that goes with s: the carrier's own inertia and that of the masses it carries.
    pub(crate) fn reduced(&self, s: f64, carried: &[Weight]) -> ReducedInertia {
        ask!(self, carrier => carrier.reduced(s, carried))
    }

    /// Generalised force of the weight of all masses.
    pub(crate) fn weight(&self, s: f64, carried: &[Weight], gravity: Vector) -> f64 {
        ask!(self, carrier => carrier.weight(s, carried, gravity))
    }

    /// The carrier's own mass and where it is when s = 0, if its weight is to count.
    pub(crate) fn own_weight(&self) -> Option<Weight> {
        ask!(self, carrier => carrier.own_weight())
    }
}

/// Refuses what is not a unit vector.
fn require_unit(direction: Vector, path: &str) -> Result<(), DriveError> {
    DriveError::require(
        (direction.norm() - 1.0).abs() < 1e-9,
        &format!("{path}.direction"),
        direction.norm(),
        "a unit vector",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every carrier, as a drive may have it.
    fn specimens() -> Vec<Carrier> {
        let arm = |plunger| {
            Carrier::Arm(Arm {
                pivot: Point::new(0.3, -0.1),
                inertia: Some(0.7),
                plunger,
            })
        };
        vec![
            Carrier::Slider(Slider {
                direction: Vector::new(0.6, 0.8),
                mass: Some(0.7),
            }),
            arm(None),
            arm(Some(Plunger {
                at: Point::new(0.1, 0.2),
                direction: Vector::new(-0.8, 0.6),
            })),
        ]
    }

    const PLACES: [f64; 3] = [-0.2, 0.0, 0.15];
    const H: f64 = 1e-5;

    fn point() -> Point {
        Point::new(0.45, 0.25)
    }

    /// First and second derivatives against central differences, whose error is below 1e-10 and 1e-6.
    #[test]
    fn a_carried_point_goes_on_as_its_derivatives_say() {
        for carrier in specimens() {
            for s in PLACES {
                let [behind, here, ahead] = [s - H, s, s + H].map(|s| carrier.carry(s, point()));
                let [first, second] = carrier.ways(s, here.0);
                assert!((here.1 - first).norm() < 1e-15, "{carrier:?}");
                let slope = (ahead.0 - behind.0) / (2.0 * H);
                assert!((slope - first).norm() < 1e-9, "{carrier:?} at {s}");
                let bend = (ahead.1 - behind.1) / (2.0 * H);
                assert!((bend - second).norm() < 1e-9, "{carrier:?} at {s}");
            }
        }
    }

    #[test]
    fn the_lever_is_the_slope_of_the_extension() {
        for carrier in specimens() {
            assert!(carrier.extension(0.0).length.abs() < 1e-16);
            for s in PLACES {
                let [behind, here, ahead] = [s - H, s, s + H].map(|s| carrier.extension(s));
                let slope = (ahead.length - behind.length) / (2.0 * H);
                assert!((slope - here.lever).abs() < 1e-9, "{carrier:?} at {s}");
            }
        }
    }

    #[test]
    fn the_inertia_is_that_of_the_carried_masses() {
        let carried = [(2.0, point()), (0.5, Point::new(-0.3, 0.1))];
        for carrier in specimens() {
            for s in PLACES {
                let [behind, here, ahead] = [s - H, s, s + H].map(|s| carrier.reduced(s, &carried));
                // 2 T = I ṡ²
                let energy = carried.iter().fold(0.7, |sum, (mass, at)| {
                    sum + mass * carrier.carry(s, *at).1.norm_squared()
                });
                assert!((here.inertia - energy).abs() < 1e-12, "{carrier:?} at {s}");
                let slope = (ahead.inertia - behind.inertia) / (2.0 * H);
                assert!((slope - here.slope).abs() < 1e-9, "{carrier:?} at {s}");
            }
        }
    }

    /// Assembled where it is, a carrier moves on as before: points, faces and push.
    #[test]
    fn assembly_elsewhere_shifts_the_coordinate_alone() {
        let face = ArcSpline::open(&[chaindrive_geometry::Segment::new(
            Point::new(0.2, 0.2),
            Point::new(0.5, 0.3),
        )
        .into()])
        .expect("a straight face");
        for carrier in specimens() {
            let (travel, s) = (0.1, 0.05);
            let moved = carrier.assembled_at(travel);
            let (there, _) = carrier.carry(travel, point());
            let (expected, _) = carrier.carry(travel + s, point());
            let (found, _) = moved.carry(s, there);
            assert!((found - expected).norm() < 1e-15, "{carrier:?}");
            let pushed = carrier.extension(travel + s).length - carrier.extension(travel).length;
            assert!((moved.extension(s).length - pushed).abs() < 1e-15);
            let carried = carrier.carry_face(travel, &face).expect("as straight");
            for end in [0.0, 1.0] {
                let (expected, _) = carrier.carry(travel, face.pieces()[0].point(end));
                let found = carried.pieces()[0].point(end);
                assert!((found - expected).norm() < 1e-15, "{carrier:?}");
            }
        }
    }
}
