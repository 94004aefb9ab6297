//! Where a straight line crosses a piece.

use crate::{Piece, Point, Vector};

/// Crossings just beyond the ends of a piece count, so that none slips through a joint.
const MARGIN: f64 = 1e-9;

/// Calls `found` with (t, s) for every crossing of the line a + t v with the piece at its
/// fraction s.
///
/// A line along a segment, or one that touches it only in its extension, does not cross it.
pub(crate) fn crossings(piece: &Piece, a: Point, v: Vector, mut found: impl FnMut(f64, f64)) {
    let on_piece = |s: f64| (-MARGIN..=1.0 + MARGIN).contains(&s);
    match piece {
        Piece::Segment(segment) => {
            // a + t v = b + s w:  t = (b − a) × w / (v × w),  s = (b − a) × v / (v × w)
            let along = segment.end - segment.start;
            let between = segment.start - a;
            let denominator = v.perp(&along);
            let (t, s) = (
                between.perp(&along) / denominator,
                between.perp(&v) / denominator,
            );
            if denominator != 0.0 && on_piece(s) {
                found(t, s.clamp(0.0, 1.0));
            }
        }
        Piece::Arc(arc) => {
            // |a + t v − c|² = r²
            let from = a - arc.centre;
            let squared = v.norm_squared();
            let half = from.dot(&v) / squared;
            // Distance of the line from the centre, free of the cancellation in b² − a c.
            let offset = from.perp(&v);
            let root = (arc.radius * arc.radius * squared - offset * offset) / (squared * squared);
            if root < 0.0 || root.is_nan() {
                return;
            }
            for t in [-half - root.sqrt(), -half + root.sqrt()] {
                let s = arc.parameter(a + v * t);
                if on_piece(s) {
                    found(t, s.clamp(0.0, 1.0));
                }
            }
        }
    }
}
