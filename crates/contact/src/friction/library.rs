//! Friction laws of other programs.

use std::fmt::Debug;

use chaindrive_quantities::{JsonSchema, Library, RegistrationError, takes_registered};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Friction;
use crate::ParameterError;

/// Functions of a friction law without a state, for a law that a program [registers](register).
///
/// Above each field of its struct stand quantity and range, as with own members. Kernels ask it one contact at a time.
pub trait FrictionLaw: Debug + Send + Sync + 'static {
    /// Tangential force \[N\] under the normal force \[N\] at the slip velocity \[m/s\]; opposes the slip, zero at rest.
    fn force(&self, normal: f64, slip: f64) -> f64;

    /// Damping −∂f/∂v \[N s/m\] at the same arguments, zero where the force falls with the slip; finite at rest.
    fn damping(&self, normal: f64, slip: f64) -> f64;

    /// Refuses parameters that do not go together; each by itself is held to the range above its field.
    ///
    /// # Errors
    /// Names the first of them.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

/// The registered friction laws.
static LIBRARY: Library<dyn FrictionLaw> = Library::new(
    "friction",
    || schemars::schema_for!(Friction),
    FrictionLaw::check,
);

/// The registered friction laws.
pub fn library() -> &'static Library<dyn FrictionLaw> {
    &LIBRARY
}

/// Adds a friction law of a program to the family, before the first scene. A scene names it as its `kind`; whoever changes its numbers
/// gives it another revision.
///
/// # Errors
/// A name that is none or is taken, a type without keys, and any after the first scene.
pub fn register<T: FrictionLaw + Serialize + DeserializeOwned + JsonSchema>(
    name: &'static str,
    revision: u32,
) -> Result<(), RegistrationError> {
    LIBRARY.enter::<T>(name, revision, |law| Box::new(law))
}

takes_registered! {
    Friction: LIBRARY;
}
