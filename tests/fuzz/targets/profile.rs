//! Any points and radii make a rail whose nearest places are those of an exhaustive search, or are refused.
#![no_main]

use chaindrive_geometry::{Point, rail};

libfuzzer_sys::fuzz_target!(|numbers: (Vec<[f32; 3]>, [f32; 2])| {
    let (corners, [x, y]) = numbers;
    let points: Vec<Point> = corners
        .iter()
        .map(|[x, y, _]| Point::new(f64::from(*x), f64::from(*y)))
        .collect();
    // The two ends have none.
    let rounded = corners.get(1..corners.len().saturating_sub(1));
    let radii: Vec<f64> = rounded
        .unwrap_or_default()
        .iter()
        .map(|[_, _, r]| f64::from(*r))
        .collect();
    let Ok(outline) = rail(&points, &radii) else {
        return;
    };
    assert!(outline.length().is_finite());
    let from = Point::new(f64::from(x), f64::from(y));
    if !(from.x.is_finite() && from.y.is_finite()) {
        return;
    }
    let size = outline.length() + from.coords.norm();
    let [found, exact] = [
        outline.nearest(from, f64::INFINITY),
        outline.nearest_by_exhaustion(from, f64::INFINITY),
    ];
    match (found, exact) {
        (Some(found), Some(exact)) => {
            // Of places equally near, on two sides of a rail that crosses itself, either may be told: a wrong sign alone is
            // not seen here.
            let apart = (found.distance.abs() - exact.distance.abs()).abs();
            assert!(
                apart <= 1e-9 * size,
                "{} {}",
                found.distance,
                exact.distance
            );
        }
        (None, None) => {}
        other => panic!("{other:?}"),
    }
});
