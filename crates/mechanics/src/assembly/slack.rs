//! A chain with length to spare: the last span of the route hangs in a bow.

use chaindrive_geometry::{Closing, Point, Vector, Wheel};

use crate::AssemblyError;

/// Roller positions with all slack in the span that runs to the first stop.
///
/// The bow is a regular polygon of unstretched links; settling turns it into the
/// catenary.
pub(super) fn sagging(
    wheels: &[Wheel],
    closing: &Closing,
    pitch: f64,
    links: u32,
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
                "the last span of the route is {:.1} mm long but only {count} links are left for it",
                distance * 1e3
            ),
        });
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
