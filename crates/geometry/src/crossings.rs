//! Intersections of two curves.

use crate::{Arc, ArcSpline, Piece, Point, Segment, Vector};

/// A place that two curves have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Where \[m\].
    pub point: Point,
    /// Arc lengths from the start of the one and of the other curve \[m\].
    pub along: [f64; 2],
}

/// Distance beyond the ends of a piece at which a crossing still counts, in fractions of the size of the curves: at a joint rounding must
/// not lose it between two pieces.
const ROUNDING: f64 = 1e-12;

/// Crossings closer than this fraction of the size of the curves are one, met on both sides of a joint.
const SAME: f64 = 1e-9;

impl ArcSpline {
    /// Every place where the curves meet, in order along this one.
    ///
    /// Places where they touch count too; pieces that lie on the same line or circle do not cross. The trees of both curves
    /// are passed at once, so that only pieces whose boxes overlap are asked.
    pub fn crossings(&self, other: &Self) -> Vec<Crossing> {
        let size = self.aabb().merged(&other.aabb()).diagonal();
        let mut found: Vec<Crossing> = Vec::new();
        self.tree.pairs(&other.tree, |first, second| {
            let pieces = [&self.pieces()[first], &other.pieces()[second]];
            for point in common_points(pieces[0], pieces[1]) {
                let on = |piece: &Piece| parameter(piece, point, ROUNDING * size);
                if let (Some(a), Some(b)) = (on(pieces[0]), on(pieces[1])) {
                    found.push(Crossing {
                        point,
                        along: [self.arc_length(first, a), other.arc_length(second, b)],
                    });
                }
            }
        });
        found.sort_by(|a, b| a.along[0].total_cmp(&b.along[0]));
        let same = |a: &Crossing, b: &Crossing| {
            (b.point - a.point).norm() < SAME * size && same_place(self, a, b, size)
        };
        found.dedup_by(|b, a| same(a, b));
        // Where a closed curve begins it also ends.
        if found.len() > 1 && same(&found[0], &found[found.len() - 1]) {
            found.pop();
        }
        found
    }
}

/// Whether two crossings are neighbours along the curve too: where it crosses itself they are not.
fn same_place(curve: &ArcSpline, a: &Crossing, b: &Crossing, size: f64) -> bool {
    let apart = (b.along[0] - a.along[0]).abs();
    let round = if curve.is_closed() {
        (curve.length() - apart).abs()
    } else {
        apart
    };
    apart.min(round) < SAME * size
}

/// Fraction of a piece at which a point of its line or circle lies, if it does, give or take `loose` \[m\].
fn parameter(piece: &Piece, point: Point, loose: f64) -> Option<f64> {
    let s = match piece {
        Piece::Segment(segment) => {
            let along = segment.end - segment.start;
            (point - segment.start).dot(&along) / along.norm_squared()
        }
        Piece::Arc(arc) => arc.parameter(point),
    };
    let loose = loose / piece.length();
    (s >= -loose && s <= 1.0 + loose).then(|| s.clamp(0.0, 1.0))
}

/// Common points of the lines or circles that two pieces lie on.
fn common_points(first: &Piece, second: &Piece) -> Vec<Point> {
    match (first, second) {
        (Piece::Segment(a), Piece::Segment(b)) => of_lines(a, b),
        (Piece::Segment(line), Piece::Arc(arc)) | (Piece::Arc(arc), Piece::Segment(line)) => {
            of_line_and_circle(line, arc)
        }
        (Piece::Arc(a), Piece::Arc(b)) => of_circles(a, b),
    }
}

fn of_lines(a: &Segment, b: &Segment) -> Vec<Point> {
    let (u, v) = (a.end - a.start, b.end - b.start);
    // a + u s = b + v t,   s = (b − a) × v / (u × v)
    let across = u.perp(&v);
    if across.abs() <= f64::EPSILON * u.norm() * v.norm() {
        return Vec::new();
    }
    vec![a.start + u * ((b.start - a.start).perp(&v) / across)]
}

fn of_line_and_circle(line: &Segment, arc: &Arc) -> Vec<Point> {
    let u = line.tangent();
    let from = arc.centre - line.start;
    // The foot of the centre, and half the chord on either side of it.
    let foot = line.start + u * from.dot(&u);
    either_side(foot, u, arc.radius * arc.radius - u.perp(&from).powi(2))
}

fn of_circles(a: &Arc, b: &Arc) -> Vec<Point> {
    let between = b.centre - a.centre;
    let distance = between.norm();
    if distance <= f64::EPSILON * (a.radius + b.radius) {
        return Vec::new();
    }
    // x = (D² + r₁² − r₂²)/(2 D) along the line of centres, ±√(r₁² − x²) beside it
    let along = between / distance;
    let x = 0.5 * (distance + (a.radius - b.radius) * (a.radius + b.radius) / distance);
    let across = Vector::new(-along.y, along.x);
    either_side(
        a.centre + along * x,
        across,
        (a.radius - x) * (a.radius + x),
    )
}

/// Points at a distance, given as its square, on either side of a middle; one where they coincide.
fn either_side(middle: Point, along: Vector, squared: f64) -> Vec<Point> {
    if squared < 0.0 {
        return Vec::new();
    }
    let half = along * squared.sqrt();
    if half == Vector::zeros() {
        vec![middle]
    } else {
        vec![middle - half, middle + half]
    }
}
