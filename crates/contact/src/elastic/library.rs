//! Elastic laws of other programs.

use chaindrive_quantities::{Handle, JsonSchema, Library, RegistrationError, takes_registered};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Elastic, ElasticLaw, Member, Specification};

/// The registered elastic laws.
static LIBRARY: Library<dyn ElasticLaw> = Library::new(
    "elastic law",
    || schemars::schema_for!(Specification),
    ElasticLaw::check,
);

/// The registered elastic laws.
pub fn library() -> &'static Library<dyn ElasticLaw> {
    &LIBRARY
}

/// Adds an elastic law of a program to the family, before the first scene. A scene names it as its `kind`; whoever changes its numbers
/// gives it another revision.
///
/// # Errors
/// A name that is none or is taken, a type without keys, and any after the first scene.
pub fn register<T: ElasticLaw + Serialize + DeserializeOwned + JsonSchema>(
    name: &'static str,
    revision: u32,
) -> Result<(), RegistrationError> {
    LIBRARY.enter::<T>(name, revision, |law| Box::new(law))
}

takes_registered! {
    Elastic: LIBRARY;
    Specification: LIBRARY;
}

impl From<Handle<dyn ElasticLaw>> for Elastic {
    fn from(law: Handle<dyn ElasticLaw>) -> Self {
        Self::Registered(law)
    }
}

impl Member for Handle<dyn ElasticLaw> {}
