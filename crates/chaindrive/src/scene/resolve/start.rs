//! Chains that do not begin along a route: lines, arcs, rings and given points.

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{Point, Vector};
use chaindrive_mechanics::{Chain, Layout};

use super::{Findings, point};
use crate::scene::schema::Start;

pub(super) fn layout(
    start: &Start,
    chain: &Chain,
    gravity: Vector,
    findings: &mut Findings<'_>,
) -> Option<Layout> {
    let ring = matches!(start, Start::Ring { .. });
    let strand = matches!(start, Start::Line { .. } | Start::Hang { .. });
    if ring && !chain.is_closed() {
        let hint = "leave out `chain.ends`";
        findings.refuse_with("chain.start", "a ring has no ends", hint);
        return None;
    }
    if strand && chain.is_closed() {
        let hint = "give `chain.ends`, such as [\"fixed\", \"fixed\"]";
        findings.refuse_with("chain.start", "only an open strand can lie so", hint);
        return None;
    }
    let (positions, velocities) = match start {
        Start::Line { from, to } => at_rest(line(point(*from), point(*to), chain)),
        Start::Hang { from, to } => at_rest(hang(point(*from), point(*to), chain, gravity)),
        Start::Ring { centre, speed } => spin(point(*centre), speed.0, chain, findings)?,
        Start::Points {
            positions,
            velocities,
        } => {
            let rollers = chain.rollers();
            let mut count = |key: &str, found: usize| {
                if found != rollers {
                    let message =
                        format!("{found} values, needed are {rollers}, one for every roller");
                    findings.refuse(&format!("chain.start.{key}"), message);
                }
            };
            count("positions", positions.len());
            if let Some(velocities) = velocities {
                count("velocities", velocities.len());
            }
            let velocity = |given: &Vec<_>| {
                given
                    .iter()
                    .map(|[x, y]: &[chaindrive_quantities::Speed; 2]| Vector::new(x.0, y.0))
                    .collect()
            };
            let velocities = velocities
                .as_ref()
                .map_or_else(|| vec![Vector::zeros(); rollers], velocity);
            (positions.iter().copied().map(point).collect(), velocities)
        }
    };
    Some(Layout::Points {
        positions,
        velocities,
    })
}

fn at_rest(positions: Vec<Point>) -> (Vec<Point>, Vec<Vector>) {
    let velocities = vec![Vector::zeros(); positions.len()];
    (positions, velocities)
}

/// Rollers on a straight line, as far apart as their links are long in proportion.
fn line(from: Point, to: Point, chain: &Chain) -> Vec<Point> {
    let total: f64 = chain.lengths.iter().sum();
    let mut run = 0.0;
    let mut points = vec![from];
    for length in &chain.lengths {
        run += length;
        points.push(from + (to - from) * (run / total));
    }
    points
}

/// Rollers on a circular arc with chords of one link.
///
/// N equal chords of length ℓ between two points at the distance D span N angles 2α:
///
/// ```text
/// D = ℓ sin(N α) / sin α
/// ```
///
/// The right length and about the shape of a hanging chain; settling does the rest. A chain that
/// is too short is drawn along the line.
fn hang(from: Point, to: Point, chain: &Chain, gravity: Vector) -> Vec<Point> {
    let links = chain.links() as f64;
    let length = chain.lengths.iter().sum::<f64>() / links;
    let chord = to - from;
    let distance = chord.norm();
    if links * length <= distance || chain.links() < 2 {
        return line(from, to, chain);
    }
    let along = chord
        .try_normalize(f64::MIN_POSITIVE)
        .unwrap_or_else(Vector::x);
    // The side to which gravity pulls; downward without gravity.
    let left = Vector::new(-along.y, along.x);
    let pull = if gravity.norm() > 0.0 {
        gravity
    } else {
        -Vector::y()
    };
    let side = if pull.dot(&left) > 0.0 { 1.0 } else { -1.0 };
    // D falls from N ℓ at α = 0 to nothing at α = π/N.
    let (mut low, mut high) = (0.0, PI / links);
    for _ in 0..200 {
        let alpha = 0.5 * (low + high);
        if length * (links * alpha).sin() / alpha.sin() > distance {
            low = alpha;
        } else {
            high = alpha;
        }
    }
    let alpha = 0.5 * (low + high);
    let mut points = vec![from];
    let mut at = from;
    for i in 0..chain.links() {
        // The links turn from one side of the chord to the other by 2α each.
        let angle = side * alpha * (links - 1.0 - 2.0 * i as f64);
        let (sine, cosine) = angle.sin_cos();
        at += (along * cosine + left * sine) * length;
        points.push(at);
    }
    // Bisection leaves a rounding error at the end.
    *points.last_mut().unwrap_or(&mut at) = to;
    points
}

/// A ring that turns about its centre, stretched until its tension holds the rollers.
///
/// ```text
/// ℓ = k p / (k − m ω²/(4 sin²(π/N))),   R = ℓ / (2 sin(π/N))
/// ```
fn spin(
    centre: Point,
    speed: f64,
    chain: &Chain,
    findings: &mut Findings<'_>,
) -> Option<(Vec<Point>, Vec<Vector>)> {
    let links = chain.links() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / links;
    let (rest, stiffness, mass) = (
        mean(&chain.lengths),
        mean(&chain.stiffness),
        mean(&chain.masses),
    );
    let half = (PI / links).sin();
    let left = stiffness - mass * speed * speed / (4.0 * half * half);
    if left <= 0.0 {
        let fastest = 2.0 * half * (stiffness / mass).sqrt();
        let message = format!("at {speed} rad/s the ring flies apart");
        let hint = format!("its links hold up to {fastest:.4} rad/s");
        findings.refuse_with("chain.start.speed", message, hint);
        return None;
    }
    let radius = rest * stiffness / left / (2.0 * half);
    let place = |i: usize| {
        let (sine, cosine) = (TAU * i as f64 / links).sin_cos();
        let arm = Vector::new(cosine, sine) * radius;
        (centre + arm, Vector::new(-arm.y, arm.x) * speed)
    };
    Some((0..chain.links()).map(place).unzip())
}
