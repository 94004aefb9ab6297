//! A dashpot beside the elastic law: Kelvin and Voigt's element.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Viscous damping; with a linear elastic law the Kelvin–Voigt element.
///
/// ```text
/// F = max(0, g(δ) + c δ̇)   while δ > 0
/// ```
///
/// Needs no memory of the contact, and damps a resting contact as it should. Its
/// restitution depends on the speed unless g is linear, and its force jumps by c δ̇ when the contact begins.
///
/// # Source
/// W. Goldsmith, *Impact: The Theory and Physical Behaviour of Colliding Solids*, Edward Arnold, 1960.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viscous {
    /// Damping c \[N s/m\], not negative.
    pub damping: f64,
}

impl Viscous {
    /// Refuses a damping outside its range.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(self) -> Result<(), ParameterError> {
        require(
            self.damping >= 0.0 && self.damping.is_finite(),
            "damping",
            self.damping,
            "zero or positive [N s/m]",
        )
    }
}
