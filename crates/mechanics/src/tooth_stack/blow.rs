//! A blow without oil, friction or loss.

use chaindrive_contact::Law;

/// Greatest force of a mass \[kg\] that strikes at a speed \[m/s\] and loses nothing \[N\].
///
/// ```text
/// ½ m v² = ∫ F dδ
/// ```
pub fn dry_blow(law: &Law, mass: f64, speed: f64) -> f64 {
    // ½ m v²
    let energy = 0.5 * mass * speed * speed;
    // From a depth that is enough down to the rounding of a length.
    let (mut low, mut high) = (0.0, 1e-6);
    while law.energy(high) < energy {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if law.energy(middle) < energy {
            low = middle;
        } else {
            high = middle;
        }
    }
    law.elastic_force(high)
}
