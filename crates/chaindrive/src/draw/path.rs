//! Outlines as path data, in millimetres.

use std::fmt::Write;

use chaindrive_geometry::{ArcSpline, Piece, Point, Vector};
use chaindrive_mechanics::Placement;

use crate::terminal_text::one_line;

/// A length in millimetres, to a tenth of a micrometre.
pub(super) fn millimetres(metres: f64) -> String {
    let text = format!("{:.4}", metres * 1e3);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// The pieces of a curve in the place of its body.
pub(super) fn placed(curve: &ArcSpline, placement: &Placement) -> Vec<Piece> {
    let shift = Vector::new(placement.x, placement.y);
    let pieces = curve.pieces().iter();
    pieces
        .map(|piece| piece.rotated(placement.angle).translated(shift))
        .collect()
}

/// Path data of consecutive pieces: straight lines and true arcs.
pub(super) fn outline(pieces: &[Piece], closed: bool) -> String {
    let mut out = String::new();
    if let Some(first) = pieces.first() {
        let _ = write!(out, "M{}", point(first.start()));
    }
    for piece in pieces {
        match piece {
            Piece::Segment(_) => {
                let _ = write!(out, "L{}", point(piece.end()));
            }
            Piece::Arc(arc) => {
                // Parts below a half turn: the centre of a longer one would hang on the last digit of its ends.
                let parts = if arc.sweep.abs() > 2.0 { 2 } else { 1 };
                let radius = millimetres(arc.radius);
                let turn = u8::from(arc.sweep > 0.0);
                let halves = parts * if arc.sweep.abs() > 4.0 { 2 } else { 1 };
                for k in 1..=halves {
                    let end = piece.point(f64::from(k) / f64::from(halves));
                    let _ = write!(out, "A{radius} {radius} 0 0 {turn} {}", point(end));
                }
            }
        }
    }
    if closed {
        out.push('Z');
    }
    out
}

/// Path data of a closed polygon.
pub(super) fn polygon(points: &[Point]) -> String {
    format!("{}Z", polyline(points))
}

/// Path data of an open polygon.
pub(super) fn polyline(points: &[Point]) -> String {
    let corners: Vec<String> = points.iter().map(|p| point(*p)).collect();
    format!("M{}", corners.join("L"))
}

pub(super) fn point(p: Point) -> String {
    format!("{} {}", millimetres(p.x), millimetres(p.y))
}

/// An `id` of these parts, which names of XML may stand for: other characters by their number.
pub(super) fn id(parts: &[&str]) -> String {
    let mut out = String::new();
    for c in parts.join("-").chars() {
        if c.is_alphanumeric() || "-_.".contains(c) {
            out.push(c);
        } else {
            let _ = write!(out, "_{:x}", u32::from(c));
        }
    }
    out
}

/// A text as XML has it, between tags.
pub fn escaped(text: &str) -> String {
    one_line(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use chaindrive_geometry::{Arc, Segment};

    #[test]
    fn lengths_keep_a_tenth_of_a_micrometre() {
        for (metres, text) in [
            (0.0, "0"),
            (-1e-9, "0"),
            (0.1, "100"),
            (-0.012_345_67, "-12.3457"),
        ] {
            assert_eq!(millimetres(metres), text);
        }
    }

    #[test]
    fn outlines_are_lines_and_arcs() {
        let line = Segment::new(Point::new(0.0, 0.0), Point::new(0.01, 0.0));
        let arc = Arc {
            centre: Point::new(0.01, 0.005),
            radius: 0.005,
            start_angle: -std::f64::consts::FRAC_PI_2,
            sweep: std::f64::consts::PI,
        };
        let pieces = [Piece::Segment(line), Piece::Arc(arc)];
        assert_eq!(
            outline(&pieces, false),
            "M0 0L10 0A5 5 0 0 1 15 5A5 5 0 0 1 10 10"
        );
    }

    #[test]
    fn names_become_identifiers() {
        assert_eq!(id(&["sprocket", "crank"]), "sprocket-crank");
        assert_eq!(id(&["guide", "left <rail>"]), "guide-left_20_3crail_3e");
    }
}
