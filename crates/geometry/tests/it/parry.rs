//! The curve as one of parry's shapes, against parry's own.

use crate::shapes;

use chaindrive_geometry::{ArcSpline, Piece, Point, RollerDispatcher, Segment};
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::{
    ClosestPoints, DefaultQueryDispatcher, PointQuery, QueryDispatcher, Ray, RayCast,
    ShapeCastOptions, ShapeCastStatus,
};
use parry2d_f64::shape::{Ball, ConvexPolygon, Cuboid, Polyline, Shape};
use shapes::{Dice, bar_face, iso_wheel, rounded_rail};

fn glam(p: Point) -> Vector {
    Vector::new(p.x, p.y)
}

/// Theory: a chord of length h stands off its arc by κ h² / 8, so the distance to a polyline
/// approaches that to the arcs with the square of the facet length.
#[test]
fn a_polyline_converges_with_the_square_of_its_facets() {
    for (name, curve) in [
        ("wheel", iso_wheel(19)),
        ("rail", rounded_rail(11)),
        ("bar", bar_face()),
    ] {
        let mut dice = Dice::new(4);
        let arcs: Vec<_> = (curve.pieces().iter())
            .filter(|piece| matches!(piece, Piece::Arc(_)))
            .collect();
        let points: Vec<_> = (0..10_000)
            .map(|k| {
                let on = arcs[k % arcs.len()].point(dice.next());
                on + nalgebra::Vector2::new(dice.next() - 0.5, dice.next() - 0.5) * 8e-3
            })
            .collect();
        let error = |facets: usize| {
            let mut vertices: Vec<_> = curve
                .pieces()
                .iter()
                .flat_map(|piece| (0..facets).map(|k| glam(piece.point(k as f64 / facets as f64))))
                .collect();
            let last = curve.pieces()[curve.pieces().len() - 1];
            vertices.push(glam(last.end()));
            let polyline = Polyline::new(vertices, None);
            let sum: f64 = points
                .iter()
                .map(|&p| {
                    let exact = curve.nearest(p, f64::INFINITY).unwrap().distance.abs();
                    (polyline.distance_to_local_point(glam(p), true) - exact).abs()
                })
                .sum();
            sum / points.len() as f64
        };
        let errors = [8, 16, 32, 64, 128].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            println!(
                "{name}: mean error {:.2e} -> {:.2e} m, order {order:.3}",
                pair[0], pair[1]
            );
            assert!((order - 2.0).abs() < 0.1, "{name}: order {order}");
        }
    }
}

/// Theory: the first hit along a ray lies on the curve, and nothing lies before it: marching by the
/// distance arrives at the same place.
#[test]
fn rays_hit_what_sphere_tracing_finds() {
    for curve in [iso_wheel(19), rounded_rail(11), bar_face()] {
        let mut dice = Dice::new(6);
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..5000 {
            let origin = Point::new(0.3 * (dice.next() - 0.5), 0.3 * (dice.next() - 0.5));
            let angle = std::f64::consts::TAU * dice.next();
            let direction = nalgebra::Vector2::new(angle.cos(), angle.sin());
            let ray = Ray::new(glam(origin), glam(Point::from(direction)));
            let hit = curve.cast_local_ray_and_get_normal(&ray, 1.0, false);
            let mut time = 0.0;
            for _ in 0..20_000 {
                let foot = curve
                    .nearest(origin + direction * time, f64::INFINITY)
                    .unwrap();
                time += foot.distance.abs();
                if foot.distance.abs() < 1e-13 || time > 1.0 {
                    break;
                }
            }
            if let Some(hit) = hit {
                hits += 1;
                assert!(
                    (hit.time_of_impact - time).abs() < 1e-8,
                    "{} {time}",
                    hit.time_of_impact
                );
                assert!(hit.normal.dot(ray.dir) <= 0.0);
                assert!((hit.normal.length() - 1.0).abs() < 1e-12);
            } else {
                misses += 1;
                assert!(
                    time > 1.0,
                    "the ray from {origin} along {direction} passes through"
                );
            }
        }
        println!("{hits} hits, {misses} misses");
        assert!(hits > 500 && misses > 100);
    }
}

/// Theory: from inside the solid a solid cast stops at once.
#[test]
fn solid_casts_start_inside() {
    let wheel = iso_wheel(19);
    let ray = Ray::new(Vector::ZERO, Vector::Y);
    assert_eq!(wheel.cast_local_ray(&ray, 1.0, true), Some(0.0));
    let depth = wheel.cast_local_ray(&ray, 1.0, false).unwrap();
    assert!((depth - wheel.nearest(Point::new(0.0, depth), 1e-9).unwrap().point.y).abs() < 1e-12);
}

/// Theory: mass, centroid and inertia of a wheel against a fine polygon of parry's own.
#[test]
fn mass_properties_agree_with_a_fine_polygon() {
    let wheel = iso_wheel(6);
    let ours = wheel.mass_properties(7850.0);
    // The wheel is a fan of triangles about its centre; parry knows triangles.
    let count = 60_000;
    let at = |k: i32| glam(wheel.point_at(f64::from(k) / f64::from(count) * wheel.length()));
    let (mut mass, mut inertia) = (0.0, 0.0);
    for k in 0..count {
        let fan = parry2d_f64::shape::Triangle::new(Vector::ZERO, at(k), at(k + 1));
        let part = fan.mass_properties(7850.0).mass();
        mass += part;
        // Parry takes this moment about the first corner, the centre of the wheel, although its
        // mass properties call it central.
        inertia += part * fan.unit_angular_inertia();
    }
    assert!(
        (ours.mass() / mass - 1.0).abs() < 1e-7,
        "{} {mass}",
        ours.mass()
    );
    assert!(ours.local_com.length() < 1e-15);
    let ours = ours.principal_inertia();
    assert!((ours / inertia - 1.0).abs() < 1e-7, "{ours} {inertia}");
    assert!(bar_face().mass_properties(7850.0).mass() <= 0.0);
}

/// A square as arc spline answers about balls as parry's own convex polygon does (theory: same
/// shape), in either order and chained before the default dispatcher.
#[test]
fn a_square_meets_a_ball_as_parrys_own_does() {
    let corners =
        [(0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)].map(|(x, y)| Point::new(x, y));
    let sides: Vec<_> = (0..4)
        .map(|i| Segment::new(corners[i], corners[(i + 1) % 4]).into())
        .collect();
    let square = ArcSpline::closed(&sides).unwrap();
    let polygon = ConvexPolygon::from_convex_hull(&corners.map(glam)).unwrap();
    let ball = Ball::new(0.2);
    let dispatcher = RollerDispatcher.chain(DefaultQueryDispatcher);
    let mut dice = Dice::new(8);
    for _ in 0..5000 {
        let at = Vector::new(3.0 * (dice.next() - 0.5), 3.0 * (dice.next() - 0.5));
        let pos12 = Pose::new(at, 6.0 * dice.next());
        let pos21 = pos12.inverse();
        let distance = |pos: &Pose, a: &dyn Shape, b: &dyn Shape| {
            dispatcher.distance(pos, a, b).unwrap().distance
        };
        let expected = distance(&pos12, &polygon, &ball);
        assert!((distance(&pos12, &square, &ball) - expected).abs() < 1e-9);
        assert!((distance(&pos21, &ball, &square) - expected).abs() < 1e-9);

        let touching = dispatcher
            .intersection_test(&pos12, &square, &ball)
            .unwrap()
            .intersecting;
        if expected.abs() > 1e-9 {
            assert_eq!(touching, expected <= 0.0);
        }
        let contact = dispatcher.contact(&pos12, &square, &ball, 0.1).unwrap();
        let reference = dispatcher.contact(&pos12, &polygon, &ball, 0.1).unwrap();
        assert_eq!(contact.is_some(), reference.is_some());
        if let (Some(ours), Some(theirs)) = (contact, reference) {
            assert!((ours.dist - theirs.dist).abs() < 1e-9);
            // Near a diagonal of the square two sides are equally deep.
            if theirs.dist > -0.2 {
                assert!((ours.normal1 - theirs.normal1).length() < 1e-6);
                assert!((ours.point1 - theirs.point1).length() < 1e-6);
                assert!((ours.point2 - theirs.point2).length() < 1e-6);
                let swapped = dispatcher
                    .contact(&pos21, &ball, &square, 0.1)
                    .unwrap()
                    .unwrap();
                assert!((swapped.normal2 - ours.normal1).length() < 1e-9);
                assert!((swapped.point1 - ours.point2).length() < 1e-9);
            }
        }
        let points = dispatcher
            .closest_points(&pos12, &square, &ball, 0.5)
            .unwrap();
        match points {
            ClosestPoints::Intersecting => assert!(expected < 1e-9),
            ClosestPoints::WithinMargin(a, b) => {
                assert!(((a - pos12 * b).length() - expected).abs() < 1e-9);
            }
            ClosestPoints::Disjoint => assert!(expected > 0.5 - 1e-9),
        }
    }
}

/// Theory: a moving ball stops where its rim touches; parry's own polygon says when.
#[test]
fn moving_balls_stop_at_the_curve() {
    let corners =
        [(0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)].map(|(x, y)| Point::new(x, y));
    let sides: Vec<_> = (0..4)
        .map(|i| Segment::new(corners[i], corners[(i + 1) % 4]).into())
        .collect();
    let square = ArcSpline::closed(&sides).unwrap();
    let polygon = Cuboid::new(Vector::splat(0.5));
    let ball = Ball::new(0.2);
    let dispatcher = RollerDispatcher.chain(DefaultQueryDispatcher);
    let options = ShapeCastOptions {
        max_time_of_impact: 10.0,
        ..ShapeCastOptions::default()
    };
    let mut dice = Dice::new(9);
    let mut hits = 0;
    for _ in 0..2000 {
        let angle = std::f64::consts::TAU * dice.next();
        let at = Vector::new(angle.cos(), angle.sin()) * 2.0;
        let aim = Vector::new(dice.next() - 0.5, dice.next() - 0.5) * 2.0;
        let velocity = (aim - at).normalize();
        let pos12 = Pose::new(at, 6.0 * dice.next());
        let cast = |pos: &Pose, v: Vector, a: &dyn Shape, b: &dyn Shape| {
            dispatcher.cast_shapes(pos, v, a, b, options).unwrap()
        };
        let ours = cast(&pos12, velocity, &square, &ball);
        let theirs = cast(&pos12, velocity, &polygon, &ball);
        let swapped_velocity = -(pos12.rotation.inverse() * velocity);
        let swapped = cast(&pos12.inverse(), swapped_velocity, &ball, &square);
        if let (Some(ours), Some(swapped)) = (ours, swapped) {
            assert_eq!(ours.status, ShapeCastStatus::Converged);
            assert!((ours.time_of_impact - swapped.time_of_impact).abs() < 1e-6);
            let rim = at + velocity * ours.time_of_impact;
            let gap = square.distance_to_local_point(rim, false) - ball.radius;
            assert!(gap.abs() < 1e-9);
        }
        if let (Some(ours), Some(theirs)) = (ours, theirs) {
            assert!((ours.time_of_impact - theirs.time_of_impact).abs() < 1e-3);
            hits += 1;
        }
    }
    assert!(hits > 1000, "{hits}");
}

/// Pairs this dispatcher does not know are left to the next one.
#[test]
fn other_pairs_are_unsupported() {
    let (wheel, ball, cuboid) = (
        iso_wheel(9),
        Ball::new(0.1),
        Cuboid::new(Vector::splat(0.1)),
    );
    let at = Pose::translation(1.0, 0.0);
    assert!(RollerDispatcher.distance(&at, &ball, &cuboid).is_err());
    assert!(RollerDispatcher.distance(&at, &wheel, &cuboid).is_err());
    assert!(RollerDispatcher.distance(&at, &wheel, &wheel).is_err());
    assert!(DefaultQueryDispatcher.distance(&at, &wheel, &ball).is_err());
    let chained = RollerDispatcher.chain(DefaultQueryDispatcher);
    assert!(chained.distance(&at, &ball, &cuboid).is_ok());
    assert!(chained.distance(&at, &wheel, &ball).is_ok());
}

/// Only equal positive factors keep arcs circular.
#[test]
fn scaling_keeps_arcs_or_refuses() {
    let wheel = iso_wheel(9);
    let twice = wheel.scale_dyn(Vector::splat(2.0), 0).unwrap();
    let aabb = twice.compute_local_aabb();
    assert!((aabb.maxs.x - 2.0 * wheel.compute_local_aabb().maxs.x).abs() < 1e-12);
    assert!(wheel.scale_dyn(Vector::new(1.0, 2.0), 0).is_none());
    assert!(wheel.scale_dyn(Vector::splat(-1.0), 0).is_none());
}
