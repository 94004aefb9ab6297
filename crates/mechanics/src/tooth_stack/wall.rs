//! Walls of rollers and bushes.

/// Width of the column over the inner radius of its wall. *Assumed*: an arc of 60° bears; a pin of 56B in its bush bears on 80° at a tenth of the
/// breaking load, so the column is rather too narrow.
const WIDTH: f64 = 1.0;

/// Compliance of a wall that is pressed between two lines of contact, opposite to each other on its outside and inside \[m/N\].
///
/// ```text
/// δ/F = (r_o − r_i)/(E L r_i)
/// ```
///
/// A radial column as wide as the inner radius r_i; L is the length \[m\], E the modulus \[Pa\]. The force goes straight through, so that the ring does
/// not become oval. It is small beside the contacts, which count the field near the surfaces themselves.
pub fn wall_compliance([outer, inner]: [f64; 2], length: f64, modulus: f64) -> f64 {
    // δ/F = (r_o − r_i)/(E L r_i)
    (outer - inner) / (modulus * length * WIDTH * inner)
}
