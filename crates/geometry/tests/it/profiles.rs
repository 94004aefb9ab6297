//! Random profiles: closed, smooth but for the tips, symmetric where they should be; distances are distances.

use std::f64::consts::{FRAC_PI_2, TAU};

use chaindrive_geometry::{
    Arc, ArcSpline, Piece, Point, Seat, Tip, ToothForm, ToothGap, Vector, fit_arcs,
};
use proptest::prelude::*;

/// A gap, and whether it is its own mirror image.
#[derive(Clone, Debug)]
struct Drawn {
    gap: ToothGap,
    symmetric: bool,
}

/// Pitch \[m\] of chains from a watch to a ship, and the roller in pitches.
fn chain() -> impl Strategy<Value = (f64, f64)> {
    (-2.3..-0.9_f64, 0.52..0.66_f64).prop_map(|(exponent, roller)| {
        let pitch = 10_f64.powf(exponent);
        (pitch, roller * pitch)
    })
}

fn tip() -> impl Strategy<Value = Tip> {
    prop_oneof![Just(Tip::Minimum), Just(Tip::Mid), Just(Tip::Maximum)]
}

fn seat() -> impl Strategy<Value = Seat> {
    prop_oneof![Just(Seat::Pitch), Just(Seat::Bottom)]
}

fn standard() -> impl Strategy<Value = Drawn> {
    let form = (0..3_u8, 0.0..=1.0_f64, tip(), seat(), 0.502..0.56_f64);
    (chain(), 6..150_u32, form).prop_map(
        |((pitch, roller), teeth, (kind, gap, tip, seat, wide))| {
            let form = match kind {
                0 => ToothForm::Iso606 { gap, tip, seat },
                1 => ToothForm::AsaTypeII { tip },
                _ => ToothForm::Circular {
                    seat_radius: wide * roller,
                    tip,
                    seat,
                },
            };
            let gap = ToothGap::new(teeth, pitch, roller, &form).expect("the form fits the chain");
            Drawn {
                gap,
                symmetric: true,
            }
        },
    )
}

/// A gap as measured: points on the flanks of two different ISO gaps, right and left, with arcs fitted through them.
fn measured() -> impl Strategy<Value = Drawn> {
    (chain(), 9..80_u32, 0.0..=1.0_f64, 0.0..=1.0_f64, 20..60_u32).prop_filter_map(
        "gaps that differ",
        |((pitch, roller), teeth, right, left, count)| {
            if (right - left).abs() < 0.2 {
                return None;
            }
            let drawn = |gap: f64| {
                let form = ToothForm::Iso606 {
                    gap,
                    tip: Tip::Minimum,
                    seat: Seat::Bottom,
                };
                ToothGap::new(teeth, pitch, roller, &form).expect("the form fits the chain")
            };
            let halves = [drawn(right), drawn(left)];
            // Tips below both points, so that both sides keep a land.
            if halves.iter().any(|gap| gap.pointed) {
                return None;
            }
            let tip = halves[0].pieces()[0];
            let last = *halves[1].pieces().last().expect("a tip");
            let faces = halves.map(|gap| {
                let inner = &gap.pieces()[1..gap.pieces().len() - 1];
                ArcSpline::open(inner).expect("seat and flanks")
            });
            let mut points = Vec::new();
            for (side, face) in faces.iter().enumerate() {
                let half = 0.5 * face.length();
                for k in 0..=count {
                    let share = f64::from(k) / f64::from(count);
                    if side == 1 && k == 0 {
                        continue;
                    }
                    points.push(face.point_at(half * (share + side as f64)));
                }
            }
            let mut pieces = vec![tip];
            pieces.extend(fit_arcs(&points, false, 1e-5 * pitch).expect("smooth points"));
            pieces.push(last);
            let form = ToothForm::Path { pieces };
            let gap =
                ToothGap::new(teeth, pitch, roller, &form).expect("a gap like those measured");
            Some(Drawn {
                gap,
                symmetric: false,
            })
        },
    )
}

fn any_gap() -> impl Strategy<Value = Drawn> {
    prop_oneof![standard(), measured()]
}

/// A place in the rim of a sprocket by its angle and by how far between root less a half roller and tip plus one it is.
fn place(gap: &ToothGap, angle: f64, share: f64) -> Point {
    let low = gap.root_radius - 0.5 * gap.roller_diameter;
    let high = gap.tip_radius + gap.roller_diameter;
    let radius = low + (high - low) * share;
    Point::new(radius * angle.cos(), radius * angle.sin())
}

fn distance(curve: &ArcSpline, p: Point) -> f64 {
    curve
        .nearest(p, f64::INFINITY)
        .expect("a finite place")
        .distance
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Closed, without gaps, and smooth everywhere but at the tips, where it turns to the left: an edge of the material.
    #[test]
    fn outlines_are_closed_and_smooth_but_for_the_tips(drawn in any_gap()) {
        let outline = drawn.gap.outline().unwrap();
        prop_assert!(outline.is_closed());
        let pieces = outline.pieces();
        for (i, piece) in pieces.iter().enumerate() {
            let next = &pieces[(i + 1) % pieces.len()];
            // Fitted arcs of long radius know their ends to fewer digits.
            let digits = if drawn.symmetric { 1e-12 } else { 1e-10 };
            prop_assert!((piece.end() - next.start()).norm() < digits * drawn.gap.tip_radius);
        }
        let corners = outline.corners();
        let teeth = drawn.gap.teeth as usize;
        prop_assert_eq!(corners.len(), teeth * if drawn.gap.pointed { 1 } else { 2 });
        for corner in corners {
            prop_assert!(corner.turning > 0.0);
            prop_assert!((corner.point.coords.norm() / drawn.gap.tip_radius - 1.0).abs() < 1e-9);
        }
        // The material of a whole turn: between the circles of roots and tips.
        let area = outline.area_moments().area / std::f64::consts::PI;
        prop_assert!(area > drawn.gap.root_radius.powi(2) && area < drawn.gap.tip_radius.powi(2));
    }

    /// One gap is like the next; standard gaps are mirror images of themselves, and a measured one whose sides differ is not.
    #[test]
    fn gaps_repeat_and_standard_ones_are_symmetric(drawn in any_gap(), angles in prop::collection::vec((0.0..TAU, 0.0..1.0_f64), 60)) {
        let outline = drawn.gap.outline().unwrap();
        let size = drawn.gap.pitch;
        let step = TAU / f64::from(drawn.gap.teeth);
        let mut uneven = 0.0_f64;
        for (angle, share) in angles {
            let here = distance(&outline, place(&drawn.gap, angle, share));
            let next = distance(&outline, place(&drawn.gap, angle + step, share));
            prop_assert!((here - next).abs() < 1e-11 * drawn.gap.tip_radius.max(size));
            let across = distance(&outline, place(&drawn.gap, 2.0 * FRAC_PI_2 - angle, share));
            uneven = uneven.max((here - across).abs());
        }
        if drawn.symmetric {
            prop_assert!(uneven < 1e-11 * drawn.gap.tip_radius, "{uneven}");
        } else {
            prop_assert!(uneven > 1e-4 * size, "{uneven}");
        }
    }

    /// |d(p) − d(q)| ≤ |p − q|, near the teeth and across the axis; and on the way to its foot a point keeps foot and normal while the
    /// distance shrinks as fast as the way does. Both together say that the normal is the gradient.
    #[test]
    fn distances_are_distances(
        drawn in any_gap(),
        pairs in prop::collection::vec(((0.0..TAU, 0.0..1.0_f64), (-0.1..0.1_f64, -0.3..0.3_f64), 0.05..0.95_f64), 40),
    ) {
        let outline = drawn.gap.outline().unwrap();
        let rounding = 1e-13 * drawn.gap.tip_radius;
        for ((angle, share), (turn, lift), part) in pairs {
            let (p, q) = (place(&drawn.gap, angle, share), place(&drawn.gap, angle + turn, share + lift));
            let apart = (distance(&outline, p) - distance(&outline, q)).abs();
            prop_assert!(apart <= (p - q).norm() + rounding, "{apart} over {}", (p - q).norm());

            let foot = outline.nearest(p, f64::INFINITY).unwrap();
            prop_assert!((foot.normal.norm() - 1.0).abs() < 1e-12);
            let nearer = p - foot.normal * (part * foot.distance);
            let again = outline.nearest(nearer, f64::INFINITY).unwrap();
            prop_assert!((again.distance - (1.0 - part) * foot.distance).abs() < rounding);
            prop_assert!((again.point - foot.point).norm() < 10.0 * rounding);
            if foot.distance.abs() > 1e-6 * drawn.gap.pitch {
                prop_assert!((again.normal - foot.normal).norm() < 1e-6);
            }
        }
    }

    /// Closed form: the distance from a whole circle in any number of arcs is |p − c| − r, its foot lies on the ray, and the arc length is
    /// r times the angle from where the circle begins.
    #[test]
    fn a_circle_has_a_closed_form(radius in 0.01..2.0_f64, arcs in 1..40_u32, begin in -3.0..3.0_f64, angle in 0.0..TAU, away in 0.01..3.0_f64) {
        let sweep = TAU / f64::from(arcs);
        let centre = Point::new(0.3, -0.7);
        let pieces: Vec<_> = (0..arcs)
            .map(|k| Piece::Arc(Arc { centre, radius, start_angle: begin + f64::from(k) * sweep, sweep }))
            .collect();
        let circle = ArcSpline::closed(&pieces).unwrap();
        let ray = Vector::new((begin + angle).cos(), (begin + angle).sin());
        let foot = circle.nearest(centre + ray * (away * radius), f64::INFINITY).unwrap();
        prop_assert!((foot.distance - (away - 1.0) * radius).abs() < 1e-14 * (1.0 + away));
        prop_assert!((foot.normal - ray).norm() < 1e-12);
        let along = (circle.arc_length_of(&foot) - angle * radius).abs();
        prop_assert!(along < 1e-12 || (along - TAU * radius).abs() < 1e-12, "{along}");
        prop_assert_eq!(circle.contains(centre + ray * (away * radius)), away <= 1.0);
    }
}
