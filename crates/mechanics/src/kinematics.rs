//! Places with their rates.

use serde::{Deserialize, Serialize};

/// Position, rate and acceleration of a coordinate at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Kinematics {
    /// Position x \[m or rad\].
    pub position: f64,
    /// Rate ẋ \[m/s or rad/s\].
    pub rate: f64,
    /// Acceleration ẍ \[m/s² or rad/s²\].
    pub acceleration: f64,
}
