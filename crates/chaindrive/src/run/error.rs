//! Why a request is refused.

use crate::SimulationError;
use crate::scene::SceneError;

/// Why there is nothing that could be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RequestError {
    /// The scene, or a text given for one of its settings, is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] SimulationError),
}
