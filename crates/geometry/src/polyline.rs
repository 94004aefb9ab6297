//! Parts of a curve, and the points of a polyline along it.

use std::f64::consts::FRAC_PI_2;

use crate::{Arc, ArcSpline, Foot, GeometryError, Piece, Point, Segment};

/// Chords may follow a curve as closely as this fraction of its size: millions of points serve nobody.
const FINEST: f64 = 1e-9;

impl ArcSpline {
    /// Arc length from the start of the curve to a fraction of one of its pieces \[m\].
    ///
    /// # Panics
    /// A piece that the curve does not have.
    pub fn arc_length(&self, piece: usize, parameter: f64) -> f64 {
        self.lengths[piece] + parameter * (self.lengths[piece + 1] - self.lengths[piece])
    }

    /// Arc length from the start of the curve to a foot on it \[m\].
    pub fn arc_length_of(&self, foot: &Foot) -> f64 {
        self.arc_length(foot.piece, foot.parameter)
    }

    /// Points along the curve such that no chord between two of them stands off it by more than `tolerance` \[m\].
    ///
    /// Joints are among the points. A closed curve ends with the point it starts from.
    ///
    /// ```text
    /// h = r (1 − cos ½φ) = 2 r sin² ¼φ   for a chord over the angle φ
    /// ```
    ///
    /// # Errors
    /// A tolerance below 10⁻⁹ of the size of the curve, or not a number.
    pub fn polyline(&self, tolerance: f64) -> Result<Vec<Point>, GeometryError> {
        if tolerance.is_nan() || tolerance < FINEST * self.aabb().diagonal() {
            return Err(GeometryError::OutOfRange {
                what: "tolerance of an outline [m]",
                value: tolerance,
                allowed: "at least a billionth of the size of the profile",
            });
        }
        let mut points = vec![self.pieces()[0].start()];
        for piece in self.pieces() {
            let chords = match piece {
                Piece::Segment(_) => 1,
                Piece::Arc(arc) => chords(arc, tolerance),
            };
            points.extend((1..chords).map(|k| piece.point(f64::from(k) / f64::from(chords))));
            points.push(piece.end());
        }
        Ok(points)
    }

    /// The part of an open curve between two arc lengths \[m\]; none where it is too short to have a direction.
    pub fn part(&self, from: f64, to: f64) -> Option<Self> {
        let mut pieces = Vec::new();
        for (index, piece) in self.pieces().iter().enumerate() {
            let (start, length) = (self.lengths[index], piece.length());
            let ends = [from, to].map(|s| ((s - start) / length).clamp(0.0, 1.0));
            if (ends[1] - ends[0]) * length > FINEST * self.aabb().diagonal() {
                pieces.push(cut(piece, ends));
            }
        }
        Self::open(&pieces).ok()
    }
}

/// Number of chords along an arc: equal ones, at most a quarter turn each.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the tolerance keeps the number far below 2³²"
)]
fn chords(arc: &Arc, tolerance: f64) -> u32 {
    // ¼φ = arcsin √(h/2r), without the cancellation of 1 − h/r
    let quarter = (0.5 * tolerance / arc.radius).sqrt().min(1.0).asin();
    let angle = (4.0 * quarter).min(FRAC_PI_2);
    (arc.sweep.abs() / angle).ceil().max(1.0) as u32
}

/// The part between two fractions of a piece.
fn cut(piece: &Piece, [from, to]: [f64; 2]) -> Piece {
    match piece {
        Piece::Segment(segment) => Segment::new(segment.point(from), segment.point(to)).into(),
        Piece::Arc(arc) => Arc {
            start_angle: arc.start_angle + from * arc.sweep,
            sweep: (to - from) * arc.sweep,
            ..*arc
        }
        .into(),
    }
}
