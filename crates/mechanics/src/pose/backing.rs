//! The material behind the face of a guide, as it is drawn.

use chaindrive_geometry::{ArcSpline, GeometryError, Piece, Point};

/// Thickness in pitches: that of a slender rail.
const THICKNESS: f64 = 0.4;
/// Share of the radius of a bulging arc that the material may fill.
const FILLED: f64 = 0.5;
/// Largest distance of chords from the face, in fractions of its size.
const COARSE: f64 = 1e-4;

/// A closed polygon of the face and a line behind it.
pub(super) fn behind(face: &ArcSpline, pitch: f64) -> Result<Vec<Point>, GeometryError> {
    let radii = face.pieces().iter().filter_map(|piece| match piece {
        Piece::Arc(arc) if arc.sweep > 0.0 => Some(arc.radius),
        _ => None,
    });
    let thickness = (THICKNESS * pitch).min(FILLED * radii.fold(f64::INFINITY, f64::min));
    let front = face.polyline(COARSE * face.aabb().diagonal())?;
    let pieces = face.pieces().iter();
    let back = pieces.flat_map(|piece| {
        let count = match piece {
            // Chords of a tenth of a radian.
            Piece::Arc(arc) => (1..64).find(|&count| arc.sweep.abs() <= 0.1 * f64::from(count)),
            Piece::Segment(_) => None,
        };
        let count = count.unwrap_or(1);
        (0..=count).map(move |k| {
            let share = f64::from(k) / f64::from(count);
            piece.point(share) - piece.normal(share) * thickness
        })
    });
    let back: Vec<Point> = back.collect();
    Ok(front.into_iter().chain(back.into_iter().rev()).collect())
}
