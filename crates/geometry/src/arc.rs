//! The circular piece, convex or concave.

use std::f64::consts::{PI, TAU};

use crate::{GeometryError, Point, Vector};

/// Sense of rotation of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Counter-clockwise: convex material, positive curvature.
    Left,
    /// Clockwise: concave material, negative curvature.
    Right,
}

/// A circular arc, travelled from its start angle through its sweep.
///
/// ```text
/// x(s) = c + r (cos θ, sin θ),   θ = θ₀ + s Δ,   s ∈ [0, 1]
/// ```
///
/// A positive sweep Δ bends to the left, around the material (convex); a negative one bends to
/// the right, around the void (concave).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Centre c \[m\].
    pub centre: Point,
    /// Radius r \[m\], positive.
    pub radius: f64,
    /// Angle θ₀ from the centre to the start \[rad\].
    pub start_angle: f64,
    /// Signed sweep Δ \[rad\], counter-clockwise positive, at most a full turn.
    pub sweep: f64,
}

impl Arc {
    /// Arc about a centre \[m\] between two points on one circle \[m\].
    ///
    /// The radius is the mean of the two distances from the centre.
    ///
    /// # Errors
    /// Numbers that are not finite; distances that differ by more than 10⁻⁶ of the radius; ends
    /// that coincide, because nothing and a full turn would look alike.
    pub fn between(
        start: Point,
        end: Point,
        centre: Point,
        turn: Turn,
    ) -> Result<Self, GeometryError> {
        let (from, to) = (start - centre, end - centre);
        let (start_radius, end_radius) = (from.norm(), to.norm());
        GeometryError::positive("distance from centre to start of arc [m]", start_radius)?;
        GeometryError::positive("distance from centre to end of arc [m]", end_radius)?;
        if (start_radius - end_radius).abs() > 1e-6 * start_radius {
            return Err(GeometryError::UnequalRadii {
                start_radius,
                end_radius,
            });
        }
        // Angle from one spoke to the other, in (−π, π], then brought to the asked sense.
        let angle = from.perp(&to).atan2(from.dot(&to));
        let sweep = match turn {
            Turn::Left if angle < 0.0 => angle + TAU,
            Turn::Right if angle > 0.0 => angle - TAU,
            _ => angle,
        };
        if sweep == 0.0 {
            return Err(GeometryError::Coincident {
                first: 0,
                second: 1,
            });
        }
        Ok(Self {
            centre,
            radius: 0.5 * (start_radius + end_radius),
            start_angle: from.y.atan2(from.x),
            sweep,
        })
    }

    /// Arc between two points \[m\] with a bulge \[–\], as CAD polylines store it.
    ///
    /// ```text
    /// bulge = tan(Δ / 4) = height of the arc over half its chord, positive to the left turn
    /// ```
    ///
    /// # Errors
    /// Numbers that are not finite, a zero bulge (that is a segment), coincident ends.
    pub fn with_bulge(start: Point, end: Point, bulge: f64) -> Result<Self, GeometryError> {
        GeometryError::finite("bulge of an arc", bulge)?;
        if bulge == 0.0 {
            return Err(GeometryError::OutOfRange {
                what: "bulge of an arc",
                value: bulge,
                allowed: "other than zero",
            });
        }
        let chord = end - start;
        let length = chord.norm();
        GeometryError::positive("chord of an arc [m]", length)?;
        // h = (c / 2) (1 − b²) / (2 b), centre left of the chord for a left turn
        let height = 0.25 * (1.0 - bulge * bulge) / bulge;
        let left = Vector::new(-chord.y, chord.x);
        let centre = start + 0.5 * chord + height * left;
        let spoke = start - centre;
        let arc = Self {
            centre,
            radius: 0.25 * length * (1.0 + bulge * bulge) / bulge.abs(),
            start_angle: spoke.y.atan2(spoke.x),
            sweep: 4.0 * bulge.atan(),
        };
        arc.check()?;
        Ok(arc)
    }

    /// The shorter arc between two points \[m\] with a signed radius \[m\], positive to the left.
    ///
    /// # Errors
    /// Numbers that are not finite, coincident ends, or a radius below half the chord.
    pub fn with_radius(start: Point, end: Point, radius: f64) -> Result<Self, GeometryError> {
        GeometryError::finite("radius of an arc [m]", radius)?;
        // sin(Δ / 2) = c / (2 r)
        let sine = 0.5 * (end - start).norm() / radius;
        if sine.is_nan() || sine.abs() > 1.0 {
            return Err(GeometryError::OutOfRange {
                what: "radius of an arc [m]",
                value: radius,
                allowed: "at least half the chord",
            });
        }
        Self::with_bulge(start, end, (0.5 * sine.asin()).tan())
    }

    /// Refuses numbers outside their range.
    ///
    /// # Errors
    /// Names the first number that is not finite, a radius that is not positive, or a sweep that
    /// is zero or more than a full turn.
    pub fn check(&self) -> Result<(), GeometryError> {
        GeometryError::finite("arc centre x [m]", self.centre.x)?;
        GeometryError::finite("arc centre y [m]", self.centre.y)?;
        GeometryError::positive("arc radius [m]", self.radius)?;
        GeometryError::finite("arc start angle [rad]", self.start_angle)?;
        GeometryError::finite("arc sweep [rad]", self.sweep)?;
        if self.sweep == 0.0 || self.sweep.abs() > TAU * (1.0 + 4.0 * f64::EPSILON) {
            return Err(GeometryError::OutOfRange {
                what: "arc sweep [rad]",
                value: self.sweep,
                allowed: "in [−2π, 2π] and not zero",
            });
        }
        Ok(())
    }

    /// Which way it bends.
    pub fn turn(&self) -> Turn {
        if self.sweep > 0.0 {
            Turn::Left
        } else {
            Turn::Right
        }
    }

    /// Length \[m\].
    pub fn length(&self) -> f64 {
        self.radius * self.sweep.abs()
    }

    /// Signed curvature \[1/m\], positive for a left turn.
    pub fn curvature(&self) -> f64 {
        self.sweep.signum() / self.radius
    }

    /// Unit vector from the centre at a fraction of the sweep.
    pub fn spoke(&self, parameter: f64) -> Vector {
        let (sine, cosine) = (self.start_angle + parameter * self.sweep).sin_cos();
        Vector::new(cosine, sine)
    }

    /// Point at a fraction of the sweep, 0 at the start and 1 at the end \[m\].
    pub fn point(&self, parameter: f64) -> Point {
        self.centre + self.spoke(parameter) * self.radius
    }

    /// Unit direction of travel at a fraction of the sweep.
    pub fn tangent(&self, parameter: f64) -> Vector {
        let spoke = self.spoke(parameter);
        Vector::new(-spoke.y, spoke.x) * self.sweep.signum()
    }

    /// Fraction of the sweep at which the spoke through `p` lies; below 0 or above 1 outside.
    ///
    /// Outside the arc the nearer end decides on which side the fraction falls.
    pub fn parameter(&self, p: Point) -> f64 {
        let (start, spoke) = (self.spoke(0.0), p - self.centre);
        let angle = self.sweep.signum() * start.perp(&spoke).atan2(start.dot(&spoke));
        let sweep = self.sweep.abs();
        // The angle is known up to a full turn; keep it within half a turn of the middle.
        let middle = 0.5 * sweep;
        let angle = if angle < middle - PI {
            angle + TAU
        } else {
            angle
        };
        angle / sweep
    }

    /// Fraction of the sweep of the point nearest to `p`, if inside.
    ///
    /// None also when `p` faces the missing part of the circle, and at the centre itself, where
    /// every point is equally near.
    pub fn foot(&self, p: Point) -> Option<f64> {
        if p == self.centre {
            return None;
        }
        let s = self.parameter(p);
        (s > 0.0 && s < 1.0).then_some(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The three constructors agree on a quarter circle, in both senses (theory).
    #[test]
    fn constructors_agree() {
        let (start, end) = (Point::new(2.0, 1.0), Point::new(1.0, 2.0));
        for (turn, sign, centre) in [
            (Turn::Left, 1.0, Point::new(1.0, 1.0)),
            (Turn::Right, -1.0, Point::new(2.0, 2.0)),
        ] {
            let expected = Arc::between(start, end, centre, turn).unwrap();
            assert!((expected.sweep - sign * 0.5 * PI).abs() < 1e-15);
            for arc in [
                Arc::with_bulge(start, end, sign * (PI / 8.0).tan()).unwrap(),
                Arc::with_radius(start, end, sign).unwrap(),
            ] {
                assert!((arc.centre - centre).norm() < 1e-15);
                assert!((arc.radius - 1.0).abs() < 1e-15);
                assert!((arc.point(0.0) - start).norm() < 1e-15);
                assert!((arc.point(1.0) - end).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn a_wide_arc_knows_both_ends_of_its_gap() {
        let arc = Arc {
            centre: Point::origin(),
            radius: 1.0,
            start_angle: 0.25 * PI,
            sweep: 1.5 * PI,
        };
        assert!((arc.foot(Point::new(-3.0, 0.0)).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(arc.foot(Point::new(3.0, 0.1)), None);
        assert!(arc.parameter(Point::new(3.0, 0.1)) < 0.0);
        assert!(arc.parameter(Point::new(3.0, -0.1)) > 1.0);
    }
}
