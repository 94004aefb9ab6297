//! The part of a chain between its joints.

use chaindrive_mechanics::ChainModel;

/// The part between the joints.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) masses: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    pub(super) model: ChainModel,
}
