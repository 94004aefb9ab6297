//! Nearest points of a curve are nearest, and its normal is the gradient of the distance.

use crate::shapes;

use chaindrive_geometry::{Arc, ArcSpline, Foot, Piece, Point, Vector};
use proptest::prelude::*;
use shapes::{Dice, asa_wheel, bar_face, iso_wheel, long_spline, rounded_rail};

fn curves() -> Vec<(&'static str, ArcSpline)> {
    vec![
        ("ISO wheel", iso_wheel(19)),
        ("ASA wheel", asa_wheel(19)),
        ("rail", rounded_rail(11)),
        ("bar", bar_face()),
        ("long spline", long_spline(200)),
    ]
}

/// Points in the box around the curve and a tenth beyond; half of them close to the curve.
fn points(curve: &ArcSpline, count: usize, seed: u64) -> impl Iterator<Item = Point> {
    let mut dice = Dice::new(seed);
    let bounds = curve.aabb();
    let margin = Vector::repeat(0.1 * bounds.diagonal());
    let (low, size) = (bounds.min - margin, bounds.max - bounds.min + 2.0 * margin);
    let near: Vec<_> = (0..count / 2)
        .map(|_| {
            let on = curve.point_at(dice.next() * curve.length());
            let off = Vector::new(dice.next() - 0.5, dice.next() - 0.5);
            on + off * 0.03 * bounds.diagonal()
        })
        .collect();
    let far: Vec<_> = (0..count - count / 2)
        .map(|_| low + Vector::new(dice.next() * size.x, dice.next() * size.y))
        .collect();
    near.into_iter().chain(far)
}

/// Theory: the tree of boxes only narrows the search, so it must not change a single bit.
#[test]
fn the_tree_changes_nothing() {
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    for (name, curve) in curves() {
        let reach = 0.05 * curve.aabb().diagonal();
        let mut hits = 0;
        for p in points(&curve, 100_000, 1) {
            for reach in [reach, f64::INFINITY] {
                let (tree, all) = (
                    curve.nearest(p, reach),
                    curve.nearest_by_exhaustion(p, reach),
                );
                assert_eq!(tree, all, "{name} at {p}");
            }
            curve.local_minima(p, reach, &mut found);
            curve.local_minima_by_exhaustion(p, reach, &mut expected);
            assert_eq!(found, expected, "{name} at {p}");
            hits += found.len();
        }
        println!("{name}: {hits} local minima within reach of 100000 points");
    }
}

/// Theory: p = x + d n, with |n| = 1, and the foot lies on the piece where it says.
#[test]
fn feet_are_consistent() {
    for (name, curve) in curves() {
        let mut found = Vec::new();
        for p in points(&curve, 10_000, 2) {
            curve.local_minima(p, f64::INFINITY, &mut found);
            assert!(!found.is_empty());
            for foot in &found {
                assert!((foot.normal.norm() - 1.0).abs() < 1e-12, "{name}");
                assert!(
                    (foot.point + foot.normal * foot.distance - p).norm() < 1e-15,
                    "{name}"
                );
                let place = curve.pieces()[foot.piece].point(foot.parameter);
                assert!((place - foot.point).norm() < 1e-14, "{name} {foot:?}");
            }
        }
    }
}

/// Theory: ∇d = n. The five-point difference with step h errs by about h⁴/ρ⁴ / 3, where ρ is the
/// distance to the centre of curvature, and by rounding ε |p| / h. With h = ρ / 400 the first is
/// 10⁻¹¹ and the second, on curves of 0.2 m with ρ > 1 mm, 10⁻¹¹ too.
#[test]
fn the_normal_is_the_gradient_of_the_distance() {
    let mut count = 0;
    let mut worst = (0.0_f64, 0.0_f64);
    for (name, curve) in curves() {
        for p in points(&curve, 20_000, 3) {
            let foot = curve.nearest(p, f64::INFINITY).unwrap();
            let rho = 1.0 / foot.normal_rate().abs();
            if rho < 1e-3 {
                continue;
            }
            let h = rho.min(0.1) / 400.0;
            let Some(gradient) = difference(&curve, &foot, p, h) else {
                continue;
            };
            let error = (gradient - foot.normal).norm();
            assert!(error < 1e-9, "{name} at {p}: {error:e}, {foot:?}");
            worst.0 = worst.0.max(error);

            // ∂n/∂p = c t tᵀ, by the plain central difference.
            let tangent = Vector::new(-foot.normal.y, foot.normal.x);
            let (a, b) = (p + tangent * h, p - tangent * h);
            let normals = [a, b].map(|q| curve.nearest(q, f64::INFINITY).unwrap().normal);
            let rate = (normals[0] - normals[1]).dot(&tangent) / (2.0 * h);
            let error = (rate - foot.normal_rate()).abs() * rho.min(1.0);
            assert!(error < 1e-4, "{name} at {p}: rate off by {error:e}");
            worst.1 = worst.1.max(error);
            count += 1;
        }
    }
    println!(
        "{count} points: gradient error {:.1e}, relative error of its rate {:.1e}",
        worst.0, worst.1
    );
    assert!(count > 20_000);
}

/// Gradient of the distance, or none if a point of the stencil is nearest to another place.
fn difference(curve: &ArcSpline, foot: &Foot, p: Point, h: f64) -> Option<Vector> {
    let along = |axis: Vector| {
        let distance = |k: f64| {
            let there = curve.nearest(p + axis * (k * h), f64::INFINITY)?;
            let same =
                there.piece == foot.piece && there.curvature.to_bits() == foot.curvature.to_bits();
            same.then_some(there.distance)
        };
        // f′ ≈ (8 (f₁ − f₋₁) − (f₂ − f₋₂)) / 12 h
        let first = distance(1.0)? - distance(-1.0)?;
        let second = distance(2.0)? - distance(-2.0)?;
        Some((8.0 * first - second) / (12.0 * h))
    };
    Some(Vector::new(along(Vector::x())?, along(Vector::y())?))
}

/// Theory: a roller resting on both flanks of a gap has two contacts, mirror images of each other.
#[test]
fn a_roller_between_two_flanks_touches_both() {
    let wheel = iso_wheel(19);
    let high = Point::new(0.0, 83e-3);
    let mut found = Vec::new();
    wheel.local_minima(high, 12e-3, &mut found);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!((found[0].distance - found[1].distance).abs() < 1e-15);
    assert!((found[0].normal.x + found[1].normal.x).abs() < 1e-12);
    assert!(found.iter().all(|foot| foot.distance > 0.0));
}

/// Theory: at a tangent joint there is exactly one foot, whichever side rounding prefers.
#[test]
fn tangent_joints_count_once() {
    let wheel = iso_wheel(19);
    let mut found = Vec::new();
    let corners: Vec<_> = wheel.corners().iter().map(|corner| corner.joint).collect();
    for (joint, piece) in wheel.pieces().iter().enumerate() {
        if corners.contains(&joint) {
            continue;
        }
        for distance in [-1e-4, 0.0, 1e-9, 1e-4] {
            for aside in [-1e-16, 0.0, 1e-16] {
                let normal = piece.normal(0.0);
                let tangent = piece.start_tangent();
                let p = piece.start() + normal * distance + tangent * aside;
                wheel.local_minima(p, 2e-4, &mut found);
                assert_eq!(found.len(), 1, "joint {joint} at {distance}");
                assert!((found[0].distance - distance).abs() < 1e-15);
                assert!((found[0].normal - normal).norm() < 1e-9);
            }
        }
    }
}

/// Theory: every point of a seat is equally far from its centre; an answer must come all the same.
#[test]
fn the_centre_of_a_seat_has_a_foot() {
    let wheel = shapes::iso_gap_centred_on_pitch();
    let centre = Point::new(0.0, 0.5 * 25.4e-3 / (std::f64::consts::PI / 19.0).sin());
    let foot = wheel.nearest(centre, 1.0).unwrap();
    assert!((foot.distance - 0.505 * 15.88e-3).abs() < 1e-15);
    assert!((foot.normal - Vector::y()).norm() < 1e-12);
}

/// Theory: the same for a circle in several arcs, at its centre and a few roundings beside it.
#[test]
fn the_centre_of_a_full_circle_has_a_foot() {
    let quarter = |k: i32| {
        Piece::from(Arc {
            centre: Point::new(1.0, -2.0),
            radius: 0.3,
            start_angle: 0.1 + std::f64::consts::FRAC_PI_2 * f64::from(k),
            sweep: std::f64::consts::FRAC_PI_2,
        })
    };
    let whole = Piece::from(Arc {
        centre: Point::new(1.0, -2.0),
        radius: 0.3,
        start_angle: 0.1,
        sweep: std::f64::consts::TAU,
    });
    let mut dice = Dice::new(10);
    for pieces in [vec![whole], (0..4).map(quarter).collect()] {
        let disc = ArcSpline::closed(&pieces).unwrap();
        for k in 0..20_000 {
            let off = Vector::new(dice.next() - 0.5, dice.next() - 0.5) * 2e-18 * f64::from(k);
            let foot = disc.nearest(Point::new(1.0, -2.0) + off, f64::INFINITY);
            assert!((foot.expect("a disc has a border").distance + 0.3).abs() < 1e-13);
        }
        assert!((disc.nearest(Point::new(2.0, -2.0), 1.0).unwrap().distance - 0.7).abs() < 1e-15);
    }
}

/// Refused or left unanswered, but never a panic.
#[test]
fn points_that_are_not_finite_have_no_foot() {
    let wheel = iso_wheel(19);
    let mut found = Vec::new();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for p in [Point::new(bad, 0.0), Point::new(0.0, bad)] {
            assert_eq!(wheel.nearest(p, f64::INFINITY), None);
            wheel.local_minima(p, f64::INFINITY, &mut found);
            assert!(found.is_empty() && !wheel.contains(p));
        }
    }
    assert_eq!(wheel.nearest(Point::origin(), f64::NAN), None);
    assert_eq!(wheel.nearest(Point::origin(), -1.0), None);
    assert!(
        wheel
            .nearest(Point::new(1e150, 0.0), f64::INFINITY)
            .is_some()
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Theory: no point of the curve is closer than the nearest, and none of the local minima is
    /// farther than its neighbourhood on the curve.
    #[test]
    fn no_sampled_point_is_closer(x in -0.15..0.15_f64, y in -0.15..0.15_f64, teeth in 6..40_u32) {
        let p = Point::new(x, y);
        for curve in [iso_wheel(teeth), asa_wheel(teeth), rounded_rail(u64::from(teeth))] {
            let foot = curve.nearest(p, f64::INFINITY).unwrap();
            let least = foot.distance.abs() - 1e-15;
            for k in 0..4000 {
                let on = curve.point_at(f64::from(k) / 4000.0 * curve.length());
                prop_assert!((p - on).norm() >= least, "{on} is closer than {foot:?}");
            }
        }
    }

    /// Theory: the sign of the distance agrees with the winding number of a fine polygon.
    #[test]
    fn the_sign_tells_inside_from_outside(x in -0.1..0.1_f64, y in -0.1..0.1_f64) {
        let wheel = iso_wheel(19);
        let p = Point::new(x, y);
        let distance = wheel.nearest(p, f64::INFINITY).unwrap().distance;
        prop_assume!(distance.abs() > 1e-6);
        let corner = |k: i32| wheel.point_at(f64::from(k) / 20_000.0 * wheel.length()) - p;
        let winding: f64 = (0..20_000)
            .map(|k| {
                let (a, b) = (corner(k), corner(k + 1));
                a.perp(&b).atan2(a.dot(&b))
            })
            .sum();
        prop_assert_eq!(distance < 0.0, winding > 3.0);
        prop_assert_eq!(wheel.contains(p), distance < 0.0);
    }
}
