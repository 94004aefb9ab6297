//! A dashpot beside the elastic law: Kelvin and Voigt's element.

use chaindrive_quantities::{Damping, JsonSchema};
use serde::{Deserialize, Serialize};

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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Viscous {
    /// Damping c \[N s/m\].
    #[schemars(with = "Damping", extend("minimum" = 0))]
    pub damping: f64,
}
