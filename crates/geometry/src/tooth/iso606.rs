//! ISO 606 (also DIN 8196): circular seat, convex circular flanks.

use std::f64::consts::FRAC_PI_2;

use super::half::{self, Flank};
use super::{Drawing, Seat, Tip, Wheel};
use crate::{GeometryError, Point, Vector};

/// Draws the gap.
///
/// ```text
///               minimum gap       maximum gap
/// seat    r_i   0.505 d₁          0.505 d₁ + 0.069 d₁^⅓   (d₁ in millimetres)
/// flank   r_e   0.12 d₁ (z + 2)   0.008 d₁ (z² + 180)
/// angle   α     140° − 90°/z      120° − 90°/z
/// ```
///
/// Forms between interpolate the three numbers. The flank is convex: its centre lies on the far
/// side of the seat's end, r_i + r_e from the seat's centre.
pub(super) fn draw(
    wheel: &Wheel,
    gap: f64,
    tip: Tip,
    seat: Seat,
) -> Result<Drawing, GeometryError> {
    GeometryError::finite("ISO 606 gap form", gap)?;
    if !(0.0..=1.0).contains(&gap) {
        return Err(GeometryError::OutOfRange {
            what: "ISO 606 gap form",
            value: gap,
            allowed: "in [0, 1], from minimum to maximum gap",
        });
    }
    let (z, d1) = (wheel.z, wheel.roller_diameter);
    let between = |minimum: f64, maximum: f64| minimum + (maximum - minimum) * gap;

    // The cube root wants d₁ in millimetres and gives millimetres.
    let r_i = 0.505 * d1 + gap * 0.069 * (d1 * 1e3).cbrt() * 1e-3;
    let r_e = between(0.12 * d1 * (z + 2.0), 0.008 * d1 * (z * z + 180.0));
    let alpha = between(140.0 - 90.0 / z, 120.0 - 90.0 / z).to_radians();

    // Seat from −β to β about straight down; the flank continues it beyond the common normal.
    let beta = 0.5 * alpha;
    let height = wheel.seat_height(seat, r_i);
    let seat_end = Vector::new(-beta.sin(), -beta.cos());
    let flank_centre = Point::new(0.0, height) + seat_end * (r_i + r_e);
    let flank = Flank::Arc(flank_centre, r_e, FRAC_PI_2 - beta);

    let (least, most) = wheel.iso_tip_diameters();
    let asked = tip.radius(least, 0.5 * (least + most), most)?;
    let tooth = half::cut(wheel, flank, asked)?;
    Ok(Drawing {
        pieces: half::mirrored(half::seat_arc(height, r_i, beta), tooth.pieces),
        root_radius: height - r_i,
        tip_radius: tooth.tip_radius,
        seat_clearance: r_i - 0.5 * d1,
        pointed: tooth.pointed,
    })
}
