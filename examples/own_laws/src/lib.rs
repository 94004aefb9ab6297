//! Laws of your own in scenes of chaindrive.
//!
//! | law | stands in a scene as |
//! |---|---|
//! | [`Stribeck`] | `friction = { kind = "stribeck-speed", … }` of a contact |
//! | [`Winkler`] | `law = { kind = "winkler", … }` of a contact |
//! | [`GasSpring`] | `push = { kind = "gas-spring", … }` of a tensioner |

mod gas_spring;
mod stribeck;
mod winkler;

pub use gas_spring::GasSpring;
pub use stribeck::Stribeck;
pub use winkler::Winkler;

use chaindrive::laws::quantities::RegistrationError;
use chaindrive::laws::{elastic, friction, pushes};

/// Makes the laws known, before the first scene is read.
///
/// # Errors
/// When a law is registered twice, or too late.
pub fn register() -> Result<(), RegistrationError> {
    friction::register::<Stribeck>("stribeck-speed", 1)?;
    elastic::register::<Winkler>("winkler", 1)?;
    pushes::register::<GasSpring>("gas-spring", 1)
}
