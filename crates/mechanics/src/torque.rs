//! Shaft torques as functions of time, angle and speed.

use std::f64::consts::TAU;

use crate::DriveError;
use crate::motion::Table;

/// A torque on a free sprocket \[N m\], counter-clockwise positive; several add up.
#[derive(Clone, Debug, PartialEq)]
pub enum Torque {
    /// M = M₀.
    Constant {
        /// Torque M₀ \[N m\].
        torque: f64,
    },
    /// M = −c₁ ω − c₂ ω |ω|: a resistance that always opposes the rotation.
    Resistance {
        /// Linear coefficient c₁ \[N m s\], not negative.
        linear: f64,
        /// Quadratic coefficient c₂ \[N m s²\], not negative.
        quadratic: f64,
    },
    /// M = A sin(n θ + φ), a cam or gas torque of order n.
    Harmonic {
        /// Amplitude A \[N m\].
        amplitude: f64,
        /// Order n \[per turn\].
        order: f64,
        /// Phase φ \[rad\].
        phase: f64,
    },
    /// Straight lines between points over time, angle or speed: a torque never overshoots its table.
    /// Beyond the ends the torque of the nearest end holds.
    Table {
        /// The argument of the curve.
        over: Argument,
        /// Torque \[N m\] against the argument \[s, rad or rad/s\].
        curve: Table,
    },
    /// M = M₀ (3 s² − 2 s³), s = (t − start)/duration: a torque switched on softly.
    Ramp {
        /// Final torque M₀ \[N m\].
        torque: f64,
        /// Begin \[s\].
        start: f64,
        /// Duration \[s\], positive.
        duration: f64,
    },
}

/// What a torque table runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Time \[s\].
    Time,
    /// Angle \[rad\], taken within one turn.
    Angle,
    /// Speed \[rad/s\].
    Speed,
}

impl Torque {
    /// Torque \[N m\] at time `t` \[s\], angle \[rad\] and speed \[rad/s\].
    pub fn at(&self, t: f64, angle: f64, speed: f64) -> f64 {
        match self {
            Self::Constant { torque } => *torque,
            Self::Resistance { linear, quadratic } => -speed * (linear + quadratic * speed.abs()),
            Self::Harmonic {
                amplitude,
                order,
                phase,
            } => amplitude * (order * angle + phase).sin(),
            Self::Table { over, curve } => {
                let argument = match over {
                    Argument::Time => t,
                    Argument::Angle => angle.rem_euclid(TAU),
                    Argument::Speed => speed,
                };
                curve.polyline(argument)
            }
            Self::Ramp {
                torque,
                start,
                duration,
            } => {
                let s = ((t - start) / duration).clamp(0.0, 1.0);
                torque * s * s * (3.0 - 2.0 * s)
            }
        }
    }

    /// Time \[s\] of the first kink of a table over time after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        match self {
            Self::Table {
                over: Argument::Time,
                curve,
            } => curve.next_knot(t),
            _ => None,
        }
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
        let finite = |what: &str, value: f64| {
            DriveError::require(
                value.is_finite(),
                &format!("{name}.{what}"),
                value,
                "finite",
            )
        };
        let not_negative = |what: &str, value: f64| {
            DriveError::require(
                value >= 0.0 && value.is_finite(),
                &format!("{name}.{what}"),
                value,
                "not negative",
            )
        };
        match self {
            Self::Constant { torque } => finite("torque", *torque),
            Self::Resistance { linear, quadratic } => {
                not_negative("linear", *linear)?;
                not_negative("quadratic", *quadratic)
            }
            Self::Harmonic {
                amplitude,
                order,
                phase,
            } => {
                finite("amplitude", *amplitude)?;
                finite("order", *order)?;
                finite("phase", *phase)
            }
            Self::Table { .. } => Ok(()),
            Self::Ramp {
                torque,
                start,
                duration,
            } => {
                finite("torque", *torque)?;
                finite("start", *start)?;
                DriveError::require(
                    *duration > 0.0 && duration.is_finite(),
                    &format!("{name}.duration"),
                    *duration,
                    "positive [s]",
                )
            }
        }
    }
}
