//! ASME B29.1 type II (formerly ANSI, ASA): four curves tangent to each other by construction.

use std::f64::consts::PI;

use super::half::{self, Flank};
use super::{Drawing, Tip, Wheel};
use crate::{Arc, GeometryError, Piece, Point, Segment, Vector};

/// One inch \[m\]: the form adds two small lengths that the standard gives in inches.
const INCH: f64 = 25.4e-3;

/// The letters of the standard's drawing, lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
struct Letters {
    /// Angle from the horizontal to the end of the seat.
    a: f64,
    /// Angle of the working curve.
    b: f64,
    /// Seat radius R.
    seat: f64,
    /// Centre of the working curve from the roller centre, right and up.
    m: f64,
    t: f64,
    /// Radius of the working curve.
    e: f64,
    /// Length of the flat.
    yz: f64,
    /// Centre of the topping curve from the roller centre, left and down.
    w: f64,
    v: f64,
    /// Radius of the topping curve.
    f: f64,
}

impl Letters {
    fn new(z: f64, half_angle: f64, d: f64) -> Self {
        // A = 35° + 60°/N,   B = 18° − 56°/N,   γ = 17° − 64°/N
        let a = (35.0 + 60.0 / z).to_radians();
        let b = (18.0 - 56.0 / z).to_radians();
        let gamma = (17.0 - 64.0 / z).to_radians();
        Self {
            a,
            b,
            // 2 R = 1.005 D_r + 0.003 in,   E = R + 0.8 D_r
            seat: 0.5 * (1.005 * d + 0.003 * INCH),
            e: 1.3025 * d + 0.0015 * INCH,
            // M = 0.8 D_r cos A,   T = 0.8 D_r sin A
            m: 0.8 * d * a.cos(),
            t: 0.8 * d * a.sin(),
            // yz = D_r (1.4 sin γ − 0.8 sin B)
            yz: d * (1.4 * gamma.sin() - 0.8 * b.sin()),
            // W = 1.4 D_r cos(π/N),   V = 1.4 D_r sin(π/N)
            w: 1.4 * d * half_angle.cos(),
            v: 1.4 * d * half_angle.sin(),
            // F = D_r (0.8 cos B + 1.4 cos γ − 1.3025) − 0.0015 in
            f: d * (0.8 * b.cos() + 1.4 * gamma.cos() - 1.3025) - 0.0015 * INCH,
        }
    }

    /// H: half the diameter of a pointed wheel less (p/2) cot(π/N); absent if there is no point.
    fn h(&self, pitch: f64, d: f64) -> Option<f64> {
        // H = √(F² − (1.4 D_r − P/2)²)
        let square = self.f * self.f - (1.4 * d - 0.5 * pitch).powi(2);
        (square > 0.0).then(|| square.sqrt())
    }
}

/// Draws the gap.
pub(super) fn draw(wheel: &Wheel, tip: Tip) -> Result<Drawing, GeometryError> {
    let (pitch, d) = (wheel.pitch, wheel.roller_diameter);
    let letters = Letters::new(wheel.z, wheel.half_angle, d);
    let Letters { a, b, e, yz, f, .. } = letters;
    if yz <= 0.0 {
        return Err(wheel.refuse("the flat yz", yz, "positive".into()));
    }
    let roller = Point::new(0.0, wheel.pitch_radius);

    // Left half, seat to tip. Each curve starts in the direction in which the last one ends.
    let working = Arc {
        centre: roller + Vector::new(letters.m, letters.t),
        radius: e,
        start_angle: a + PI,
        sweep: -b,
    };
    let y = working.point(1.0);
    let flat = Segment::new(y, y + working.tangent(1.0) * yz);
    let topping_centre = roller - Vector::new(letters.w, letters.v);

    // Turned: OD = P (0.6 + cot(π/N)).   Pointed: OD = P cot(π/N) + 2 H.
    let cot = 1.0 / wheel.half_angle.tan();
    let turned = pitch * (0.6 + cot);
    let point = letters
        .h(pitch, d)
        .map_or(turned, |h| pitch * cot + 2.0 * h);
    let asked = tip.radius(wheel.iso_tip_diameters().0, turned, point)?;
    let tooth = half::cut(wheel, Flank::Arc(topping_centre, f, a - b), asked)?;

    let mut left = vec![Piece::Arc(working), flat.into()];
    left.extend(tooth.pieces);
    let seat = half::seat_arc(roller.y, letters.seat, 0.5 * PI - a);
    Ok(Drawing {
        pieces: half::mirrored(seat, left),
        root_radius: roller.y - letters.seat,
        tip_radius: tooth.tip_radius,
        seat_clearance: letters.seat - 0.5 * d,
        pointed: tooth.pointed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P = 1 in, N = 28, D_r = 0.625 in, to the four decimals printed (published: worked example
    /// of the GEARS educational sprocket design sheet).
    #[test]
    fn worked_example() {
        let half_angle = PI / 28.0;
        let d = 0.625 * INCH;
        let it = Letters::new(28.0, half_angle, d);
        let h = it.h(INCH, d).unwrap();
        let s = 0.5 * INCH * half_angle.cos() + h * half_angle.sin();
        let chord = 2.0 * it.e * (0.5 * it.b).sin();
        for (name, length, published) in [
            ("PD", INCH / half_angle.sin(), 8.9314),
            ("Ds", 2.0 * it.seat, 0.6311),
            ("R", it.seat, 0.3156),
            ("ac", it.m.hypot(it.t), 0.5),
            ("M", it.m, 0.3986),
            ("T", it.t, 0.3019),
            ("E", it.e, 0.8156),
            ("xy", chord, 0.2270),
            ("yz", it.yz, 0.0844),
            ("ab", it.w.hypot(it.v), 0.8750),
            ("W", it.w, 0.8695),
            ("V", it.v, 0.0980),
            ("F", it.f, 0.5114),
            ("H", h, 0.3477),
            ("S", s, 0.5358),
        ] {
            let got = length / INCH;
            assert!(
                (got - published).abs() < 1e-4,
                "{name} = {got}, published {published}"
            );
        }
        assert!((it.a.to_degrees() - 37.1429).abs() < 1e-4);
        assert!((it.b.to_degrees() - 16.0).abs() < 1e-12);
    }
}
