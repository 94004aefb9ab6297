//! Clearances between curves, against closed forms and dense sampling.

use std::f64::consts::PI;

use chaindrive_geometry::{Arc, ArcSpline, Piece, Point, Vector, bar};

use crate::shapes::{Dice, asa_wheel, iso_wheel};

const TOLERANCE: f64 = 1e-7;

fn disc(centre: Point, radius: f64) -> ArcSpline {
    let half = |start_angle| {
        Piece::from(Arc {
            centre,
            radius,
            start_angle,
            sweep: PI,
        })
    };
    ArcSpline::closed(&[half(0.0), half(PI)]).expect("a disc")
}

fn moved(curve: &ArcSpline, angle: f64, by: Vector) -> ArcSpline {
    let pieces: Vec<_> = curve
        .pieces()
        .iter()
        .map(|piece| piece.rotated(angle).translated(by))
        .collect();
    ArcSpline::closed(&pieces).expect("a moved wheel")
}

/// Closed form: discs are |c₁ − c₂| − r₁ − r₂ apart, also where they overlap or one holds the other's rim.
#[test]
fn discs_are_their_centres_less_their_radii_apart() {
    let solid = disc(Point::new(0.1, -0.2), 0.3);
    for (centre, radius) in [
        (Point::new(1.0, 0.4), 0.25),
        (Point::new(0.5, 0.0), 0.2),
        (Point::new(0.1, 0.25), 0.16),
    ] {
        let other = disc(centre, radius);
        let apart = (centre - Point::new(0.1, -0.2)).norm() - 0.3 - radius;
        for (a, b) in [(&solid, &other), (&other, &solid)] {
            let found = a.clearance(b, f64::INFINITY, TOLERANCE).unwrap();
            assert!(
                (found.distance - apart).abs() <= TOLERANCE,
                "{found:?}, {apart}"
            );
            let foot = a.nearest(found.point, f64::INFINITY).unwrap();
            assert!((foot.distance - found.distance).abs() < 1e-12);
        }
    }
}

/// Two toothed wheels at all distances from overlapping to apart: no point of a dense sample is nearer, and none much
/// farther is named.
#[test]
fn wheels_clear_each_other_as_a_dense_sample_says() {
    let (small, large) = (iso_wheel(19), asa_wheel(25));
    let mut dice = Dice::new(11);
    for step in 0..12 {
        let away = 0.17 + 4e-3 * f64::from(step);
        let other = moved(
            &small,
            6.0 * dice.next(),
            Vector::new(away, 0.02 * dice.next()),
        );
        let found = large.clearance(&other, f64::INFINITY, TOLERANCE).unwrap();
        let dense = other
            .pieces()
            .iter()
            .flat_map(|piece| (0..=400).map(|k| piece.point(f64::from(k) / 400.0)));
        let least = dense
            .map(|point| large.nearest(point, f64::INFINITY).unwrap().distance)
            .fold(f64::INFINITY, f64::min);
        assert!(found.distance <= least + TOLERANCE, "{found:?}, {least}");
        // Between two points of the sample, 3e-5 m apart at most, a distance changes by no more than half of that.
        assert!(found.distance >= least - 1.5e-5, "{found:?}, {least}");
    }
}

/// A bar beyond the reach is not looked at closely, and not named.
#[test]
fn nothing_is_named_beyond_the_reach() {
    let wheel = iso_wheel(19);
    let guide = bar(Point::new(0.1, 0.2), Point::new(-0.1, 0.2), 0.05, 0.5).unwrap();
    let found = wheel.clearance(&guide, f64::INFINITY, TOLERANCE).unwrap();
    assert!(found.distance > 0.1);
    assert_eq!(wheel.clearance(&guide, 0.1, TOLERANCE), None);
    assert_eq!(
        wheel
            .clearance(&guide, 0.2, TOLERANCE)
            .map(|c| c.distance > 0.1),
        Some(true)
    );
}
