//! Loads of a chain on the bodies that it touches.

use serde::{Deserialize, Serialize};

use super::moving::Way;
use crate::contact::{Frame, Touch, Wrench};

/// Loads of a chain on the bodies that it touches, by contact.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[expect(
    clippy::vec_box,
    reason = "what changes hands at every step is a pointer, not seven vectors"
)]
pub(crate) struct Loads {
    pub(crate) teeth: Vec<Box<Touch>>,
    /// Of rollers or plates.
    pub(crate) rails: Vec<Box<Touch>>,
    pub(crate) wheel_wrenches: Vec<Wrench>,
    pub(crate) rail_wrenches: Vec<Wrench>,
    /// Frames of the wheels, then of the rails.
    pub(crate) frames: Vec<Frame>,
    /// Derivatives of the frame origins by the tensioners that carry them, for chains that solve equations.
    pub(crate) ways: Vec<Option<Way>>,
}
