//! Fitted arcs keep their promise: every point within tolerance, no corner anywhere.

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{
    ArcSpline, GeometryError, Piece, Point, Seat, Tip, ToothForm, ToothGap, fit_arcs,
};

fn deviation(curve: &ArcSpline, points: &[Point]) -> f64 {
    points
        .iter()
        .map(|&p| {
            let foot = curve.nearest(p, f64::INFINITY);
            foot.expect("nothing is out of reach").distance.abs()
        })
        .fold(0.0, f64::max)
}

fn largest_turn(pieces: &[Piece], closed: bool) -> f64 {
    let joints = usize::from(!closed);
    (joints..pieces.len())
        .map(|i| {
            let before = pieces[(i + pieces.len() - 1) % pieces.len()].end_tangent();
            let after = pieces[i].start_tangent();
            before.perp(&after).atan2(before.dot(&after)).abs()
        })
        .fold(0.0, f64::max)
}

fn ellipse(count: usize) -> Vec<Point> {
    (0..count)
        .map(|k| {
            let (sine, cosine) = (TAU * k as f64 / count as f64).sin_cos();
            Point::new(0.10 * cosine, 0.06 * sine)
        })
        .collect()
}

/// Theory: the number of arcs grows as tolerance^(−1/3), since an arc touches a curve to the
/// third order; and between the points the true ellipse is as near as at the points.
#[test]
fn an_ellipse_within_tolerance() {
    let points = ellipse(2000);
    let mut counts = Vec::new();
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7] {
        let pieces = fit_arcs(&points, true, tolerance).unwrap();
        let curve = ArcSpline::closed(&pieces).unwrap();
        let at_points = deviation(&curve, &points);
        let between = deviation(&curve, &ellipse(20_011));
        let turn = largest_turn(&pieces, true);
        println!(
            "{tolerance:.0e}: {} arcs, {at_points:.1e}, {between:.1e}, turn {turn:.1e}",
            pieces.len()
        );
        assert!(at_points <= tolerance && between <= 1.1 * tolerance);
        assert!(turn < 1e-9);
        assert!(curve.corners().is_empty());
        counts.push(pieces.len() as f64);
    }
    let order = (counts[3] / counts[0]).ln() / 1e3_f64.ln();
    assert!(
        (order - 1.0 / 3.0).abs() < 0.1,
        "grows with the power {order}"
    );
}

/// Theory: points of one circle give back the circle, in as few pieces as the turn allows.
#[test]
fn a_circle_comes_back_as_itself() {
    let arc: Vec<_> = (0..=50)
        .map(|k| {
            Point::new(1.0, 2.0)
                + 0.3
                    * nalgebra::Vector2::new(
                        (0.05 * f64::from(k)).cos(),
                        (0.05 * f64::from(k)).sin(),
                    )
        })
        .collect();
    let pieces = fit_arcs(&arc, false, 1e-9).unwrap();
    let [Piece::Arc(fitted)] = pieces[..] else {
        panic!("one arc, not {pieces:?}");
    };
    assert!((fitted.radius - 0.3).abs() < 1e-12);
    assert!((fitted.sweep - 2.5).abs() < 1e-12);

    let circle: Vec<_> = ellipse(100)
        .iter()
        .map(|p| Point::new(p.x, p.y / 0.6))
        .collect();
    let pieces = fit_arcs(&circle, true, 1e-9).unwrap();
    assert!(pieces.len() <= 3, "{}", pieces.len());
    assert!((ArcSpline::closed(&pieces).unwrap().length() - 0.1 * TAU).abs() < 1e-12);

    let line: Vec<_> = (0..20)
        .map(|k| Point::new(0.1 * f64::from(k), 0.05 * f64::from(k)))
        .collect();
    assert_eq!(fit_arcs(&line, false, 1e-9).unwrap().len(), 1);
}

/// Theory: with noise below the tolerance the fit still passes every point within it.
#[test]
fn open_curves_and_noise() {
    let wave =
        |x: f64, noise: f64| Point::new(x, 0.02 * (20.0 * x).sin() + noise * (1e4 * x).sin());
    for (noise, tolerance) in [(0.0, 1e-6), (2e-6, 2e-5)] {
        let points: Vec<_> = (0..400).map(|k| wave(1e-3 * f64::from(k), noise)).collect();
        let pieces = fit_arcs(&points, false, tolerance).unwrap();
        let curve = ArcSpline::open(&pieces).unwrap();
        println!("noise {noise:.0e}: {} pieces", pieces.len());
        assert!(deviation(&curve, &points) <= tolerance);
        assert!(largest_turn(&pieces, false) < 1e-9);
        assert!(pieces.len() < 200);
        assert!((pieces[0].start() - points[0]).norm() < 1e-15);
        assert!((pieces[pieces.len() - 1].end() - points[399]).norm() < 1e-12);
    }
}

/// A scanned tooth gap becomes a tooth form again.
#[test]
fn a_measured_gap_makes_a_wheel() {
    let form = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Mid,
        seat: Seat::Bottom,
    };
    let gap = ToothGap::new(20, 25.4e-3, 15.88e-3, &form).unwrap();
    // The two tips are corners: fit what lies between, keep the tips.
    let [tip, inner @ .., last] = gap.pieces() else {
        panic!("a gap has tips");
    };
    let inner = ArcSpline::open(inner).unwrap();
    let points: Vec<_> = (0..=300)
        .map(|k| inner.point_at(f64::from(k) / 300.0 * inner.length()))
        .collect();
    let mut pieces = vec![*tip];
    pieces.extend(fit_arcs(&points, false, 1e-6).unwrap());
    pieces.push(*last);
    let copy = ToothGap::new(20, 25.4e-3, 15.88e-3, &ToothForm::Path { pieces }).unwrap();
    let copy = copy.outline().unwrap();
    assert!(deviation(&copy, &points) <= 1e-6);
}

#[test]
fn points_that_cannot_be_fitted_are_refused() {
    let p = |x: f64, y: f64| Point::new(x, y);
    assert!(matches!(
        fit_arcs(&[p(0.0, 0.0)], false, 1e-3),
        Err(GeometryError::Count { .. })
    ));
    assert!(matches!(
        fit_arcs(&[p(0.0, 0.0), p(1.0, 0.0)], true, 1e-3),
        Err(GeometryError::Count { .. })
    ));
    assert!(fit_arcs(&[p(0.0, 0.0), p(f64::NAN, 0.0)], false, 1e-3).is_err());
    assert!(fit_arcs(&[p(0.0, 0.0), p(0.0, 0.0), p(1.0, 0.0)], false, 1e-3).is_err());
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert!(fit_arcs(&[p(0.0, 0.0), p(1.0, 0.0)], false, tolerance).is_err());
    }
    // There and back again: refused or fitted, not a panic.
    let _ = fit_arcs(
        &[p(0.0, 0.0), p(1.0, 0.0), p(0.0, 0.0), p(1.0, 0.0)],
        false,
        1e-3,
    );
    // A square comes out rounded but within reach.
    let square = [p(0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)];
    let rounded = fit_arcs(&square, true, 1e-3).unwrap();
    assert!((ArcSpline::closed(&rounded).unwrap().length() - PI * 2.0_f64.sqrt()).abs() < 1e-12);
}
