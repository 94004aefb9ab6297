//! Curves as drawings exchange them: corners, and a bulge for every piece between two of them.

use std::f64::consts::PI;

use crate::arc_spline::GAP;
use crate::{Arc, ArcSpline, BoundingBox, GeometryError, Piece, Point, Segment};

/// Largest sweep \[rad\] of a piece that is handed out: an arc of more than half a turn is poorly given by its ends.
const LARGEST_SWEEP: f64 = 0.9 * PI;

/// Neighbours lie on one circle when their directions \[rad\] and curvatures \[–\] agree to this: what rounding leaves of them.
const SAME_DIRECTION: f64 = 1e-7;
const SAME_CURVATURE: f64 = 1e-6;

impl ArcSpline {
    /// Curve through corners \[m\] with a bulge \[–\] for every piece, zero for a straight one; with as many bulges as corners the last piece
    /// goes back to the first corner.
    ///
    /// The curve is open even then, so that it may run clockwise, or cross itself. Pieces that are next to nothing are left out.
    ///
    /// # Errors
    /// Numbers that are not finite, and as [`open`](Self::open).
    pub fn with_bulges(points: &[Point], bulges: &[f64]) -> Result<Self, GeometryError> {
        for point in points {
            GeometryError::finite("x of a corner [m]", point.x)?;
            GeometryError::finite("y of a corner [m]", point.y)?;
        }
        let boxes = points
            .iter()
            .map(|&point| BoundingBox::around(point, point));
        let bounds = boxes.reduce(|a, b| a.merged(&b));
        let least = GAP * bounds.map_or(0.0, |bounds| bounds.diagonal());
        let ends = points.iter().cycle().skip(1);
        let mut pieces = Vec::new();
        for ((&start, &end), &bulge) in points.iter().zip(ends).zip(bulges) {
            if (end - start).norm() <= least {
                continue;
            }
            pieces.push(if bulge == 0.0 {
                Piece::Segment(Segment::new(start, end))
            } else {
                Piece::Arc(Arc::with_bulge(start, end, bulge)?)
            });
        }
        Self::open(&pieces)
    }

    /// Corners \[m\] and the bulges \[–\] between them, as many of a closed curve. Neighbours on one line or circle are one piece, and arcs of
    /// nearly half a turn and more are several.
    pub fn bulges(&self) -> (Vec<Point>, Vec<f64>) {
        let (mut points, mut sweeps) = (Vec::new(), Vec::<f64>::new());
        let mut before: Option<&Piece> = None;
        for piece in self.pieces() {
            let sweep = match piece {
                Piece::Segment(_) => 0.0,
                Piece::Arc(arc) => arc.sweep,
            };
            let one = before.is_some_and(|before| is_continued(before, piece));
            before = Some(piece);
            match sweeps.last_mut() {
                Some(last) if one && (*last + sweep).abs() < LARGEST_SWEEP => *last += sweep,
                _ => {
                    let parts = (sweep.abs() / LARGEST_SWEEP).ceil().max(1.0);
                    let mut part = 0.0;
                    while part < parts {
                        points.push(piece.point(part / parts));
                        sweeps.push(sweep / parts);
                        part += 1.0;
                    }
                }
            }
        }
        if !self.is_closed() {
            points.extend(self.pieces().last().map(Piece::end));
        }
        // b = tan ¼Δ
        let bulges = sweeps.into_iter().map(|sweep| (0.25 * sweep).tan());
        (points, bulges.collect())
    }
}

/// Whether a piece lies on the line or circle of the one before it.
fn is_continued(before: &Piece, piece: &Piece) -> bool {
    let (arriving, leaving) = (before.end_tangent(), piece.start_tangent());
    let (own, other) = (before.curvature(), piece.curvature());
    arriving.perp(&leaving).abs() < SAME_DIRECTION
        && arriving.dot(&leaving) > 0.0
        && (other - own).abs() <= SAME_CURVATURE * own.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of two half turns is one of three arcs of 120° where it is a single piece, and four corners of a square stay (theory).
    #[test]
    fn corners_and_bulges_come_back() {
        let [left, right] = [-1.0, 1.0].map(|x| Point::new(x, 0.0));
        let circle = ArcSpline::with_bulges(&[left, right], &[1.0, 1.0]).unwrap();
        assert!((circle.length() - 2.0 * PI).abs() < 1e-14);
        let whole = Arc {
            centre: Point::origin(),
            radius: 1.0,
            start_angle: PI,
            sweep: 2.0 * PI,
        };
        let whole = ArcSpline::closed(&[whole.into()]).unwrap();
        let (points, bulges) = whole.bulges();
        assert_eq!((points.len(), bulges.len()), (3, 3));
        // tan 30°
        assert!(bulges.iter().all(|b| (b * b - 1.0 / 3.0).abs() < 1e-14));
        let square =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y));
        // What is next to nothing is left out, and the middle of a side is no corner.
        let corners = [
            square[0],
            Point::new(0.5, 0.0),
            square[1],
            square[1],
            square[2],
            square[3],
        ];
        let curve = ArcSpline::with_bulges(&corners, &[0.0; 6]).unwrap();
        assert_eq!(curve.pieces().len(), 5);
        let (points, bulges) = curve.bulges();
        assert_eq!(
            points,
            [square[0], square[1], square[2], square[3], square[0]]
        );
        assert_eq!(bulges, [0.0; 4]);
    }
}
