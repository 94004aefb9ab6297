//! The quickest mode of a part of a drive.

use serde::{Deserialize, Serialize};

/// ω² and damping rates of the stiffest mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rates {
    /// ω² \[1/s²\].
    pub(crate) squared: f64,
    /// D \[1/s\].
    pub(crate) damping: f64,
    /// D without the damping that is taken at the end of a step whose velocities are predicted.
    pub(crate) predicted: f64,
    /// ω² of what limits steps of one solution, those springs left out that are taken at their end \[1/s²\].
    pub(crate) carried: f64,
}

impl Rates {
    /// Of a mode whose damping is taken where it is asked for.
    pub(crate) fn of([squared, damping]: [f64; 2]) -> Self {
        Self {
            squared,
            damping,
            predicted: damping,
            carried: squared,
        }
    }

    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            squared: self.squared.max(other.squared),
            damping: self.damping.max(other.damping),
            predicted: self.predicted.max(other.predicted),
            carried: self.carried.max(other.carried),
        }
    }
}
