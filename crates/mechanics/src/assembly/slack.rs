//! A chain with length to spare: one span of the route hangs in a bow.

use chaindrive_geometry::{Closing, Point, Route, Span, Vector, Wheel};

use crate::drive::{GuideSupport, Layout, Parts, Stop};
use crate::{Assembled, AssemblyError, Chain};

/// Sag that a chain was fitted with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sag {
    /// The slack span, by the stop that it leaves.
    pub span: usize,
    /// Sag of its middle \[m\] that was asked for: all slack hangs there, and the other spans are straight.
    pub asked: f64,
    /// Sag of its middle \[m\] where nothing pulls and every span has the same tension: they share the slack.
    pub shared: f64,
}

impl Assembled {
    /// Sag that a chain was fitted with, where one was asked for.
    ///
    /// ```text
    /// f_shared = f √(w² L³/Σ wᵢ² Lᵢ³)      w, L: weight a length across the span, and its length
    /// ```
    ///
    /// From e = 8 f²/3 L and f = w L²/8 T of every span, with one T. What the links stretch is left out.
    pub fn sag(&self, chain: usize) -> Option<Sag> {
        let placed = &self.parts.chains[chain];
        let wheels = &self.fittings[chain].as_ref()?.wheels;
        let Layout::Route { stops, fit, .. } = &placed.layout else {
            return None;
        };
        let asked = fit.sag?;
        let found = |span| Some(span);
        let span = fit
            .slack
            .map_or_else(|| span(&self.parts, chain, stops, wheels).ok(), found)?;
        let spans = Route::taut(wheels).ok()?.spans;
        // w² L³: gravity across the span, squared
        let gravity = self.parts.gravity;
        let share = |it: &Span| {
            let along = (it.arrives - it.leaves) / it.length;
            (gravity.norm_squared() - gravity.dot(&along).powi(2)) * it.length.powi(3)
        };
        let all: f64 = spans.iter().map(share).sum();
        Some(Sag {
            span,
            asked,
            shared: asked * (share(&spans[span]) / all).sqrt(),
        })
    }
}

/// The span that takes the slack where nobody says so, by the stop that it leaves: the last one, unless a guide lies along it; then the longest along
/// which none lies.
pub(super) fn span(
    parts: &Parts,
    chain: usize,
    stops: &[Stop],
    wheels: &[Wheel],
) -> Result<usize, AssemblyError> {
    let spans = Route::taut(wheels)?.spans;
    let last = spans.len() - 1;
    let placed = &parts.chains[chain];
    let on_route = |rail: &usize| stops.contains(&Stop::Guide(*rail));
    let carried = |span: &Span| {
        let mut rails = placed.guides.iter().filter(|rail| !on_route(rail));
        rails.any(|rail| {
            let guide = &parts.guides[*rail];
            let shift = match guide.support {
                GuideSupport::Tensioner(_) => parts.reference(&guide.support) - Point::origin(),
                _ => Vector::zeros(),
            };
            let pieces = guide.face.pieces().iter();
            let mut places = pieces.flat_map(|piece| [0.0, 0.5, 1.0].map(|at| piece.point(at)));
            places.any(|place| distance(span, place + shift) < placed.chain.pitch)
        })
    };
    if !carried(&spans[last]) {
        return Ok(last);
    }
    let free = (0..last).filter(|index| !carried(&spans[*index]));
    let longest = free.max_by(|a, b| spans[*a].length.total_cmp(&spans[*b].length));
    Ok(longest.unwrap_or(last))
}

/// Distance of a point from a span \[m\].
fn distance(span: &Span, place: Point) -> f64 {
    let chord = span.arrives - span.leaves;
    let share = (place - span.leaves).dot(&chord) / chord.norm_squared();
    (span.leaves + chord * share.clamp(0.0, 1.0) - place).norm()
}

/// Strain of all free spans \[–\] with which one of them sags by `sag` \[m\] under its own weight, which stretches them all.
///
/// ```text
/// ε = T/(k p) − e/ΣL,   T = w L²/8f,   e = L (θ/sin θ − 1),   tan(θ/2) = 2 f/L      f: sag, L: chord, w: weight a length across it
/// ```
///
/// The bow is an arc of a circle here. A catenary of the same length sags less, by a share of some (f/L)².
pub(super) fn strain(
    wheels: &[Wheel],
    span: usize,
    sag: f64,
    (chain, gravity): (&Chain, Vector),
) -> Result<f64, AssemblyError> {
    let spans = Route::taut(wheels)?.spans;
    let chord = spans[span].length;
    let theta = 2.0 * (2.0 * sag / chord).atan();
    let excess = chord * (theta / theta.sin() - 1.0);
    let links = chain.links() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let along = (spans[span].arrives - spans[span].leaves) / chord;
    let across = (gravity - along * gravity.dot(&along)).norm();
    let weight = mean(&chain.masses) / chain.pitch * across;
    let pull = weight * chord * chord / (8.0 * sag);
    // Springs in series: the harmonic mean.
    let stiffness = links / chain.stiffness.iter().map(|k| 1.0 / k).sum::<f64>();
    let free = spans.iter().map(|it| it.length).sum::<f64>();
    Ok(pull / (stiffness * chain.pitch) - excess / free)
}

/// Roller positions with all slack in one span, and the seats of the chain. The phase is that of the sprocket after the slack span.
///
/// The bow is a regular polygon of unstretched links; settling turns it into the
/// catenary.
pub(super) fn sagging(
    wheels: &[Wheel],
    span: usize,
    (pitch, links): (f64, u32),
    phase: f64,
    down: Vector,
) -> Result<(Vec<Point>, Closing), AssemblyError> {
    // Laid from the stop after the slack span on, so that this is the last one.
    let first = (span + 1) % wheels.len();
    let mut ordered = wheels.to_vec();
    ordered.rotate_left(first);
    let mut closing = Closing::march(&ordered, pitch, phase)?;
    let mut positions = bow_last(&ordered, &mut closing, (pitch, links), down)?;
    let before = (wheels.len() - first) % wheels.len();
    let passed = closing.seats.iter().zip(&closing.spans).take(before);
    let passed: u32 = passed.map(|(seat, span)| seat.pitches + span).sum();
    positions.rotate_left(passed as usize);
    closing.seats.rotate_right(first);
    closing.spans.rotate_right(first);
    Ok((positions, closing))
}

/// Roller positions with all slack in the last span.
fn bow_last(
    wheels: &[Wheel],
    closing: &mut Closing,
    (pitch, links): (f64, u32),
    down: Vector,
) -> Result<Vec<Point>, AssemblyError> {
    let last_links = closing.spans.last().copied().unwrap_or(0);
    let spare = i64::from(links) - i64::from(closing.links);
    let count = u32::try_from(i64::from(last_links) + spare).unwrap_or(0);
    let places = closing.positions(wheels, pitch)?;
    let kept = places.len() - last_links.saturating_sub(1) as usize;
    let mut positions: Vec<Point> = places[..kept].iter().map(|place| place.position).collect();
    let (from, to) = (positions[kept - 1], positions[0]);
    let distance = (to - from).norm();
    if f64::from(count) * pitch < distance || count < 2 {
        return Err(AssemblyError::Layout {
            problem: format!(
                "the slack span of the route is {:.1} mm long but only {count} links are left for it",
                distance * 1e3
            ),
        });
    }
    if let Some(last) = closing.spans.last_mut() {
        *last = count;
    }
    let turn = turn_per_link(count, distance / pitch);
    // The bow hangs down, or outward (to the right of a counter-clockwise route) without gravity.
    let chord = (to - from) / distance;
    let right = Vector::new(chord.y, -chord.x);
    let side = if right.dot(&down) < 0.0 { 1.0 } else { -1.0 };
    // Bowing to the right means that the path begins turned to the right and bends to the left.
    let mut direction = chord.y.atan2(chord.x) + side * 0.5 * turn * f64::from(count - 1);
    let mut at = from;
    for _ in 1..count {
        at += Vector::new(direction.cos(), direction.sin()) * pitch;
        positions.push(at);
        direction -= side * turn;
    }
    Ok(positions)
}

/// Turn β between neighbouring links of a bow of `count` links over a chord of `chord` pitches.
fn turn_per_link(count: u32, chord: f64) -> f64 {
    let n = f64::from(count);
    let (mut low, mut high) = (0.0_f64, std::f64::consts::TAU / n);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        // D/p = sin(n β/2) / sin(β/2)
        let reached = (0.5 * n * middle).sin() / (0.5 * middle).sin();
        if reached > chord {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
