//! Tangent arcs through measured points.

use crate::{Arc, GeometryError, Piece, Point, Segment, Vector};

/// Tangent-continuous arcs and segments through points of a smooth curve.
///
/// The curve passes through the first and the last point and through some of those between; every
/// other point lies within `tolerance` \[m\] of it. Where it leaves a polygon between two points
/// it does so by about the sagitta of the arc they lie on, which is the purpose.
///
/// Each stretch is a biarc, two arcs tangent to each other and to given directions at both ends.
/// The direction at a point is that of the circle through it and its two neighbours. Stretches are
/// made as long as the tolerance allows, one after the other. A closed fit returns to the first
/// point, which must not be repeated at the end.
///
/// Meant for drawings and measurements of smooth shapes, with noise well below the spacing of the
/// points. A corner comes out as a tight pair of arcs through its neighbours: fit the two sides
/// separately to keep it sharp.
///
/// # Errors
/// Fewer than two points (three for a closed curve), coordinates or a tolerance that are not
/// finite, a tolerance that is not positive, neighbouring points that coincide, or a curve that
/// turns straight back between two points.
///
/// # Source
/// K. M. Bolton, *Biarc curves*, Computer-Aided Design **7**(2), 1975, 89–92.
pub fn fit_arcs(
    points: &[Point],
    closed: bool,
    tolerance: f64,
) -> Result<Vec<Piece>, GeometryError> {
    check(points, closed, tolerance)?;
    let tangents = tangents(points, closed);
    let n = points.len();
    let last = if closed { n } else { n - 1 };
    let mut pieces: Vec<Piece> = Vec::new();
    let mut from = 0;
    while from < last {
        let attempt = |to: usize| {
            let (a, b) = (from % n, to % n);
            let pair = biarc(points[a], tangents[a], points[b], tangents[b])?;
            let between = (from + 1..to).map(|i| points[i % n]);
            follows(&pair, between, tolerance).then_some(pair)
        };
        let mut best = attempt(from + 1).ok_or(GeometryError::OutOfRange {
            what: "change of direction between two points to fit [rad]",
            value: turning(tangents[from % n], tangents[(from + 1) % n]),
            allowed: "well below half a turn",
        })?;
        let mut to = from + 1;
        // A stretch that fails may still be part of a longer one that holds, but rarely: give up
        // after a few.
        for next in from + 2..=last {
            if let Some(pair) = attempt(next) {
                (best, to) = (pair, next);
            } else if next > to + 3 {
                break;
            }
        }
        for piece in best {
            push_or_extend(&mut pieces, piece);
        }
        from = to;
    }
    Ok(pieces)
}

fn check(points: &[Point], closed: bool, tolerance: f64) -> Result<(), GeometryError> {
    GeometryError::positive("tolerance of a fit [m]", tolerance)?;
    let least = if closed { 3 } else { 2 };
    if points.len() < least {
        return Err(GeometryError::Count {
            what: "points to fit",
            got: points.len(),
            expected: format!("at least {least}"),
        });
    }
    for p in points {
        GeometryError::finite("x of a point to fit [m]", p.x)?;
        GeometryError::finite("y of a point to fit [m]", p.y)?;
    }
    let sides = if closed {
        points.len()
    } else {
        points.len() - 1
    };
    for first in 0..sides {
        let second = (first + 1) % points.len();
        if points[first] == points[second] {
            return Err(GeometryError::Coincident { first, second });
        }
    }
    Ok(())
}

/// Unit direction at each point, of the circle through it and its neighbours.
fn tangents(points: &[Point], closed: bool) -> Vec<Vector> {
    let n = points.len();
    let side = |i: usize| points[(i + 1) % n] - points[i % n];
    (0..n)
        .map(|i| {
            if !closed && n == 2 {
                side(0).normalize()
            } else if !closed && i == 0 {
                // The chord, turned back by half of what the circle turns along it.
                reflected(middle(side(0), side(1)), side(0))
            } else if !closed && i == n - 1 {
                reflected(middle(side(n - 3), side(n - 2)), side(n - 2))
            } else {
                middle(side(i + n - 1), side(i))
            }
        })
        .collect()
}

/// Tangent of the circle through three points at the middle one, from the two chords.
fn middle(before: Vector, after: Vector) -> Vector {
    // t ∝ u₁ / |c₁| + u₂ / |c₂| with unit chords u: the shorter chord is closer to the tangent
    let sum = before / before.norm_squared() + after / after.norm_squared();
    sum.try_normalize(0.0).unwrap_or_else(|| before.normalize())
}

/// The tangent at the other end of a chord: the mirror image in it.
fn reflected(tangent: Vector, chord: Vector) -> Vector {
    let along = chord.normalize();
    (along * (2.0 * tangent.dot(&along)) - tangent).normalize()
}

/// Two tangent arcs from a point and unit direction to another, with equal tangent lengths; none where one would turn by more than
/// half a turn.
pub fn biarc(a: Point, ta: Vector, b: Point, tb: Vector) -> Option<[Piece; 2]> {
    // Corners of the control polygon lie d ahead of a and d behind b, and 2 d apart:
    //   d = v² / (v·t + √((v·t)² + 2 (1 − ta·tb) v²)),   v = b − a,   t = ta + tb
    let v = b - a;
    let along = v.dot(&(ta + tb));
    let bend = 2.0 * (1.0 - ta.dot(&tb)).max(0.0);
    let d = v.norm_squared() / (along + (along * along + bend * v.norm_squared()).sqrt());
    if !(d.is_finite() && d > 0.0) {
        return None;
    }
    let joint = nalgebra::center(&(a + ta * d), &(b - tb * d));
    let first = tangent_piece(a, ta, joint)?;
    let second = tangent_piece(b, -tb, joint)?.reversed();
    Some([first, second])
}

/// Arc or segment that leaves a point in a direction and ends at another; at most half a turn.
fn tangent_piece(from: Point, direction: Vector, to: Point) -> Option<Piece> {
    let chord = to - from;
    let (ahead, aside) = (chord.dot(&direction), direction.perp(&chord));
    if ahead <= 0.0 {
        return None;
    }
    // κ = 2 (t × w) / |w|²,   Δ = 2 atan((t × w) / (t · w))
    if aside.abs() < 1e-10 * ahead {
        return Some(Segment::new(from, to).into());
    }
    let radius = 0.5 * chord.norm_squared() / aside;
    let left = Vector::new(-direction.y, direction.x);
    let centre = from + left * radius;
    let spoke = from - centre;
    Some(Piece::Arc(Arc {
        centre,
        radius: radius.abs(),
        start_angle: spoke.y.atan2(spoke.x),
        sweep: 2.0 * aside.atan2(ahead),
    }))
}

/// Whether every point lies within the tolerance of the pair, each abreast of it.
fn follows(pair: &[Piece; 2], points: impl Iterator<Item = Point>, tolerance: f64) -> bool {
    let mut progress = 0.0;
    for p in points {
        let abreast = pair.iter().enumerate().find_map(|(index, piece)| {
            let s = piece.foot(p)?;
            let near = (piece.point(s) - p).norm() <= tolerance;
            near.then_some(f64::from(u8::from(index > 0)) + s)
        });
        // At the joint itself neither piece has a foot inside.
        let at_joint = ((pair[0].end() - p).norm() <= tolerance).then_some(1.0);
        match abreast.or(at_joint) {
            Some(place) if place >= progress => progress = place,
            _ => return false,
        }
    }
    true
}

/// Appends a piece, or lengthens the last one if both lie on the same line or circle.
fn push_or_extend(pieces: &mut Vec<Piece>, piece: Piece) {
    let joined = match (pieces.last(), piece) {
        (Some(Piece::Segment(a)), Piece::Segment(b)) => {
            Some(Piece::Segment(Segment::new(a.start, b.end)))
        }
        (Some(Piece::Arc(a)), Piece::Arc(b)) => {
            let same = (a.centre - b.centre).norm() < 1e-10 * a.radius
                && (a.radius - b.radius).abs() < 1e-10 * a.radius
                && (a.sweep * b.sweep > 0.0);
            let sweep = a.sweep + b.sweep;
            let allowed = same && sweep.abs() < std::f64::consts::TAU;
            allowed.then_some(Piece::Arc(Arc { sweep, ..*a }))
        }
        _ => None,
    };
    match (pieces.last_mut(), joined) {
        (Some(last), Some(joined)) => *last = joined,
        _ => pieces.push(piece),
    }
}

fn turning(from: Vector, to: Vector) -> f64 {
    from.perp(&to).atan2(from.dot(&to))
}
