//! Chains that run over the ends of the guides that turn them.

use std::f64::consts::TAU;

use chaindrive_geometry::{Arc, ArcSpline, Piece, Route, Side};

use super::wheels::wheels;
use crate::Clash;
use crate::body_positions::BodyPositions;
use crate::check::clash::called;
use crate::drive::{Layout, Parts, Stop};

/// Angle \[rad\] by which a face may end too early. *Assumed*: the links of a chain turn by more than that from one to the next on any
/// guide that is bent at all, and an edge that turns them by less presses no harder than the face.
const NEGLIGIBLE: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Faces that end before the chain has turned as far as the taut route leads it over them.
///
/// ```text
/// β = w/2 − a        a: angle from the middle of the wrap w to the end of the face
/// ```
///
/// Guides beside the route do not turn the chain as it is laid, and are not looked at.
pub(super) fn of(parts: &Parts, index: usize, standing: &BodyPositions) -> Vec<Clash> {
    let placed = &parts.chains[index];
    let Layout::Route { stops, .. } = &placed.layout else {
        return Vec::new();
    };
    if !stops.iter().any(|stop| matches!(stop, Stop::Guide(_))) {
        return Vec::new();
    }
    let stood = stood(parts, standing);
    // A route that is none any more is told of elsewhere.
    let Ok(route) =
        wheels(&stood, &placed.chain, stops).and_then(|wheels| Ok(Route::taut(&wheels)?))
    else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for (place, stop) in stops.iter().enumerate() {
        let Stop::Guide(guide) = *stop else {
            continue;
        };
        let face = &standing.faces[guide];
        let Some((before, arc, behind)) = longest_arc(face) else {
            continue;
        };
        let wrap = route.wraps[place];
        // On the left of the chain lies what it turns around counter-clockwise: it runs along the face as the face is described.
        let along = route.wheels[place].side == Side::Left;
        let arriving = route.spans[(place + stops.len() - 1) % stops.len()].direction;
        let middle = arriving + 0.5 * route.wheels[place].sense() * wrap;
        // The normal of the face stands to the right of a chain that has it on its left.
        let normal = middle - route.wheels[place].sense() * 0.25 * TAU;
        let mut reached = (normal - arc.start_angle).rem_euclid(TAU);
        // Beside the arc it is beyond the nearer end.
        if reached - arc.sweep > TAU - reached {
            reached -= TAU;
        }
        let ends = [
            (
                reached + before,
                face.pieces().first().map(Piece::start),
                !along,
            ),
            (
                arc.sweep - reached + behind,
                face.pieces().last().map(Piece::end),
                along,
            ),
        ];
        for (angle, at, off) in ends {
            let short = 0.5 * wrap - angle;
            if let Some(at) = at.filter(|_| short > NEGLIGIBLE) {
                found.push(Clash::Overrun {
                    chain: called(parts, index),
                    guide: parts.guides[guide].name.clone(),
                    wrap,
                    short,
                    missing: short * arc.radius,
                    off,
                    at,
                });
            }
        }
    }
    found
}

/// The parts with sprockets and faces where they stand.
fn stood(parts: &Parts, standing: &BodyPositions) -> Parts {
    let mut parts = parts.clone();
    for (sprocket, (centre, _)) in parts.sprockets.iter_mut().zip(&standing.sprockets) {
        sprocket.centre = *centre;
    }
    for (guide, face) in parts.guides.iter_mut().zip(&standing.faces) {
        guide.face = face.clone();
    }
    parts
}

/// The bulging arc that the route lies on, and the angles by which the face turns before and after it.
fn longest_arc(face: &ArcSpline) -> Option<(f64, Arc, f64)> {
    let pieces = face.pieces();
    let arcs = pieces
        .iter()
        .enumerate()
        .filter_map(|(k, piece)| match piece {
            Piece::Arc(arc) if arc.sweep > 0.0 => Some((k, *arc)),
            _ => None,
        });
    let (place, arc) = arcs.max_by(|(_, a), (_, b)| {
        let length = |arc: &Arc| arc.radius * arc.sweep;
        length(a).total_cmp(&length(b))
    })?;
    let sweep = |pieces: &[Piece]| pieces.iter().map(sweep).sum::<f64>();
    let before = sweep(&pieces[..place]) + corners(&pieces[..=place]);
    let behind = sweep(&pieces[place + 1..]) + corners(&pieces[place..]);
    Some((before, arc, behind))
}

/// Angle \[rad\] by which a piece of a face turns.
fn sweep(piece: &Piece) -> f64 {
    match piece {
        Piece::Arc(arc) => arc.sweep,
        Piece::Segment(_) => 0.0,
    }
}

/// Angle \[rad\] by which a face turns between its pieces.
fn corners(pieces: &[Piece]) -> f64 {
    let turns = pieces.windows(2).map(|pair| {
        let (from, to) = (pair[0].end_tangent(), pair[1].start_tangent());
        (from.x * to.y - from.y * to.x).atan2(from.dot(&to))
    });
    turns.sum()
}
