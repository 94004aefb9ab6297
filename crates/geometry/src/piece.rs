//! One piece of a curve: straight or circular.

use crate::{Arc, GeometryError, Point, Segment, Vector};

/// A piece of a curve, travelled from start to end with the material on the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// Straight.
    Segment(Segment),
    /// Circular.
    Arc(Arc),
}

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Lower left corner \[m\].
    pub min: Point,
    /// Upper right corner \[m\].
    pub max: Point,
}

impl BoundingBox {
    /// The smallest box around two points \[m\].
    pub fn around(a: Point, b: Point) -> Self {
        Self {
            min: a.inf(&b),
            max: a.sup(&b),
        }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn merged(&self, other: &Self) -> Self {
        Self {
            min: self.min.inf(&other.min),
            max: self.max.sup(&other.max),
        }
    }

    /// Length of the diagonal \[m\].
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).norm()
    }

    /// Whether the point lies inside or on the border.
    pub fn contains(&self, p: Point) -> bool {
        (self.min.x..=self.max.x).contains(&p.x) && (self.min.y..=self.max.y).contains(&p.y)
    }
}

impl From<Segment> for Piece {
    fn from(segment: Segment) -> Self {
        Self::Segment(segment)
    }
}

impl From<Arc> for Piece {
    fn from(arc: Arc) -> Self {
        Self::Arc(arc)
    }
}

impl Piece {
    /// Refuses numbers outside their range.
    ///
    /// # Errors
    /// See [`Segment::check`] and [`Arc::check`].
    pub fn check(&self) -> Result<(), GeometryError> {
        match self {
            Self::Segment(segment) => segment.check(),
            Self::Arc(arc) => arc.check(),
        }
    }

    /// Where it starts \[m\].
    pub fn start(&self) -> Point {
        self.point(0.0)
    }

    /// Where it ends \[m\].
    pub fn end(&self) -> Point {
        match self {
            Self::Segment(segment) => segment.end,
            Self::Arc(arc) => arc.point(1.0),
        }
    }

    /// Unit direction of travel at the start.
    pub fn start_tangent(&self) -> Vector {
        self.tangent(0.0)
    }

    /// Unit direction of travel at the end.
    pub fn end_tangent(&self) -> Vector {
        self.tangent(1.0)
    }

    /// Point at a fraction of the length, 0 at the start and 1 at the end \[m\].
    pub fn point(&self, parameter: f64) -> Point {
        match self {
            Self::Segment(segment) => segment.point(parameter),
            Self::Arc(arc) => arc.point(parameter),
        }
    }

    /// Unit direction of travel at a fraction of the length.
    pub fn tangent(&self, parameter: f64) -> Vector {
        match self {
            Self::Segment(segment) => segment.tangent(),
            Self::Arc(arc) => arc.tangent(parameter),
        }
    }

    /// Outward unit normal at a fraction of the length, to the right of travel.
    pub fn normal(&self, parameter: f64) -> Vector {
        right_of(self.tangent(parameter))
    }

    /// Length \[m\].
    pub fn length(&self) -> f64 {
        match self {
            Self::Segment(segment) => segment.length(),
            Self::Arc(arc) => arc.length(),
        }
    }

    /// Signed curvature \[1/m\]: positive where the material is convex, zero on a segment.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Segment(_) => 0.0,
            Self::Arc(arc) => arc.curvature(),
        }
    }

    /// Bulge \[–\], as CAD polylines store it, zero on a segment; see [`Arc::with_bulge`].
    pub fn bulge(&self) -> f64 {
        match self {
            Self::Segment(_) => 0.0,
            Self::Arc(arc) => (0.25 * arc.sweep).tan(),
        }
    }

    /// Fraction of the length of the foot of the perpendicular from `p`, if strictly inside.
    ///
    /// For an arc this is the near one of the two perpendiculars; none when `p` faces the part of
    /// the circle the arc leaves out.
    pub fn foot(&self, p: Point) -> Option<f64> {
        match self {
            Self::Segment(segment) => segment.foot(p),
            Self::Arc(arc) => arc.foot(p),
        }
    }

    /// The same points travelled the other way; the material changes sides.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match *self {
            Self::Segment(Segment { start, end }) => Segment::new(end, start).into(),
            Self::Arc(arc) => Arc {
                start_angle: arc.start_angle + arc.sweep,
                sweep: -arc.sweep,
                ..arc
            }
            .into(),
        }
    }

    /// Mirror image in the y axis, x → −x; the material changes sides.
    ///
    /// Follow it by [`reversed`](Self::reversed) to keep the material on the left.
    #[must_use]
    pub fn mirrored_x(&self) -> Self {
        let mirrored = |p: Point| Point::new(-p.x, p.y);
        match *self {
            Self::Segment(Segment { start, end }) => {
                Segment::new(mirrored(start), mirrored(end)).into()
            }
            Self::Arc(arc) => Arc {
                centre: mirrored(arc.centre),
                start_angle: std::f64::consts::PI - arc.start_angle,
                sweep: -arc.sweep,
                ..arc
            }
            .into(),
        }
    }

    /// Turned about the origin by an angle \[rad\].
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        let turned = |p: Point| Point::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
        match *self {
            Self::Segment(Segment { start, end }) => {
                Segment::new(turned(start), turned(end)).into()
            }
            Self::Arc(arc) => Arc {
                centre: turned(arc.centre),
                start_angle: arc.start_angle + angle,
                ..arc
            }
            .into(),
        }
    }

    /// Shifted by a displacement \[m\].
    #[must_use]
    pub fn translated(&self, by: Vector) -> Self {
        match *self {
            Self::Segment(Segment { start, end }) => Segment::new(start + by, end + by).into(),
            Self::Arc(arc) => Arc {
                centre: arc.centre + by,
                ..arc
            }
            .into(),
        }
    }

    /// The smallest box around the piece.
    pub fn aabb(&self) -> BoundingBox {
        let ends = BoundingBox::around(self.start(), self.end());
        let Self::Arc(arc) = self else { return ends };
        // The four extremes of the circle that the arc passes through widen the box of its ends.
        let axes = [Vector::x(), Vector::y(), -Vector::x(), -Vector::y()];
        axes.iter()
            .map(|axis| arc.centre + axis * arc.radius)
            .filter(|&extreme| arc.foot(extreme).is_some())
            .fold(ends, |bounds, extreme| {
                bounds.merged(&BoundingBox::around(extreme, extreme))
            })
    }
}

/// The right normal of a direction of travel: out of the material.
pub(crate) fn right_of(tangent: Vector) -> Vector {
    // n = (t_y, −t_x)
    Vector::new(tangent.y, -tangent.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn mirrored_and_reversed_pieces_keep_their_curvature() {
        let seat = Piece::from(Arc {
            centre: Point::new(0.3, 1.0),
            radius: 0.5,
            start_angle: 0.2,
            sweep: -2.5,
        });
        let twin = seat.mirrored_x().reversed();
        assert!((twin.curvature() - seat.curvature()).abs() < 1e-15);
        let mirrored = Point::new(-seat.end().x, seat.end().y);
        assert!((twin.start() - mirrored).norm() < 1e-15);
        assert!((seat.reversed().start_tangent() + seat.end_tangent()).norm() < 1e-15);
    }

    #[test]
    fn the_box_of_an_arc_reaches_its_extremes() {
        let arc = Piece::from(Arc {
            centre: Point::origin(),
            radius: 2.0,
            start_angle: -0.25 * PI,
            sweep: 0.75 * PI,
        });
        let bounds = arc.aabb();
        assert!((bounds.max.x - 2.0).abs() < 1e-15);
        assert!((bounds.max.y - 2.0).abs() < 1e-15);
        assert!((bounds.min.y + 2.0_f64.sqrt()).abs() < 1e-15);
    }
}
