//! Waves that engagement sends into a span.

use std::f64::consts::PI;

/// Mean power \[W\] of the waves across a span that one of its ends gets from a sprocket of `teeth`, under a tension T \[N\], of a chain of mass m′
/// \[kg/m\] at speed v \[m/s\]; zero where the span does not pull.
///
/// ```text
/// P = √(T m′) (π v/z)²/3
/// ```
///
/// The polygon moves the end of the span to and fro across it, within a tooth from −π v/z to +π v/z at a constant rate: (π v/z)²/3 is the mean square. A
/// string that is moved across at one end answers with its impedance √(T m′). What arrives at the other end is lost there and on the way, most of it
/// by friction of joints, that turn to and fro with the waves; it comes on top of what they lose by wrapping.
///
/// # Range
/// Waves that do not come back in step: no resonance of the span with the mesh.
pub fn engagement_wave(teeth: u32, tension: f64, mass_per_length: f64, speed: f64) -> f64 {
    // P = √(T m′) (π v/z)²/3
    let across = PI * speed / f64::from(teeth);
    (tension.max(0.0) * mass_per_length).sqrt() * across * across / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Impedance times the square of the velocity, averaged over a tooth by many points.
    #[test]
    fn it_is_the_mean_of_what_the_end_of_a_string_gives() {
        let (teeth, tension, mass, speed) = (19_u32, 6480.0, 2.7, 2.413);
        let impedance = f64::sqrt(tension * mass);
        let pitch_angle = 2.0 * PI / f64::from(teeth);
        let points = 100_000;
        let square = |i: i32| {
            let from_middle = (f64::from(i) + 0.5) / f64::from(points) - 0.5;
            // Along the chord the roller moves across by v times its angle off the middle.
            (speed * pitch_angle * from_middle).powi(2)
        };
        let mean = (0..points).map(square).sum::<f64>() / f64::from(points);
        let found = engagement_wave(teeth, tension, mass, speed);
        assert!((found / (impedance * mean) - 1.0).abs() < 1e-9, "{found}");
        assert!(engagement_wave(teeth, -1.0, mass, speed).abs() < f64::MIN_POSITIVE);
    }
}
