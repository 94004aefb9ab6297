//! Crossings and parts of curves, and polylines along them, against closed forms and dense sampling.

use std::f64::consts::{FRAC_PI_2, PI};

use chaindrive_geometry::{Arc, ArcSpline, Piece, Point, Segment, Vector};
use proptest::prelude::*;

use crate::shapes::{Dice, iso_wheel, long_spline, rounded_rail};

fn line(from: [f64; 2], to: [f64; 2]) -> ArcSpline {
    let [from, to] = [from, to].map(|[x, y]| Point::new(x, y));
    ArcSpline::open(&[Segment::new(from, to).into()]).expect("a line")
}

fn circle(centre: Point, radius: f64, arcs: u32) -> ArcSpline {
    let sweep = 2.0 * PI / f64::from(arcs);
    let pieces = (0..arcs).map(|k| {
        Piece::Arc(Arc {
            centre,
            radius,
            start_angle: f64::from(k) * sweep,
            sweep,
        })
    });
    ArcSpline::closed(&pieces.collect::<Vec<_>>()).expect("a circle")
}

/// Closed form: a line at height h cuts a circle at ±√(r² − h²), touches it at h = r, and misses it beyond.
#[test]
fn lines_cut_circles_at_half_the_chord() {
    let (centre, radius) = (Point::new(0.3, -0.2), 0.5);
    for arcs in [1, 2, 3, 7, 100] {
        let solid = circle(centre, radius, arcs);
        for h in [-0.4999, -0.3, 0.0, 0.123, 0.49] {
            let cut = line([-1.0, centre.y + h], [2.0, centre.y + h]);
            let found = cut.crossings(&solid);
            let half = f64::sqrt(radius * radius - h * h);
            assert_eq!(found.len(), 2, "{arcs} arcs, {h}: {found:?}");
            for (crossing, x) in found.iter().zip([centre.x - half, centre.x + half]) {
                assert!(
                    (crossing.point.x - x).abs() < 1e-13
                        && (crossing.point.y - centre.y - h).abs() < 1e-15
                );
                assert!((crossing.along[0] - (x + 1.0)).abs() < 1e-13);
                let there = solid.point_at(crossing.along[1]);
                assert!((there - crossing.point).norm() < 1e-13);
            }
        }
        assert!(cut_count(&solid, centre.y + radius + 1e-9) == 0);
        assert!(cut_count(&solid, centre.y - radius - 1e-9) == 0);
    }
}

fn cut_count(solid: &ArcSpline, height: f64) -> usize {
    line([-1.0, height], [2.0, height]).crossings(solid).len()
}

/// Closed form: circles of radii r, R at a distance D meet at x = (D² + r² − R²)/(2 D) on the line of centres, also where they
/// meet in the joint of two arcs.
#[test]
fn circles_meet_where_the_triangle_of_radii_and_distance_says() {
    let small = circle(Point::origin(), 0.3, 4);
    for distance in [0.25, 0.4, 0.5, 0.69] {
        for turned in [0.0, 0.7, FRAC_PI_2] {
            let along = Vector::new(turned.cos(), turned.sin());
            let large = circle(Point::origin() + along * distance, 0.4, 8);
            let found = small.crossings(&large);
            let x = (distance * distance + 0.09 - 0.16) / (2.0 * distance);
            assert_eq!(found.len(), 2, "{distance}, {turned}: {found:?}");
            for crossing in found {
                assert!((crossing.point.coords.dot(&along) - x).abs() < 1e-14);
                assert!((crossing.point.coords.norm() - 0.3).abs() < 1e-14);
            }
        }
    }
    // One inside the other, and far apart.
    assert!(
        small
            .crossings(&circle(Point::new(0.05, 0.0), 0.4, 3))
            .is_empty()
    );
    assert!(
        small
            .crossings(&circle(Point::new(5.0, 0.0), 0.4, 3))
            .is_empty()
    );
    // A joint of both: the same point on two pieces of each.
    let cross = circle(Point::new(0.3, 0.4), 0.4, 4);
    let at_joint = small.crossings(&cross);
    assert!(
        at_joint
            .iter()
            .any(|c| (c.point - Point::new(0.3, 0.0)).norm() < 1e-14)
    );
    assert_eq!(at_joint.len(), 2, "{at_joint:?}");
}

/// A fine polygon along one curve changes sides of the other exactly between the crossings found.
#[test]
fn a_dense_walk_changes_sides_at_the_crossings() {
    let wheel = iso_wheel(19);
    let mut dice = Dice::new(17);
    let mut total = 0;
    for _ in 0..40 {
        let turn = 6.3 * dice.next();
        let by = Vector::new(0.2 * (dice.next() - 0.5), 0.2 * (dice.next() - 0.5));
        let moved = |piece: &Piece| piece.rotated(turn).translated(by);
        let pieces: Vec<_> = rounded_rail(3).pieces().iter().map(moved).collect();
        let rail = ArcSpline::open(&pieces).unwrap();
        let found = rail.crossings(&wheel);
        total += found.len();
        let mut passed = 0;
        let mut inside = wheel.contains(rail.point_at(0.0));
        let steps = 20_000;
        for k in 1..=steps {
            let s = rail.length() * f64::from(k) / f64::from(steps);
            let until = found.iter().filter(|c| c.along[0] <= s).count();
            let now = wheel.contains(rail.point_at(s));
            assert_eq!(
                now != inside,
                (until - passed) % 2 == 1,
                "at {s} of {found:?}"
            );
            (inside, passed) = (now, until);
        }
        for crossing in &found {
            assert!(wheel.nearest(crossing.point, 1.0).unwrap().distance.abs() < 1e-14);
            assert!((rail.point_at(crossing.along[0]) - crossing.point).norm() < 1e-14);
            assert!((wheel.point_at(crossing.along[1]) - crossing.point).norm() < 1e-13);
        }
    }
    assert!(total > 30, "{total} crossings are too few to say anything");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Theory: a part has the length asked for, and lies on the curve.
    #[test]
    fn parts_lie_on_their_curve(seed in 1..50_u64, a in 0.0..1.0_f64, b in 0.0..1.0_f64) {
        let whole = if seed % 2 == 0 { rounded_rail(seed) } else { long_spline(60) };
        let (from, to) = (a.min(b) * whole.length(), a.max(b) * whole.length());
        prop_assume!(to - from > 1e-6);
        let part = whole.part(from, to).expect("long enough");
        prop_assert!((part.length() - (to - from)).abs() < 1e-9);
        for k in 0..=50 {
            let s = f64::from(k) / 50.0 * part.length();
            prop_assert!((part.point_at(s) - whole.point_at(from + s)).norm() < 1e-9);
        }
    }

    /// Theory: chords of height h over an arc; joints are hit exactly, and no chord is much finer than it must be.
    #[test]
    fn chords_stand_off_by_no_more_than_the_tolerance(teeth in 6..60_u32, exponent in -7.0..-3.5_f64) {
        let wheel = iso_wheel(teeth);
        let tolerance = 10_f64.powf(exponent);
        let points = wheel.polyline(tolerance).unwrap();
        prop_assert!((points[0] - points[points.len() - 1]).norm() < 1e-12);
        let mut worst = 0.0_f64;
        for pair in points.windows(2) {
            for k in 0..=4 {
                let p = pair[0] + (pair[1] - pair[0]) * (f64::from(k) / 4.0);
                let off = wheel.nearest(p, f64::INFINITY).unwrap().distance.abs();
                prop_assert!(off <= tolerance * (1.0 + 1e-9) + 1e-15, "{off} at {p}");
                worst = worst.max(off);
            }
        }
        prop_assert!(worst > 0.1 * tolerance || points.len() <= 6 * wheel.pieces().len());
        for piece in wheel.pieces() {
            prop_assert!(points.iter().any(|p| (p - piece.end()).norm() < 1e-15));
        }
    }
}

#[test]
fn tolerances_without_meaning_are_refused() {
    let wheel = iso_wheel(19);
    for bad in [0.0, -1.0, f64::NAN, 1e-30] {
        let error = wheel.polyline(bad).unwrap_err().to_string();
        assert!(error.contains("tolerance of an outline"), "{error}");
    }
    // However coarse, every joint stays, and no chord spans more than a quarter turn.
    let coarse = circle(Point::origin(), 1.0, 1)
        .polyline(f64::INFINITY)
        .unwrap();
    assert_eq!(coarse.len(), 5);
}
