//! Stiffness of a contact that is pressed.

use chaindrive_contact::Law;

use crate::scene::schema::Route;

/// Indentation \[m\] at which a contact counts as pressed, where no pretension says how far.
pub(super) const PRESSED: f64 = 1e-6;

/// Stiffness \[N/m\] of a joint that bears the pretension, or next to nothing where there is none.
pub(super) fn stiffness_under_pretension(law: &Law, route: Option<&Route>, radius: f64) -> f64 {
    let pretension = route.map_or(0.0, |route| route.pretension.0);
    law.stiffness(indentation(law, pretension, radius).max(PRESSED))
}

/// Indentation \[m\] at which a law reaches a force \[N\], at most `most`.
fn indentation(law: &Law, force: f64, most: f64) -> f64 {
    let (mut low, mut high) = (0.0, most);
    // Down to the rounding of a length.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if law.elastic_force(middle) < force {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
