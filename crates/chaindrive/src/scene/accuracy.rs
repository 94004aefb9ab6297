//! The quantity whose accuracy a scene asks for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Accuracy that a run has unless told otherwise \[–\].
pub const ACCURACY: f64 = 0.01;

/// The quantity that an accuracy is one of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// The tension of the tight span, or the statistics of all where the motion is chaotic.
    #[default]
    Tension,
    /// The energy lost, and with it the efficiency.
    Losses,
    /// The impacts of rollers that come to a sprocket: median and 99th percentile of their forces, median of their impulses.
    Impacts,
}

impl Quantity {
    /// Relative error \[–\] that a run may have unless told otherwise. *Assumed*: tensions are read off to a hundredth; a twentieth of the
    /// losses is 0.1 points of an efficiency of 98 %, and impacts scatter by more.
    pub fn usual_accuracy(self) -> f64 {
        match self {
            Self::Tension => ACCURACY,
            Self::Losses | Self::Impacts => 5.0 * ACCURACY,
        }
    }
}
