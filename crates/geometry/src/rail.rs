//! Working face of a guide.

use crate::{Arc, ArcSpline, GeometryError, Piece, Point, Segment, Vector};

/// Below this part of the rail's size \[–\] a straight piece between two roundings is left out.
const NOTHING: f64 = 1e-9;

/// Face of a guide from a polyline with rounded corners, the material on the left of travel.
///
/// Between its two ends every point is a corner; `radii` \[m\] has one entry for each of these,
/// and 0 keeps it sharp. A rounding is an arc tangent to both sides, which begins
///
/// ```text
/// t = r tan(τ / 2)
/// ```
///
/// before the corner, where τ is the change of direction there.
///
/// # Errors
/// Fewer than two points; a number of radii other than that of the corners; numbers that are not
/// finite; a negative radius; neighbouring points that coincide; a rounding longer than its sides.
///
/// # Example
///
/// ```
/// use chaindrive_geometry::{Point, rail};
///
/// # fn main() -> Result<(), chaindrive_geometry::GeometryError> {
/// let points = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
/// let face = rail(&points, &[0.2])?;
/// assert_eq!(face.pieces().len(), 3);
/// assert!(face.corners().is_empty());
/// # Ok(())
/// # }
/// ```
pub fn rail(points: &[Point], radii: &[f64]) -> Result<ArcSpline, GeometryError> {
    check(points, radii)?;
    let sides: Vec<Vector> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let lengths: Vec<f64> = sides.iter().map(Vector::norm).collect();
    let turnings: Vec<f64> = sides
        .windows(2)
        .map(|pair| pair[0].perp(&pair[1]).atan2(pair[0].dot(&pair[1])))
        .collect();

    // How much of its sides each point takes; the two ends take nothing.
    let mut takes = vec![0.0; points.len()];
    for (corner, (radius, turning)) in radii.iter().zip(&turnings).enumerate() {
        // t = r tan(τ / 2)
        takes[corner + 1] = radius * (0.5 * turning.abs()).tan();
    }
    let size: f64 = lengths.iter().sum();
    for (side, length) in lengths.iter().enumerate() {
        let (before, after) = (takes[side], takes[side + 1]);
        if before + after > length + NOTHING * size {
            let (corner, needed, other) = if before > after {
                (side, before, after)
            } else {
                (side + 1, after, before)
            };
            return Err(GeometryError::Rounding {
                corner,
                needed,
                available: length - other,
            });
        }
    }

    let mut pieces: Vec<Piece> = Vec::new();
    for side in 0..sides.len() {
        let along = sides[side] / lengths[side];
        let start = points[side] + along * takes[side];
        let end = points[side + 1] - along * takes[side + 1];
        if lengths[side] - takes[side] - takes[side + 1] > NOTHING * size {
            pieces.push(Segment::new(start, end).into());
        }
        if takes[side + 1] > NOTHING * size {
            pieces.push(rounding(end, along, radii[side], turnings[side]).into());
        }
    }
    ArcSpline::open(&pieces)
}

/// Straight bar with a convex arc at each end that leads away from the chain, into the material.
///
/// The straight face runs from `start` to `end` \[m\], the material on its left; the arcs have
/// radius `end_radius` \[m\] and turn by `end_angle` \[rad\].
///
/// # Errors
/// Numbers that are not finite; ends that coincide; a radius that is not positive; an angle
/// outside (0, π].
pub fn bar(
    start: Point,
    end: Point,
    end_radius: f64,
    end_angle: f64,
) -> Result<ArcSpline, GeometryError> {
    check(&[start, end], &[])?;
    GeometryError::positive("radius of the ends of a bar [m]", end_radius)?;
    GeometryError::positive("angle of the ends of a bar [rad]", end_angle)?;
    if end_angle > std::f64::consts::PI {
        return Err(GeometryError::OutOfRange {
            what: "angle of the ends of a bar [rad]",
            value: end_angle,
            allowed: "in (0, π]",
        });
    }
    let along = (end - start).normalize();
    let leading = rounding(start, -along, end_radius, -end_angle);
    let trailing = rounding(end, along, end_radius, end_angle);
    ArcSpline::open(&[
        Piece::Arc(leading).reversed(),
        Segment::new(start, end).into(),
        trailing.into(),
    ])
}

fn check(points: &[Point], radii: &[f64]) -> Result<(), GeometryError> {
    let count = |what, got, expected| {
        Err(GeometryError::Count {
            what,
            got,
            expected,
        })
    };
    if points.len() < 2 {
        return count("points of a rail", points.len(), "at least 2".into());
    }
    let corners = points.len() - 2;
    if radii.len() != corners {
        let expected = format!("{corners}, one for each corner");
        return count("radii of a rail", radii.len(), expected);
    }
    for p in points {
        GeometryError::finite("x of a point of a rail [m]", p.x)?;
        GeometryError::finite("y of a point of a rail [m]", p.y)?;
    }
    for &radius in radii {
        GeometryError::finite("radius of a rail [m]", radius)?;
        if radius < 0.0 {
            return Err(GeometryError::OutOfRange {
                what: "radius of a rail [m]",
                value: radius,
                allowed: "positive, or zero for a sharp corner",
            });
        }
    }
    match points.windows(2).position(|pair| pair[0] == pair[1]) {
        Some(first) => Err(GeometryError::Coincident {
            first,
            second: first + 1,
        }),
        None => Ok(()),
    }
}

/// Arc that leaves a point in a direction and turns by an angle \[rad\].
fn rounding(from: Point, direction: Vector, radius: f64, turning: f64) -> Arc {
    let left = Vector::new(-direction.y, direction.x) * turning.signum();
    Arc {
        centre: from + left * radius,
        radius,
        start_angle: (-left.y).atan2(-left.x),
        sweep: turning,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar's face keeps its length and its end arcs sink into the material by
    /// R (1 − cos φ) (theory).
    #[test]
    fn bars_lead_in_and_out() {
        let (radius, angle) = (1.0, 8.0_f64.to_radians());
        let face = bar(Point::new(0.5, 0.0), Point::new(-0.5, 0.0), radius, angle).unwrap();
        assert!(face.corners().is_empty());
        assert!((face.length() - 1.0 - 2.0 * radius * angle).abs() < 1e-15);
        let sunk = radius * (1.0 - angle.cos());
        for end in [face.point_at(0.0), face.point_at(face.length())] {
            assert!((end.y + sunk).abs() < 1e-15, "{end}");
            assert!((end.x.abs() - 0.5 - radius * angle.sin()).abs() < 1e-15);
        }
        // The void is above.
        assert!(face.nearest(Point::new(0.1, 0.2), 1.0).unwrap().distance > 0.0);
    }

    #[test]
    fn a_rounding_that_does_not_fit_is_named() {
        let points =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0)].map(|(x, y)| Point::new(x, y));
        assert!(rail(&points, &[0.5, 0.5]).is_ok());
        assert_eq!(
            rail(&points, &[0.7, 0.5]).unwrap_err(),
            GeometryError::Rounding {
                corner: 1,
                needed: 0.7 * (0.5 * std::f64::consts::FRAC_PI_2).tan(),
                available: 1.0 - 0.5 * (0.5 * std::f64::consts::FRAC_PI_2).tan(),
            }
        );
        assert_eq!(rail(&points, &[0.0, 0.0]).unwrap().corners().len(), 2);
        assert!(rail(&points, &[0.1]).is_err());
        assert!(rail(&points, &[0.1, -0.1]).is_err());
        assert!(rail(&points[..1], &[]).is_err());
        assert!(rail(&[points[0], points[0]], &[]).is_err());
        // Straight on needs no arc; straight back has no rounding that fits.
        let line = [points[0], points[1], Point::new(3.0, 0.0)];
        assert_eq!(rail(&line, &[0.3]).unwrap().pieces().len(), 2);
        assert!(rail(&[points[0], points[1], points[0]], &[0.1]).is_err());
    }
}
