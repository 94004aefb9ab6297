//! Area and its moments, by Green's theorem piece after piece.

use crate::{ArcSpline, Piece, Point, Vector};

/// Area of a solid and its moments about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaMoments {
    /// Area A \[m²\].
    pub area: f64,
    /// First moment ∫ x dA \[m³\].
    pub first: Vector,
    /// Polar second moment about the origin ∫ |x|² dA \[m⁴\].
    pub polar: f64,
}

impl AreaMoments {
    /// Of the area that pieces enclose which come back to where they begin; negative where they run clockwise.
    pub fn of(pieces: &[Piece]) -> Self {
        pieces.iter().fold(Self::default(), |sum, piece| {
            let chord = Self::triangle(piece.start().coords, piece.end().coords);
            let sum = sum.plus(chord);
            match piece {
                Piece::Segment(_) => sum,
                Piece::Arc(arc) => sum.plus(Self::circular_segment(arc)),
            }
        })
    }

    fn plus(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            first: self.first + other.first,
            polar: self.polar + other.polar,
        }
    }

    /// Centroid \[m\].
    pub fn centroid(&self) -> Point {
        Point::from(self.first / self.area)
    }

    /// Polar second moment about the centroid \[m⁴\].
    pub fn central(&self) -> f64 {
        // J_c = J_o − A |x_c|²
        self.polar - self.first.norm_squared() / self.area
    }

    /// Triangle from the origin over a chord, positive when the chord turns to the left.
    fn triangle(a: Vector, b: Vector) -> Self {
        let area = 0.5 * a.perp(&b);
        Self {
            area,
            first: (a + b) * (area / 3.0),
            // ∫ |x|² dA = A (|a|² + a·b + |b|²) / 6
            polar: area * (a.norm_squared() + a.dot(&b) + b.norm_squared()) / 6.0,
        }
    }

    /// Area between an arc and its chord, positive for a left turn.
    fn circular_segment(arc: &crate::Arc) -> Self {
        // With half angle α, about the centre:
        //   A = r² (α − sin α cos α),   S = ⅔ r³ sin³ α along the middle,
        //   J = ½ r⁴ (α − sin α cos³ α − ⅓ sin³ α cos α)
        let alpha = 0.5 * arc.sweep.abs();
        let (s, c) = alpha.sin_cos();
        let (r, sign) = (arc.radius, arc.sweep.signum());
        let area = sign * r * r * (alpha - s * c);
        let about_centre = arc.spoke(0.5) * (sign * 2.0 / 3.0 * (r * s).powi(3));
        let polar = sign * 0.5 * r.powi(4) * (alpha - s * c * (c * c + s * s / 3.0));
        let centre = arc.centre.coords;
        Self {
            area,
            first: about_centre + centre * area,
            polar: polar + 2.0 * centre.dot(&about_centre) + area * centre.norm_squared(),
        }
    }
}

impl ArcSpline {
    /// Area of the solid inside a closed curve and its moments; zero for an open one.
    pub fn area_moments(&self) -> AreaMoments {
        if self.is_closed() {
            AreaMoments::of(self.pieces())
        } else {
            AreaMoments::default()
        }
    }

    /// Signed area inside a closed curve \[m²\].
    pub(crate) fn area(&self) -> f64 {
        self.area_moments().area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arc, Segment};
    use std::f64::consts::PI;

    /// A half disc off the origin: A = π r² / 2, centroid 4 r / 3 π from the diameter,
    /// J = π r⁴ / 4 about the middle of the diameter (theory).
    #[test]
    fn half_disc() {
        let (r, centre) = (0.3, Point::new(2.0, -1.0));
        let arc = Arc {
            centre,
            radius: r,
            start_angle: 0.0,
            sweep: PI,
        };
        let disc = ArcSpline::closed(&[
            arc.into(),
            Segment::new(centre - Vector::x() * r, centre + Vector::x() * r).into(),
        ])
        .unwrap()
        .area_moments();
        let rise = 4.0 * r / (3.0 * PI);
        assert!((disc.area - 0.5 * PI * r * r).abs() < 1e-15);
        assert!((disc.centroid() - centre - Vector::y() * rise).norm() < 1e-14);
        let central = 0.25 * PI * r.powi(4) - disc.area * rise * rise;
        assert!((disc.central() - central).abs() < 1e-14);
    }
}
