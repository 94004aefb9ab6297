//! Closings that were found before, to the bit.
//!
//! A search for a strain or a travel marches some hundred times around the wheels, and the next variant of a drive, with another load
//! or pretension, marches the same ways. A closing depends on nothing but its wheels, pitch and phase.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use super::Closing;
use crate::route::{Side, WheelKind};
use crate::{GeometryError, Wheel};

/// Closings that are kept; then it begins anew. One drive asks for some four hundred; each takes some three hundred bytes.
const MOST: usize = 16_384;

static KNOWN: LazyLock<Mutex<HashMap<Box<[u64]>, Closing>>> = LazyLock::new(Mutex::default);

/// The closing of these wheels, pitch and phase, to the bit: from before, or by `find`.
pub(super) fn known(
    wheels: &[Wheel],
    pitch: f64,
    phase: f64,
    find: impl FnOnce() -> Result<Closing, GeometryError>,
) -> Result<Closing, GeometryError> {
    let question = question(wheels, pitch, phase);
    // Whole closings only are put in: a thread that panics elsewhere leaves none half written.
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(closing) = known().get(&question) {
        return Ok(closing.clone());
    }
    let closing = find()?;
    let mut known = known();
    if known.len() >= MOST {
        known.clear();
    }
    known.insert(question, closing.clone());
    Ok(closing)
}

/// All bits that a closing depends on: 0 and −0 are two questions.
fn question(wheels: &[Wheel], pitch: f64, phase: f64) -> Box<[u64]> {
    let mut bits = Vec::with_capacity(2 + 4 * wheels.len());
    bits.extend([pitch.to_bits(), phase.to_bits()]);
    for Wheel {
        centre,
        radius,
        side,
        kind,
    } in wheels
    {
        let teeth = match kind {
            WheelKind::Toothed { teeth } => u64::from(*teeth) << 1,
            WheelKind::Smooth => 0,
        };
        let left = u64::from(matches!(side, Side::Left));
        bits.extend([centre.x, centre.y, *radius].map(f64::to_bits));
        bits.push(teeth | left);
    }
    bits.into_boxed_slice()
}
