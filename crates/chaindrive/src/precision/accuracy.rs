//! The accuracy that method and step are chosen to keep, and how well they keep it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ACCURACY;

/// Share of the energy moved below which losses are not told from none: 0.01 points of efficiency, finer than any is measured.
/// *Assumed*.
pub(crate) const LEAST_LOSSES: f64 = 1e-4;

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

/// An accuracy that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Relative error \[–\].
    pub value: f64,
    /// Of what.
    pub of: Quantity,
}

impl From<f64> for Accuracy {
    fn from(value: f64) -> Self {
        let of = Quantity::default();
        Self { value, of }
    }
}

impl From<(f64, Quantity)> for Accuracy {
    fn from((value, of): (f64, Quantity)) -> Self {
        Self { value, of }
    }
}
