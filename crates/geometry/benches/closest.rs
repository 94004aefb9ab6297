//! One roller against a tooth outline, a rail and splines of up to 1000 pieces.

#[path = "../tests/it/shapes/mod.rs"]
mod shapes;

use std::hint::black_box;

use chaindrive_geometry::{ArcSpline, Point, Vector};
use criterion::{Criterion, criterion_group, criterion_main};
use shapes::Dice;

/// Roller radius and how far beyond it contacts are looked for \[m\].
const REACH: f64 = 7.94e-3 + 0.5e-3;

/// Roller centres about a radius away from the curve, as in a running drive.
fn rollers(curve: &ArcSpline) -> Vec<Point> {
    let mut dice = Dice::new(5);
    (0..1024)
        .map(|_| {
            let on = curve.point_at(dice.next() * curve.length());
            let off = Vector::new(dice.next() - 0.5, dice.next() - 0.5);
            on + off * (2.0 * REACH)
        })
        .collect()
}

fn closest(criterion: &mut Criterion) {
    for (name, curve) in [
        ("tooth gap, 5 pieces", shapes::iso_gap_centred_on_pitch()),
        ("wheel, 95 pieces", shapes::iso_wheel(19)),
        ("rail, 14 pieces", shapes::rounded_rail(11)),
        ("spline, 10 pieces", shapes::long_spline(10)),
        ("spline, 100 pieces", shapes::long_spline(100)),
        ("spline, 1000 pieces", shapes::long_spline(1000)),
    ] {
        let rollers = rollers(&curve);
        let mut group = criterion.benchmark_group(name);
        let mut next = rollers.iter().cycle();
        let mut roller = || *next.next().expect("a cycle has no end");
        group.bench_function("nearest", |b| {
            b.iter(|| curve.nearest(black_box(roller()), REACH));
        });
        let mut found = Vec::new();
        group.bench_function("local minima", |b| {
            b.iter(|| {
                curve.local_minima(black_box(roller()), REACH, &mut found);
                found.len()
            });
        });
        group.bench_function("nearest by exhaustion", |b| {
            b.iter(|| curve.nearest_by_exhaustion(black_box(roller()), REACH));
        });
        group.finish();
    }
}

criterion_group!(benches, closest);
criterion_main!(benches);
