//! The accuracy that method and step are chosen to keep, and how well they keep it.

use serde::{Deserialize, Serialize};

use crate::scene::Quantity;

/// Share of the energy moved below which losses are not told from none: 0.01 points of efficiency, finer than any is measured.
/// *Assumed*.
pub(crate) const LEAST_LOSSES: f64 = 1e-4;

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

/// Quantity that is kept within the accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Promise {
    /// The tension of the tight span, or of the tightest link where [`Choice::gap`](super::Choice::gap) leaves a span without a
    /// tension, at every moment of the window, root mean square.
    Waveform,
    /// Mean and root mean square of the tension of every span or link, or no more than chance makes of them: the
    /// run goes on beyond its chaos horizon.
    Statistics,
    /// The energy lost, as it is without what chance makes of it, and what is unaccounted for beside it.
    Losses,
    /// Median and 99th percentile of the forces of impacts and median of their impulses, on the sprocket that differs most, or no more than
    /// chance makes of them.
    Impacts,
    /// Nothing: the chain carries no tension that could be compared, loses nothing, or strikes nothing.
    Nothing,
}

impl Promise {
    /// Quantity of the accuracy behind the promise.
    pub(crate) fn quantity(self) -> Quantity {
        match self {
            Self::Waveform | Self::Statistics | Self::Nothing => Quantity::Tension,
            Self::Losses => Quantity::Losses,
            Self::Impacts => Quantity::Impacts,
        }
    }
}
