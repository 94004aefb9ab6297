//! What acts from outside on a shaft or at a point, over time or over the angle of a shaft.

use std::f64::consts::TAU;

use crate::DriveError;
use crate::order::Order;
use crate::table::Table;

/// A torque \[N m\] or a force \[N\] that follows time, or the angle of a shaft.
///
/// # Example
///
/// A force of 20 N that swings by 8 N four times a turn:
///
/// ```
/// use std::f64::consts::FRAC_PI_8;
///
/// use chaindrive_mechanics::{Action, Order};
///
/// let swing = Order { order: 4.0, amplitude: 8.0, phase: 0.0 };
/// let acting = [Action::Constant { value: 20.0 }, Action::Orders { of: None, terms: vec![swing] }];
/// let (time, angle) = (0.0, FRAC_PI_8);
/// let force: f64 = acting.iter().map(|it| it.at(time, angle)).sum();
/// // 20 N + 8 N sin(4 π/8)
/// assert!((force - 28.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A = A₀.
    Constant {
        /// Value A₀ \[N m or N\].
        value: f64,
    },
    /// A = Σ Aᵢ sin(nᵢ θ + φᵢ), such as the torque of cams or the pull of a pump, by orders of a shaft.
    Orders {
        /// The shaft that θ belongs to, by index; none: the one acted on, or that of the sprocket acted on.
        of: Option<usize>,
        /// The orders.
        terms: Vec<Order>,
    },
    /// Straight lines between points over time or an angle: it never overshoots its table.
    /// Beyond the ends the value of the nearest end holds.
    Table {
        /// The argument of the curve.
        over: Argument,
        /// Value \[N m or N\] against the argument \[s or rad\].
        curve: Table,
    },
    /// A = A₀ (3 s² − 2 s³), s = (t − start)/duration: switched on softly.
    Ramp {
        /// Final value A₀ \[N m or N\].
        value: f64,
        /// Begin \[s\].
        start: f64,
        /// Duration \[s\], positive.
        duration: f64,
    },
}

/// Variable of the table of an [`Action`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Time \[s\].
    Time,
    /// Angle \[rad\], taken within so many turns.
    Angle {
        /// The shaft that the angle belongs to, by index; none: the one acted on, or that of the sprocket acted on.
        of: Option<usize>,
        /// Turns after which the table repeats, at least one.
        turns: u32,
    },
}

impl Action {
    /// Value \[N m or N\] at time `t` \[s\] and angle \[rad\] of the shaft that it [follows](Self::follows).
    pub fn at(&self, t: f64, angle: f64) -> f64 {
        match self {
            Self::Constant { value } => *value,
            Self::Orders { terms, .. } => terms
                .iter()
                .map(|term| term.amplitude * (term.order * angle + term.phase).sin())
                .sum(),
            Self::Table { over, curve } => curve.polyline(match over {
                Argument::Time => t,
                Argument::Angle { turns, .. } => angle.rem_euclid(f64::from(*turns) * TAU),
            }),
            Self::Ramp {
                value,
                start,
                duration,
            } => {
                let s = ((t - start) / duration).clamp(0.0, 1.0);
                value * s * s * (3.0 - 2.0 * s)
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

    /// Whether it is another one at another angle.
    pub fn turns_with_an_angle(&self) -> bool {
        matches!(
            self,
            Self::Orders { .. }
                | Self::Table {
                    over: Argument::Angle { .. },
                    ..
                }
        )
    }

    /// Value \[N m or N\] in the mean over all angles, at time `t` \[s\].
    pub(crate) fn mean(&self, t: f64) -> f64 {
        match self {
            Self::Orders { .. } => 0.0,
            Self::Table {
                over: Argument::Angle { .. },
                curve,
            } => curve.polyline_mean(),
            _ => self.at(t, 0.0),
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

    /// Names the first parameter out of range; `key` is what scenes call the value, `torque` or `force`.
    ///
    /// # Errors
    /// [`DriveError::Parameter`] with `name` as the place.
    pub fn check(&self, name: &str, key: &str) -> Result<(), DriveError> {
        let finite = |key: &str, value: f64| DriveError::finite(name, key, value);
        match self {
            Self::Constant { value } => finite(key, *value),
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
                value,
                start,
                duration,
            } => {
                finite(key, *value)?;
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
        let action = Action::Orders {
            of: None,
            terms: vec![term(2.0, 0.5, 0.0), term(-3.0, 6.0, 0.4)],
        };
        for i in -20..20 {
            let angle = 0.37 * f64::from(i);
            // A = Σ Aᵢ sin(n θ + φ)
            let expected = 2.0 * (0.5 * angle).sin() - 3.0 * (6.0 * angle + 0.4).sin();
            assert!((action.at(1.0, angle) - expected).abs() < 1e-14);
        }
    }

    /// One point a half-turn: the table repeats after two turns and not after one.
    #[test]
    fn a_table_over_two_turns_has_a_period_of_four_pi() {
        let angles = (0..5).map(|i| PI * f64::from(i)).collect();
        let curve = Table::new(angles, vec![1.0, 5.0, -2.0, 0.0, 1.0]).unwrap();
        let over = |turns| Action::Table {
            over: Argument::Angle { of: None, turns },
            curve: curve.clone(),
        };
        let action = over(2);
        for (angle, expected) in [
            (0.0, 1.0),
            (0.5 * PI, 3.0),
            (2.5 * PI, -1.0),
            (3.5 * PI, 0.5),
        ] {
            for turns in [-2.0, 0.0, 2.0, 20.0] {
                let found = action.at(0.0, angle + turns * 2.0 * PI);
                assert!((found - expected).abs() < 1e-12, "{found} at {angle}");
            }
        }
        assert!((action.at(0.0, 2.5 * PI) - action.at(0.0, 0.5 * PI)).abs() > 1.0);
        assert!(over(1).check("load", "torque").is_ok());
        let problem = over(0).check("load", "torque").unwrap_err().to_string();
        assert!(problem.contains("load.turns"), "{problem}");
    }
}
