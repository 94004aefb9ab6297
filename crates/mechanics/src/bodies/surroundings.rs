//! What a chain sees of the rest of its drive.

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
    /// How the velocities of the chain were predicted, if they were.
    pub(crate) prediction: Option<Prediction<'a>>,
}
