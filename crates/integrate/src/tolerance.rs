//! Allowed error of a step.

use serde::{Deserialize, Serialize};

/// Allowed error of a step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Tolerance {
    pub(crate) relative: f64,
    pub(crate) absolute: f64,
    pub(crate) absolute_rate: f64,
}

impl Tolerance {
    /// Error of a position, or of a first-order state, in units of its tolerance.
    #[inline]
    pub(crate) fn position(self, error: f64, before: f64, after: f64) -> f64 {
        error.abs() / (self.absolute + self.relative * before.abs().max(after.abs()))
    }

    /// Error of a velocity in units of its tolerance.
    #[inline]
    pub(crate) fn velocity(self, error: f64, before: f64, after: f64) -> f64 {
        error.abs() / (self.absolute_rate + self.relative * before.abs().max(after.abs()))
    }
}
