//! Periods that repeat with the turns of a shaft.

use crate::DriveError;

/// One order of a torque, A sin(n θ + φ), or of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Amplitude A \[N m, rad or m\].
    pub amplitude: f64,
    /// Order n, periods per turn \[–\].
    pub order: f64,
    /// Phase φ \[rad\].
    pub phase: f64,
}

impl Order {
    /// Names the first parameter that is not finite.
    ///
    /// # Errors
    /// [`DriveError::Parameter`] with `name` as the place.
    pub(crate) fn check(&self, name: &str) -> Result<(), DriveError> {
        for (what, value) in [
            ("amplitude", self.amplitude),
            ("order", self.order),
            ("phase", self.phase),
        ] {
            let place = format!("{name}.{what}");
            DriveError::require(value.is_finite(), &place, value, "finite")?;
        }
        Ok(())
    }
}
