//! Curves that the tests and benchmarks share.
#![allow(dead_code, reason = "each test uses some of them")]
#![allow(
    clippy::unwrap_used,
    reason = "test support, but outside a test function"
)]

use chaindrive_geometry::{
    Arc, ArcSpline, Piece, Point, Seat, Tip, ToothForm, ToothGap, Vector, bar, rail,
};

/// Reproducible numbers in [0, 1), by the multiplicative generator of Lehmer and Steele.
pub(crate) struct Dice(u128);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(u128::from(seed) * 2 + 1)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(0x0fc9_4e3b_f4e9_ab32_8664_58cd_56f5_e605);
        (self.0 >> 75) as u64 as f64 / (1_u64 << 53) as f64
    }
}

/// Wheel for a 16B chain, middle ISO gap.
pub(crate) fn iso_wheel(teeth: u32) -> ArcSpline {
    let form = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Mid,
        seat: Seat::Bottom,
    };
    gap(teeth, &form).outline().unwrap()
}

/// One minimum ISO gap with its seat centred on the pitch circle.
pub(crate) fn iso_gap_centred_on_pitch() -> ArcSpline {
    let form = ToothForm::Iso606 {
        gap: 0.0,
        tip: Tip::Mid,
        seat: Seat::Pitch,
    };
    ArcSpline::open(gap(19, &form).pieces()).unwrap()
}

/// Wheel of the American form for the same chain.
pub(crate) fn asa_wheel(teeth: u32) -> ArcSpline {
    let form = ToothForm::AsaTypeII { tip: Tip::Mid };
    gap(teeth, &form).outline().unwrap()
}

fn gap(teeth: u32, form: &ToothForm) -> ToothGap {
    ToothGap::new(teeth, 25.4e-3, 15.88e-3, form).unwrap()
}

/// Rail with eight corners, some sharp, the others with random roundings.
pub(crate) fn rounded_rail(seed: u64) -> ArcSpline {
    let mut dice = Dice::new(seed);
    let points: Vec<_> = (0..10)
        .map(|k| Point::new(0.02 * f64::from(k) - 0.1, 0.02 * dice.next()))
        .collect();
    let radii: Vec<_> = (0..8)
        .map(|k| if k % 3 == 0 { 0.0 } else { 5e-3 * dice.next() })
        .collect();
    rail(&points, &radii).unwrap()
}

/// Straight guide bar with lead-in arcs.
pub(crate) fn bar_face() -> ArcSpline {
    bar(Point::new(0.1, 0.02), Point::new(-0.1, 0.0), 0.05, 0.5).unwrap()
}

/// Tangent arcs that wind to the left and to the right in turn.
pub(crate) fn long_spline(count: usize) -> ArcSpline {
    let mut dice = Dice::new(7);
    let mut pieces: Vec<Piece> = Vec::new();
    let (mut at, mut along) = (Point::origin(), Vector::x());
    let (mut heading, mut sign) = (0.0_f64, 1.0);
    for _ in 0..count {
        sign = -sign;
        let radius = 3e-3 + 6e-3 * dice.next();
        let sweep = sign * (0.3 + 0.4 * dice.next()) - 0.5 * heading;
        let sweep = if sweep * sign > 0.05 {
            sweep
        } else {
            0.05 * sign
        };
        let left = Vector::new(-along.y, along.x) * sign;
        let spoke = -left;
        let arc = Arc {
            centre: at + left * radius,
            radius,
            start_angle: spoke.y.atan2(spoke.x),
            sweep,
        };
        pieces.push(arc.into());
        (at, along) = (arc.point(1.0), arc.tangent(1.0));
        heading = along.y.atan2(along.x);
    }
    ArcSpline::open(&pieces).unwrap()
}
