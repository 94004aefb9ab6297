//! Distances to arcs against parry's own polyline.

use crate::shapes;

use chaindrive_geometry::{Piece, Point};
use parry2d_f64::math::Vector;
use parry2d_f64::query::PointQuery;
use parry2d_f64::shape::Polyline;
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
