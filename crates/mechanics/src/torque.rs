//! Shaft torques as functions of time, angle and speed.

use std::f64::consts::TAU;

use crate::DriveError;
use crate::order::Order;
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
/// use chaindrive_mechanics::{Order, Torque};
///
/// let lobes = Order { order: 4.0, amplitude: 8.0, phase: 0.0 };
/// let cams = Torque::Orders { of: None, terms: vec![lobes] };
/// let oil = Torque::Resistance { linear: 0.02, quadratic: 0.0 };
/// let (angle, speed) = (FRAC_PI_8, 50.0);
/// let torque = cams.at(0.0, angle, speed) + oil.at(0.0, angle, speed);
/// // 8 N m sin(4 π/8) − 0.02 N m s · 50 rad/s
/// assert!((torque - 7.0).abs() < 1e-12);
/// ```
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
    /// M = Σ Aᵢ sin(nᵢ θ + φᵢ), such as the torque of cams or of gas, by orders of a shaft.
    Orders {
        /// The shaft that θ belongs to, by index; none: the one that the torque acts on.
        of: Option<usize>,
        /// The orders.
        terms: Vec<Order>,
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

/// Variable of a torque table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Time \[s\].
    Time,
    /// Angle \[rad\], taken within so many turns.
    Angle {
        /// The shaft that the angle belongs to, by index; none: the one that the torque acts on.
        of: Option<usize>,
        /// Turns after which the torque repeats, at least one.
        turns: u32,
    },
    /// Speed \[rad/s\].
    Speed,
}

impl Torque {
    /// Torque \[N m\] at time `t` \[s\], angle \[rad\] of the shaft that it [follows](Self::follows), and speed \[rad/s\] of the
    /// shaft that it acts on.
    pub fn at(&self, t: f64, angle: f64, speed: f64) -> f64 {
        match self {
            Self::Constant { torque } => *torque,
            Self::Resistance { linear, quadratic } => -speed * (linear + quadratic * speed.abs()),
            Self::Orders { terms, .. } => terms
                .iter()
                .map(|term| term.amplitude * (term.order * angle + term.phase).sin())
                .sum(),
            Self::Table { over, curve } => {
                let argument = match over {
                    Argument::Time => t,
                    Argument::Angle { turns, .. } => angle.rem_euclid(f64::from(*turns) * TAU),
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

    /// The shaft whose angle it depends on, by index; none where that is its own, or it depends on no angle.
    pub fn follows(&self) -> Option<usize> {
        match self {
            Self::Orders { of, .. }
            | Self::Table {
                over: Argument::Angle { of, .. },
                ..
            } => *of,
            _ => None,
        }
    }

    /// Torque \[N m\] in the mean over all angles, at time `t` \[s\] and a speed \[rad/s\].
    pub(crate) fn mean(&self, t: f64, speed: f64) -> f64 {
        match self {
            Self::Orders { .. } => 0.0,
            Self::Table {
                over: Argument::Angle { .. },
                curve,
            } => curve.polyline_mean(),
            _ => self.at(t, 0.0, speed),
        }
    }

    /// A torque that is another one at another angle.
    pub(crate) fn turns_with_an_angle(&self) -> bool {
        matches!(
            self,
            Self::Orders { .. }
                | Self::Table {
                    over: Argument::Angle { .. },
                    ..
                }
        )
    }

    /// Speeds \[rad/s\] at which a table over the speed has its points.
    pub(crate) fn speeds(&self) -> &[f64] {
        match self {
            Self::Table {
                over: Argument::Speed,
                curve,
            } => curve.arguments(),
            _ => &[],
        }
    }

    /// Puts another index in the place of that of the shaft it follows.
    pub(crate) fn refer(&mut self, place: impl FnOnce(usize) -> usize) {
        match self {
            Self::Orders { of, .. }
            | Self::Table {
                over: Argument::Angle { of, .. },
                ..
            } => *of = of.map(place),
            _ => {}
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
            Self::Orders { terms, .. } => terms.iter().try_for_each(|term| term.check(name)),
            Self::Table {
                over: Argument::Angle { turns, .. },
                ..
            } => DriveError::require(
                *turns > 0,
                &format!("{name}.turns"),
                f64::from(*turns),
                "at least 1",
            ),
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn orders_add_up() {
        let term = |amplitude, order, phase| Order {
            amplitude,
            order,
            phase,
        };
        let torque = Torque::Orders {
            of: None,
            terms: vec![term(2.0, 0.5, 0.0), term(-3.0, 6.0, 0.4)],
        };
        for i in -20..20 {
            let angle = 0.37 * f64::from(i);
            // M = Σ A sin(n θ + φ)
            let expected = 2.0 * (0.5 * angle).sin() - 3.0 * (6.0 * angle + 0.4).sin();
            assert!((torque.at(1.0, angle, -9.0) - expected).abs() < 1e-14);
        }
    }

    /// One point a half-turn: the table repeats after two turns and not after one.
    #[test]
    fn a_table_over_two_turns_has_a_period_of_four_pi() {
        let angles = (0..5).map(|i| PI * f64::from(i)).collect();
        let curve = Table::new(angles, vec![1.0, 5.0, -2.0, 0.0, 1.0]).unwrap();
        let over = |turns| Torque::Table {
            over: Argument::Angle { of: None, turns },
            curve: curve.clone(),
        };
        let torque = over(2);
        for (angle, expected) in [
            (0.0, 1.0),
            (0.5 * PI, 3.0),
            (2.5 * PI, -1.0),
            (3.5 * PI, 0.5),
        ] {
            for turns in [-2.0, 0.0, 2.0, 20.0] {
                let found = torque.at(0.0, angle + turns * 2.0 * PI, 0.0);
                assert!((found - expected).abs() < 1e-12, "{found} at {angle}");
            }
        }
        assert!((torque.at(0.0, 2.5 * PI, 0.0) - torque.at(0.0, 0.5 * PI, 0.0)).abs() > 1.0);
        assert!(over(1).check("load").is_ok());
        let problem = over(0).check("load").unwrap_err().to_string();
        assert!(problem.contains("load.turns"), "{problem}");
    }
}
