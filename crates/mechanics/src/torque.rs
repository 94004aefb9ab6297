//! Shaft torques as functions of time, angle and speed.

use crate::DriveError;
use crate::action::Action;
use crate::table::Table;

/// A torque on a free shaft \[N m\], counter-clockwise positive; several add up.
///
/// # Example
///
/// Four cams on a shaft, 8 N m each way four times a turn, and oil that resists with the speed:
///
/// ```
/// use std::f64::consts::FRAC_PI_8;
///
/// use chaindrive_mechanics::{Action, Order, Torque};
///
/// let lobes = Order { order: 4.0, amplitude: 8.0, phase: 0.0 };
/// let cams = Torque::Given(Action::Orders { of: None, terms: vec![lobes] });
/// let oil = Torque::Resistance { linear: 0.02, quadratic: 0.0 };
/// let (angle, speed) = (FRAC_PI_8, 50.0);
/// let torque = cams.at(0.0, angle, speed) + oil.at(0.0, angle, speed);
/// // 8 N m sin(4 π/8) − 0.02 N m s · 50 rad/s
/// assert!((torque - 7.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Torque {
    /// One that follows time or an angle, as forces do.
    Given(Action),
    /// M = −c₁ ω − c₂ ω |ω|: a resistance that always opposes the rotation.
    Resistance {
        /// Linear coefficient c₁ \[N m s\], not negative.
        linear: f64,
        /// Quadratic coefficient c₂ \[N m s²\], not negative.
        quadratic: f64,
    },
    /// Straight lines between points over the speed \[rad/s\] of the shaft: a torque \[N m\] never overshoots its table.
    /// Beyond the ends the torque of the nearest end holds.
    OverSpeed(Table),
}

impl From<Action> for Torque {
    fn from(action: Action) -> Self {
        Self::Given(action)
    }
}

impl Torque {
    /// Torque \[N m\] at time `t` \[s\], angle \[rad\] of the shaft that it [follows](Self::follows), and speed \[rad/s\] of the
    /// shaft that it acts on.
    pub fn at(&self, t: f64, angle: f64, speed: f64) -> f64 {
        match self {
            Self::Given(action) => action.at(t, angle),
            Self::Resistance { linear, quadratic } => -speed * (linear + quadratic * speed.abs()),
            Self::OverSpeed(curve) => curve.polyline(speed),
        }
    }

    /// What follows time or an angle; none of what follows the speed.
    pub(crate) fn action(&self) -> Option<&Action> {
        match self {
            Self::Given(action) => Some(action),
            Self::Resistance { .. } | Self::OverSpeed(_) => None,
        }
    }

    /// The shaft whose angle it depends on, by index; none where that is its own, or it depends on no angle.
    pub fn follows(&self) -> Option<usize> {
        self.action().and_then(Action::follows)
    }

    /// Torque \[N m\] in the mean over all angles, at time `t` \[s\] and a speed \[rad/s\].
    pub(crate) fn mean(&self, t: f64, speed: f64) -> f64 {
        match self {
            Self::Given(action) => action.mean(t),
            _ => self.at(t, 0.0, speed),
        }
    }

    /// A torque that is another one at another angle.
    pub(crate) fn turns_with_an_angle(&self) -> bool {
        self.action().is_some_and(Action::turns_with_an_angle)
    }

    /// Speeds \[rad/s\] at which a table over the speed has its points.
    pub(crate) fn speeds(&self) -> &[f64] {
        match self {
            Self::OverSpeed(curve) => curve.arguments(),
            _ => &[],
        }
    }

    /// Puts another index in the place of that of the shaft it follows.
    pub(crate) fn refer(&mut self, place: impl FnOnce(usize) -> usize) {
        if let Self::Given(action) = self {
            action.refer(place);
        }
    }

    /// Time \[s\] of the first kink of a table over time after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        self.action().and_then(|action| action.next_knot(t))
    }

    /// Linear resistance −∂M/∂ω at rest \[N m s\].
    pub(crate) fn drag(&self) -> f64 {
        match self {
            Self::Resistance { linear, .. } => *linear,
            _ => 0.0,
        }
    }

    /// Names the first parameter out of range.
    ///
    /// # Errors
    /// [`DriveError::Parameter`] with `name` as the place.
    pub fn check(&self, name: &str) -> Result<(), DriveError> {
        let not_negative = |what: &str, value: f64| {
            DriveError::require(
                value >= 0.0 && value.is_finite(),
                &format!("{name}.{what}"),
                value,
                "not negative",
            )
        };
        match self {
            Self::Given(action) => action.check(name, "torque"),
            Self::Resistance { linear, quadratic } => {
                not_negative("linear", *linear)?;
                not_negative("quadratic", *quadratic)
            }
            Self::OverSpeed(_) => Ok(()),
        }
    }
}
