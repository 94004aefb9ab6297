//! Pushes of other programs.

use chaindrive_quantities::{JsonSchema, Library, RegistrationError, takes_registered};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Push, PushLaw};

/// The registered pushes.
static LIBRARY: Library<dyn PushLaw> =
    Library::new("push", || schemars::schema_for!(Push), PushLaw::check);

/// The registered pushes.
pub fn library() -> &'static Library<dyn PushLaw> {
    &LIBRARY
}

/// Adds a push of a program to the family, before the first scene. A scene names it as its `kind`; whoever changes its numbers
/// gives it another revision.
///
/// # Errors
/// A name that is none or is taken, a type without keys, and any after the first scene.
pub fn register<T: PushLaw + Serialize + DeserializeOwned + JsonSchema>(
    name: &'static str,
    revision: u32,
) -> Result<(), RegistrationError> {
    LIBRARY.enter::<T>(name, revision, |law| Box::new(law))
}

takes_registered! {
    Push: LIBRARY;
}
