//! The rim of a sprocket.

use std::f64::consts::PI;

/// Compliance of the steel below a tooth gap \[m/N\], from where the law of the contact ends down to the bore or the inner edge of a rim.
///
/// ```text
/// δ/F = 2/(π E L) ln(H/r),   zero for H ≤ r
/// ```
///
/// The field of a line load on a half-plane, σ = 2 F/(π L z) on the axis, between the depths r and H \[m\]: r is the radius of the
/// roller, to which the laws of cylinders count. L is the width of the teeth \[m\] and E the modulus \[Pa\]. Bending of a rim between spokes is not in it.
///
/// # Source
/// A. Flamant, *C. R. Acad. Sci.* **114**, 1892, 1465–1468; K. L. Johnson, *Contact Mechanics*, 1985, section 2.2, plane stress.
pub fn rim_compliance(depth: f64, radius: f64, width: f64, modulus: f64) -> f64 {
    // δ/F = 2/(π E L) ln(H/r)
    2.0 / (PI * modulus * width) * (depth / radius).ln().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The strain σ/E below a line load, σ = 2 F/(π L z), summed from r to H.
    #[test]
    fn the_field_below_a_line_load_sums_up() {
        let (radius, depth, width, modulus) = (27e-3, 90e-3, 50e-3, 207e9);
        let steps = 10_000;
        let dz = (depth - radius) / f64::from(steps);
        let strain = |i: i32| {
            let z = radius + (f64::from(i) + 0.5) * dz;
            2.0 / (PI * width * z * modulus)
        };
        let sum: f64 = (0..steps).map(|i| strain(i) * dz).sum();
        let found = rim_compliance(depth, radius, width, modulus);
        assert!((found / sum - 1.0).abs() < 1e-7, "{found} {sum}");
        assert!(rim_compliance(20e-3, radius, width, modulus) <= 0.0);
    }
}
