//! Complete drives that several tests close.
#![allow(dead_code, reason = "no test needs all of them")]

use chaindrive_geometry::{Point, Route, Side, Vector, Wheel};

pub(crate) const MARINE_PITCH: f64 = 0.0889;
pub(crate) const MARINE_CAMSHAFT: f64 = 1.220_977_776_126_472;

pub(crate) fn marine(camshaft: f64) -> Vec<Wheel> {
    let wheel = |x, y, z| Wheel::toothed(Point::new(x, y), z, MARINE_PITCH, Side::Left);
    vec![
        wheel(0.0, 0.0, 48),
        wheel(camshaft, 2.15, 48),
        wheel(0.372, 3.127, 30),
        wheel(-0.6, 1.75, 24),
    ]
}

pub(crate) fn pair(z1: u32, z2: u32, x2: f64, pitch: f64) -> Vec<Wheel> {
    vec![
        Wheel::toothed(Point::origin(), z1, pitch, Side::Left),
        Wheel::toothed(Point::new(x2, 0.0), z2, pitch, Side::Left),
    ]
}

pub(crate) const TIMING_PITCH: f64 = 0.008;
/// Half the height of a link plate, which rides on the guide faces [m].
pub(crate) const HALF_PLATE: f64 = 0.5 * 0.007_11;

/// Radius of roller centres over a guide face on which straight plate edges slide.
pub(crate) fn ridden(face: f64) -> f64 {
    (face + HALF_PLATE).hypot(0.5 * TIMING_PITCH)
}

/// The timing drive, its fixed guide pressed in by 3 mm and its tensioner arm by `push`.
pub(crate) fn timing(push: f64) -> Vec<Wheel> {
    let wheel = |x, y, z| Wheel::toothed(Point::new(x, y), z, TIMING_PITCH, Side::Left);
    let sprockets = [
        wheel(0.0, 0.0, 18),
        wheel(0.056, 0.297, 36),
        wheel(-0.056, 0.297, 36),
    ];
    let spans = Route::taut(&sprockets)
        .expect("the sprockets stand apart")
        .spans;
    let guide = |span: usize, face: f64, push: f64| {
        let span = &spans[span];
        let inward = Vector::new(-span.direction.sin(), span.direction.cos());
        let radius = ridden(face);
        let middle = nalgebra::center(&span.leaves, &span.arrives);
        Wheel::smooth(middle - (radius - push) * inward, radius, Side::Right)
    };
    let [crank, exhaust, inlet] = sprockets;
    vec![
        crank,
        guide(0, 2.2, 0.003),
        exhaust,
        inlet,
        guide(2, 0.45, push),
    ]
}

#[track_caller]
pub(crate) fn assert_close(got: f64, expected: f64, tolerance: f64) {
    let error = (got - expected).abs();
    assert!(
        error <= tolerance,
        "got {got}, expected {expected}, off by {error:e}, allowed {tolerance:e}"
    );
}
