//! A gap drawn by the user.

use std::f64::consts::FRAC_PI_2;

use super::{Drawing, Wheel};
use crate::{ArcSpline, GeometryError, Piece, Point};

/// Checks the user's pieces and takes them as they are.
///
/// They must run from right to left, between the tooth centre lines at ±π/z from the gap axis, end
/// at the radius at which they start, and never turn back about the wheel centre, so that the
/// turned copies meet and no tooth overhangs.
pub(super) fn draw(wheel: &Wheel, pieces: &[Piece]) -> Result<Drawing, GeometryError> {
    let curve = ArcSpline::open(pieces)?;
    let (first, last) = (pieces[0].start(), pieces[pieces.len() - 1].end());
    let (sine, cosine) = wheel.half_angle.sin_cos();
    let (start_radius, end_radius) = (first.coords.norm(), last.coords.norm());

    // The outline allows gaps of 10⁻⁹ of its size; stay below after the rotation.
    let tolerance = 1e-9 * start_radius.max(end_radius);
    for (what, value) in [
        (
            "the start's distance from the right tooth centre line",
            first.x * cosine - first.y * sine,
        ),
        (
            "the end's distance from the left tooth centre line",
            last.x * cosine + last.y * sine,
        ),
        ("the difference of the end radii", end_radius - start_radius),
    ] {
        if value.abs() > tolerance {
            return Err(wheel.refuse(what, value, format!("below {tolerance} m")));
        }
    }
    if first.y <= 0.0 || last.y <= 0.0 {
        return Err(wheel.refuse(
            "the height of an end",
            first.y.min(last.y),
            "positive, the gap axis is +y".into(),
        ));
    }
    for piece in pieces {
        never_turns_back(wheel, piece)?;
    }
    let (root_radius, tip_radius) = pieces
        .iter()
        .map(radii)
        .fold((f64::INFINITY, 0.0_f64), |(least, most), (low, high)| {
            (least.min(low), most.max(high))
        });
    Ok(Drawing {
        seat_clearance: seat_radius(pieces).map_or(0.0, |r| r - 0.5 * wheel.roller_diameter),
        pointed: (curve.pieces().len() > 1) && is_edge(wheel, pieces),
        pieces: pieces.to_vec(),
        root_radius,
        tip_radius,
    })
}

/// Refuses a piece along which the polar angle about the wheel centre decreases.
fn never_turns_back(wheel: &Wheel, piece: &Piece) -> Result<(), GeometryError> {
    // The angle grows while x × t > 0. Along a segment x × t is constant; about an arc it is
    // ±(r + c · u) for the spoke u, smallest or largest where u points along c.
    let moment = |s: f64| piece.point(s).coords.perp(&piece.tangent(s));
    let mut least = moment(0.0).min(moment(1.0));
    if let Piece::Arc(arc) = piece {
        for p in [Point::from(arc.centre.coords * 2.0), Point::origin()] {
            // Seen from the arc's centre these two lie along c and −c.
            if let Some(s) = arc.foot(p) {
                least = least.min(moment(s));
            }
        }
    }
    // A radial line, x × t = 0, is allowed.
    let size = piece.start().coords.norm();
    if least < -1e-9 * size {
        return Err(wheel.refuse(
            "the lever arm of the path about the wheel centre",
            least,
            "nowhere negative, or the path turns back".into(),
        ));
    }
    Ok(())
}

/// Smallest and largest distance of a piece from the wheel centre \[m\].
fn radii(piece: &Piece) -> (f64, f64) {
    let mut inside = piece
        .foot(Point::origin())
        .map(|s| piece.point(s))
        .into_iter()
        .collect::<Vec<_>>();
    if let Piece::Arc(arc) = piece
        && let Some(s) = arc.foot(arc.centre + arc.centre.coords)
    {
        inside.push(arc.point(s));
    }
    inside
        .into_iter()
        .chain([piece.start(), piece.end()])
        .map(|p| p.coords.norm())
        .fold((f64::INFINITY, 0.0), |(low, high), r| {
            (low.min(r), high.max(r))
        })
}

/// Radius of the concave arc across the gap axis \[m\], if there is one.
fn seat_radius(pieces: &[Piece]) -> Option<f64> {
    pieces.iter().find_map(|piece| match piece {
        Piece::Arc(arc) if arc.sweep < 0.0 && arc.point(0.0).x > 0.0 && arc.point(1.0).x < 0.0 => {
            Some(arc.radius)
        }
        _ => None,
    })
}

/// Whether neighbouring gaps meet in an edge.
fn is_edge(wheel: &Wheel, pieces: &[Piece]) -> bool {
    let leaving = pieces[0].rotated(2.0 * wheel.half_angle).start_tangent();
    let arriving = pieces[pieces.len() - 1].end_tangent();
    let turning = arriving.perp(&leaving).atan2(arriving.dot(&leaving));
    turning > 1e-6 && turning < 2.0 * FRAC_PI_2
}
