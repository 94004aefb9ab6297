//! Every tooth form of every chain is smooth, closed and as deep as it should be.

use chaindrive_geometry::{
    Arc, ArcSpline, GeometryError, Piece, Point, Seat, Segment, Tip, ToothForm, ToothGap, Vector,
};

/// Pitch and roller diameter \[m\] of ISO 606 chains and two others (published: catalogues).
const CHAINS: [(&str, f64, f64); 14] = [
    ("04C", 6.35e-3, 3.30e-3),
    ("05B", 8.0e-3, 5.0e-3),
    ("06B", 9.525e-3, 6.35e-3),
    ("bicycle", 12.7e-3, 7.75e-3),
    ("08A", 12.7e-3, 7.92e-3),
    ("08B", 12.7e-3, 8.51e-3),
    ("10B", 15.875e-3, 10.16e-3),
    ("12B", 19.05e-3, 12.07e-3),
    ("16A", 25.4e-3, 15.88e-3),
    ("24B", 38.1e-3, 25.4e-3),
    ("28B", 44.45e-3, 27.94e-3),
    ("56B", 88.9e-3, 53.98e-3),
    ("64B", 101.6e-3, 63.5e-3),
    ("72B", 114.3e-3, 72.39e-3),
];

fn iso(gap: f64, tip: Tip, seat: Seat) -> ToothForm {
    ToothForm::Iso606 { gap, tip, seat }
}

fn forms(roller_diameter: f64) -> Vec<ToothForm> {
    let mut forms = Vec::new();
    for tip in [Tip::Minimum, Tip::Mid, Tip::Maximum] {
        for seat in [Seat::Pitch, Seat::Bottom] {
            for gap in [0.0, 0.5, 1.0] {
                forms.push(iso(gap, tip, seat));
            }
            let seat_radius = 0.51 * roller_diameter;
            forms.push(ToothForm::Circular {
                seat_radius,
                tip,
                seat,
            });
        }
        forms.push(ToothForm::AsaTypeII { tip });
    }
    forms
}

fn turning(before: &Piece, after: &Piece) -> f64 {
    let (a, b) = (before.end_tangent(), after.start_tangent());
    a.perp(&b).atan2(a.dot(&b))
}

/// Theory: by construction every joint but the one at the tip circle is tangent, neighbours meet,
/// the wheel closes, the polar angle never turns back and the seat holds the roller.
#[test]
fn every_form_of_every_chain_is_sound() {
    let (mut breaks, mut gaps, mut count) = (0.0_f64, 0.0_f64, 0);
    for (name, pitch, d1) in CHAINS {
        for teeth in 6..=150 {
            for form in forms(d1) {
                let gap = ToothGap::new(teeth, pitch, d1, &form)
                    .unwrap_or_else(|error| panic!("{name}, {form:?}: {error}"));
                let pieces = gap.pieces();
                for pair in pieces.windows(2) {
                    gaps = gaps.max((pair[0].end() - pair[1].start()).norm() / pitch);
                    let at_tip = (pair[0].end().coords.norm() / gap.tip_radius - 1.0).abs() < 1e-9;
                    if !at_tip {
                        breaks = breaks.max(turning(&pair[0], &pair[1]).abs());
                    }
                }
                let step = std::f64::consts::TAU / f64::from(teeth);
                let next = pieces[0].rotated(step).start();
                gaps = gaps.max((next - pieces[pieces.len() - 1].end()).norm() / pitch);

                let mut last = f64::NEG_INFINITY;
                for piece in pieces {
                    for k in 0..=12 {
                        let p = piece.point(f64::from(k) / 12.0);
                        let angle = (-p.x).atan2(p.y);
                        assert!(angle > last - 1e-9, "{name} {teeth} {form:?} turns back");
                        last = angle;
                    }
                }
                assert!(gap.seat_clearance >= 0.0);
                assert!(gap.tip_radius > gap.pitch_radius, "{name} {teeth} {form:?}");
                count += 1;
            }
        }
    }
    println!("{count} gaps: tangent break {breaks:.1e} rad, gap {gaps:.1e} pitches");
    assert!(breaks < 1e-9 && gaps < 1e-12);
}

/// Limits of the accepted range, where the standards no longer vouch for the forms.
#[test]
fn forms_hold_over_the_whole_range_of_teeth() {
    for (name, pitch, d1) in CHAINS {
        for teeth in [5, 200, 300, 600] {
            for form in forms(d1) {
                let gap = ToothGap::new(teeth, pitch, d1, &form)
                    .unwrap_or_else(|error| panic!("{name} {teeth} {form:?}: {error}"));
                let corners = gap.outline().unwrap().corners().len();
                let expected = teeth as usize * if gap.pointed { 1 } else { 2 };
                assert_eq!(corners, expected, "{name} {teeth} {form:?}");
            }
        }
    }
    for teeth in [4, 601, 1000] {
        let refused = ToothGap::new(
            teeth,
            25.4e-3,
            15.88e-3,
            &ToothForm::AsaTypeII { tip: Tip::Mid },
        );
        assert_eq!(
            refused.unwrap_err().to_string(),
            format!("a sprocket of {teeth} teeth is outside the range of its tooth form, 5 to 600")
        );
    }
}

/// ISO 606: root diameter d − d₁ (published), met exactly with the seat on the bottom; with the
/// seat on the pitch circle a roller sinks by the clearance r_i − d₁/2 = 0.005 d₁ (theory).
#[test]
fn a_roller_on_the_bottom_sits_on_the_pitch_circle() {
    for (_, pitch, d1) in CHAINS {
        for teeth in [9, 23, 57] {
            let bottom =
                ToothGap::new(teeth, pitch, d1, &iso(0.0, Tip::Mid, Seat::Bottom)).unwrap();
            let drawn = ToothGap::new(teeth, pitch, d1, &iso(0.0, Tip::Mid, Seat::Pitch)).unwrap();
            assert!((2.0 * bottom.root_radius - (2.0 * bottom.pitch_radius - d1)).abs() < 1e-15);
            assert!((drawn.seat_clearance - 0.005 * d1).abs() < 1e-15);
            let sunk = bottom.root_radius - drawn.root_radius;
            assert!((sunk - drawn.seat_clearance).abs() < 1e-15);
            for gap in [bottom, drawn] {
                let face = ArcSpline::open(gap.pieces()).unwrap();
                let lowest = face
                    .nearest(Point::new(0.0, gap.root_radius), 1e-6)
                    .unwrap();
                assert!(lowest.distance.abs() < 1e-15);
            }
        }
    }
}

/// 56B, 57 teeth, middle form: d = p / sin(π/z), α = 130° − 90°/z, r_i, r_e and the mean tip
/// diameter of ISO 606 (published formulas, evaluated by hand).
#[test]
fn dimensions_of_a_marine_wheel() {
    let (z, p, d1) = (57.0_f64, 88.9e-3, 53.98e-3);
    let gap = ToothGap::new(57, p, d1, &iso(0.5, Tip::Mid, Seat::Bottom)).unwrap();
    let [Piece::Arc(flank), Piece::Arc(seat)] = gap.pieces()[1..3] else {
        panic!("flank and seat are arcs");
    };
    let d = p / (180.0 / z).to_radians().sin();
    assert!((gap.pitch_radius - 0.5 * d).abs() < 1e-15);
    let r_i = 0.505 * 53.98 + 0.5 * 0.069 * 53.98_f64.cbrt();
    assert!((seat.radius - r_i * 1e-3).abs() < 1e-15);
    let r_e = 0.5 * (0.12 * 53.98 * 59.0 + 0.008 * 53.98 * (57.0 * 57.0 + 180.0));
    assert!((flank.radius - r_e * 1e-3).abs() < 1e-12);
    assert!((-seat.sweep.to_degrees() - (130.0 - 90.0 / z)).abs() < 1e-12);
    let d_a = d + 0.5 * p * (1.0 - 1.6 / z + 1.25) - d1;
    assert!((2.0 * gap.tip_radius - d_a).abs() < 1e-14);
    assert!(!gap.pointed);
}

/// ISO flanks are convex and seats concave; an ASA gap goes tip, topping, flat, working, seat.
/// (published: the construction of both standards)
#[test]
fn flanks_are_convex_and_seats_concave() {
    let gap = ToothGap::new(20, 25.4e-3, 15.88e-3, &iso(0.5, Tip::Mid, Seat::Bottom)).unwrap();
    let signs: Vec<_> = gap
        .pieces()
        .iter()
        .map(|p| p.curvature().signum())
        .collect();
    assert_eq!(signs, [1.0, 1.0, -1.0, 1.0, 1.0]);
    let asa = ToothGap::new(
        20,
        25.4e-3,
        15.88e-3,
        &ToothForm::AsaTypeII { tip: Tip::Mid },
    )
    .unwrap();
    let signs: Vec<_> = asa
        .pieces()
        .iter()
        .map(|p| p.curvature().signum())
        .collect();
    // Tip, topping, flat (+0), working, seat, and back.
    assert_eq!(signs, [1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0]);
}

/// The maximum gap with the largest tip diameter is always pointed; the middle form with the
/// middle tip diameter never is, from 6 to 150 teeth (previous: an independent construction of the
/// same forms, 2026). OD of a pointed ASA wheel is p cot(π/z) + 2 H (published).
#[test]
fn pointed_teeth_are_lowered_to_the_point() {
    for (_, p, d1) in CHAINS {
        for teeth in 6..=150 {
            let blunt = ToothGap::new(teeth, p, d1, &iso(0.5, Tip::Mid, Seat::Pitch)).unwrap();
            assert!(!blunt.pointed);
            let sharp = ToothGap::new(teeth, p, d1, &iso(1.0, Tip::Maximum, Seat::Pitch)).unwrap();
            assert!(sharp.pointed);
            assert_eq!(sharp.pieces().len(), 3);
        }
    }
    let huge = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Diameter(1.0),
        seat: Seat::Bottom,
    };
    assert!(ToothGap::new(20, 25.4e-3, 15.88e-3, &huge).unwrap().pointed);
    let small = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Diameter(0.1),
        seat: Seat::Bottom,
    };
    let refused = ToothGap::new(20, 25.4e-3, 15.88e-3, &small);
    assert!(matches!(refused, Err(GeometryError::ToothForm { .. })));

    // Worked example, P = 1 in, N = 28, D_r = 0.625 in: H = 0.3477 in (published).
    let inch = 25.4e-3;
    let asa = |tip| ToothGap::new(28, inch, 0.625 * inch, &ToothForm::AsaTypeII { tip }).unwrap();
    let cot = 1.0 / (std::f64::consts::PI / 28.0).tan();
    let point = asa(Tip::Maximum);
    assert!(point.pointed);
    assert!((2.0 * point.tip_radius / inch - (cot + 2.0 * 0.3477)).abs() < 2e-4);
    assert!((2.0 * asa(Tip::Mid).tip_radius / inch - (0.6 + cot)).abs() < 1e-12);
}

fn vee(teeth: u32, tip_radius: f64, root_radius: f64) -> Vec<Piece> {
    let (sine, cosine) = (std::f64::consts::PI / f64::from(teeth)).sin_cos();
    let tip = |side: f64| Point::new(side * tip_radius * sine, tip_radius * cosine);
    let root = Point::new(0.0, root_radius);
    vec![
        Segment::new(tip(1.0), root).into(),
        Segment::new(root, tip(-1.0)).into(),
    ]
}

/// A user's path is taken as drawn: a V gap of straight flanks, and an ISO gap given back as path.
#[test]
fn paths_are_taken_as_drawn() {
    let form = ToothForm::Path {
        pieces: vee(12, 60e-3, 40e-3),
    };
    let gap = ToothGap::new(12, 25.4e-3, 15.88e-3, &form).unwrap();
    assert_eq!(gap.outline().unwrap().corners().len(), 24);
    assert!(gap.pointed);
    assert!((gap.root_radius - 40e-3).abs() < 1e-15 && (gap.tip_radius - 60e-3).abs() < 1e-15);

    let iso = ToothGap::new(12, 25.4e-3, 15.88e-3, &iso(0.5, Tip::Mid, Seat::Bottom)).unwrap();
    let form = ToothForm::Path {
        pieces: iso.pieces().to_vec(),
    };
    let path = ToothGap::new(12, 25.4e-3, 15.88e-3, &form).unwrap();
    assert!((path.root_radius - iso.root_radius).abs() < 1e-15);
    assert!((path.tip_radius - iso.tip_radius).abs() < 1e-15);
    assert!((path.seat_clearance - iso.seat_clearance).abs() < 1e-15);
    assert_eq!(path.pointed, iso.pointed);
}

#[test]
fn paths_that_cannot_make_a_wheel_are_refused() {
    let refused = |pieces| {
        ToothGap::new(12, 25.4e-3, 15.88e-3, &ToothForm::Path { pieces })
            .unwrap_err()
            .to_string()
    };
    let mut reversed: Vec<_> = vee(12, 60e-3, 40e-3)
        .iter()
        .rev()
        .map(Piece::reversed)
        .collect();
    assert!(refused(reversed.clone()).contains("right tooth centre line"));
    reversed.clear();
    assert!(refused(reversed).contains("no pieces"));
    assert!(refused(vee(13, 60e-3, 40e-3)).contains("right tooth centre line"));
    // An undercut seat: the arc bulges out below the flanks.
    let v = vee(12, 60e-3, 40e-3);
    let (a, b) = (v[0].point(0.5), v[1].point(0.5));
    let bulb = Arc::with_bulge(a, b, -3.0).unwrap();
    let undercut = vec![
        Segment::new(v[0].start(), a).into(),
        bulb.into(),
        Segment::new(b, v[1].end()).into(),
    ];
    assert!(refused(undercut).contains("turns back"));
}

#[test]
fn numbers_out_of_range_are_refused() {
    let mid = iso(0.5, Tip::Mid, Seat::Bottom);
    for (pitch, d1) in [
        (f64::NAN, 1e-2),
        (25.4e-3, f64::INFINITY),
        (-1.0, 1e-2),
        (1e-2, 2e-2),
    ] {
        assert!(ToothGap::new(20, pitch, d1, &mid).is_err());
    }
    for gap in [-0.1, 1.1, f64::NAN] {
        assert!(ToothGap::new(20, 25.4e-3, 15.88e-3, &iso(gap, Tip::Mid, Seat::Pitch)).is_err());
    }
    let tight = ToothForm::Circular {
        seat_radius: 7e-3,
        tip: Tip::Mid,
        seat: Seat::Pitch,
    };
    assert!(ToothGap::new(20, 25.4e-3, 15.88e-3, &tight).is_err());
}

/// Theory: a new chain leaves the wheel without cutting into a tooth. The roller swings out about
/// its seated neighbour by one pitch angle; it starts on the bottom, so the clearance starts at 0.
#[test]
fn links_swing_out_freely() {
    for (name, pitch, d1) in [CHAINS[3], CHAINS[5], CHAINS[11]] {
        for teeth in [9, 12, 18, 25, 38, 57, 76, 120] {
            for form in [
                iso(0.0, Tip::Maximum, Seat::Bottom),
                iso(0.5, Tip::Mid, Seat::Bottom),
                iso(1.0, Tip::Maximum, Seat::Bottom),
                ToothForm::AsaTypeII { tip: Tip::Mid },
                ToothForm::Circular {
                    seat_radius: 0.505 * d1,
                    tip: Tip::Mid,
                    seat: Seat::Bottom,
                },
            ] {
                let gap = ToothGap::new(teeth, pitch, d1, &form).unwrap();
                let wheel = gap.outline().unwrap();
                let seated = |k| gap.pitch_radius * unit(gap.gap_axis(k));
                let (pivot, first) = (seated(1), seated(0));
                let least = (0..=200)
                    .map(|k| {
                        let step = std::f64::consts::TAU / f64::from(teeth);
                        let turn = nalgebra::Rotation2::new(step * f64::from(k) / 200.0);
                        let centre = Point::from(pivot + turn * (first - pivot));
                        wheel.nearest(centre, f64::INFINITY).unwrap().distance - 0.5 * d1
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!(least > -1e-12, "{name} {teeth} {form:?}: {least:e}");
            }
        }
    }
}

fn unit(angle: f64) -> Vector {
    Vector::new(angle.cos(), angle.sin())
}

/// γ where the flank leaves the seat: 20° and 30° less 135°/z by the angles of seat arcs of ISO 606, 35° − 120°/z of the American form.
#[test]
fn pressure_angles_are_those_of_the_standards() {
    for teeth in [9, 17, 45] {
        let z = f64::from(teeth);
        let angle = |form: &ToothForm| {
            let gap = ToothGap::new(teeth, 0.0127, 0.00851, form).unwrap();
            gap.pressure_angle().map(f64::to_degrees)
        };
        let iso = |gap| ToothForm::Iso606 {
            gap,
            tip: Tip::Mid,
            seat: Seat::Bottom,
        };
        for (form, expected) in [
            (iso(0.0), 20.0 - 135.0 / z),
            (iso(1.0), 30.0 - 135.0 / z),
            (ToothForm::AsaTypeII { tip: Tip::Mid }, 35.0 - 120.0 / z),
        ] {
            let found = angle(&form).unwrap();
            assert!((found - expected).abs() < 1e-9, "{form:?}: {found}°");
        }
    }
}
