//! Spring and damper behind a tensioner.

use super::{PushForce, Pushes};
use crate::DriveError;

/// A preloaded spring with a damper.
///
/// ```text
/// F = F₀ − k x − c ẋ
/// ```
///
/// x is the extension since assembly: the push weakens as the tensioner moves outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Push at x = 0, F₀ \[N or N m\].
    pub preload: f64,
    /// Rate k \[N/m or N m/rad\], not negative.
    pub stiffness: f64,
    /// Damping c \[N s/m or N m s\], not negative.
    pub damping: f64,
}

impl Pushes for Spring {
    fn force(&self, x: f64, rate: f64, _: f64) -> PushForce {
        PushForce {
            elastic: self.preload - self.stiffness * x,
            damping: -self.damping * rate,
            ..PushForce::default()
        }
    }

    fn energy(&self, x: f64, _: f64) -> f64 {
        // U = ½ k x² − F₀ x
        (0.5 * self.stiffness * x - self.preload) * x
    }

    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn damping(&self) -> f64 {
        self.damping
    }

    fn check(&self, path: &str) -> Result<(), DriveError> {
        let range = |name: &str, value: f64, low: f64, allowed| {
            DriveError::require(
                value.is_finite() && value >= low,
                &format!("{path}.{name}"),
                value,
                allowed,
            )
        };
        range("preload", self.preload, f64::MIN, "finite [N]")?;
        range("stiffness", self.stiffness, 0.0, "not negative [N/m]")?;
        range("damping", self.damping, 0.0, "not negative [N s/m]")
    }
}
