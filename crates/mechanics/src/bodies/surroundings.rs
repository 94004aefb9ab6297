//! The rest of the drive, as a chain reads it.

use chaindrive_integrate::Prediction;

use super::{Bodies, BodyContacts};

/// Surroundings in which a chain is evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings<'a> {
    /// All bodies of the drive.
    pub(crate) bodies: &'a Bodies,
    /// First coordinate of the bodies of the chain's group.
    pub(crate) first: usize,
    /// The chain's contacts with them.
    pub(crate) contacts: &'a BodyContacts,
    /// Prediction of the velocities of the chain, if there is one.
    pub(crate) prediction: Option<Prediction<'a>>,
}
