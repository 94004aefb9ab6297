//! What repeats: orders of the turns of a shaft, and frequencies.

use serde::{Deserialize, Serialize};

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
    /// Whether it swings at all.
    pub(crate) fn acts(&self) -> bool {
        self.amplitude != 0.0 && self.order != 0.0
    }

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

/// Something that repeats: a tooth that passes, an order of a shaft or of its torque, a term of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Forcing {
    /// Shaft whose turns it follows; none where it follows time, as it does where a motion turns the shaft.
    pub shaft: Option<usize>,
    /// Phase for each radian that the shaft turns \[–\], or for each second \[rad/s\].
    pub rate: f64,
    /// Period at the mean speed \[s\].
    pub period: f64,
}
