//! Circular seat with straight tangent flanks.

use super::half::{self, Flank};
use super::{Drawing, Seat, Tip, Wheel};
use crate::{GeometryError, Point, Vector};

/// Draws the gap.
///
/// The seat spans β = 60° − 45°/z either side of its lowest point, as in the maximum gap of
/// ISO 606, so the flanks open by 90° − β against the gap axis: enough for a link to
/// swing out without convex flanks.
pub(super) fn draw(
    wheel: &Wheel,
    seat_radius: f64,
    tip: Tip,
    seat: Seat,
) -> Result<Drawing, GeometryError> {
    let roller_radius = 0.5 * wheel.roller_diameter;
    GeometryError::finite("seat radius [m]", seat_radius)?;
    if seat_radius < roller_radius {
        return Err(wheel.refuse(
            "the seat radius",
            seat_radius,
            format!("at least the roller radius, {roller_radius} m"),
        ));
    }
    let height = wheel.seat_height(seat, seat_radius);
    let root_radius = height - seat_radius;
    if root_radius <= 0.0 {
        return Err(wheel.refuse("the root radius", root_radius, "positive".into()));
    }
    let beta = (60.0 - 45.0 / wheel.z).to_radians();
    let (sine, cosine) = beta.sin_cos();
    let start = Point::new(0.0, height) + Vector::new(-sine, -cosine) * seat_radius;
    let flank = Flank::Line(start, Vector::new(-cosine, sine));

    let (least, most) = wheel.iso_tip_diameters();
    let asked = tip.radius(least, 0.5 * (least + most), most)?;
    let tooth = half::cut(wheel, flank, asked)?;
    Ok(Drawing {
        pieces: half::mirrored(half::seat_arc(height, seat_radius, beta), tooth.pieces),
        root_radius,
        tip_radius: tooth.tip_radius,
        seat_clearance: seat_radius - roller_radius,
        pointed: tooth.pointed,
    })
}
