//! Motions prescribed in time: a scalar position with its rate and acceleration.

use crate::DriveError;
use crate::course::Path;
use crate::kinematics::Kinematics;
use crate::order::Order;
use crate::speed_table::SpeedTable;
use crate::table::Table;

/// One sine term of a harmonic motion: A sin(2π f t + φ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Amplitude A \[m or rad\].
    pub amplitude: f64,
    /// Frequency f \[Hz\], not negative.
    pub frequency: f64,
    /// Phase φ at t = 0 \[rad\].
    pub phase: f64,
}

/// A coordinate as a function of time, counted from the assembled position.
///
/// Times are those of the record: x(0) = 0, and a drive that is assembled before t = 0 stands where the function has it then. What
/// repeats with the turns of a shaft counts them from where the drive was assembled, as torques over an angle do.
///
/// # Example
///
/// A crank at 100 rad/s whose speed ripples by ± 2 rad/s twice a turn:
///
/// ```
/// use std::f64::consts::{FRAC_PI_2, TAU};
///
/// use chaindrive_mechanics::{Harmonic, Motion};
///
/// let frequency = 2.0 * 100.0 / TAU;
/// let ripple = Harmonic { amplitude: 2.0 / (TAU * frequency), frequency, phase: -FRAC_PI_2 };
/// let crank = Motion::Harmonics { rate: 100.0, terms: vec![ripple] };
/// // A quarter of a period on, the sine has its greatest slope.
/// let fastest = crank.at(0.25 / frequency);
/// assert!((fastest.rate - 102.0).abs() < 1e-9);
/// assert!(fastest.acceleration.abs() < 1e-9);
/// assert_eq!(crank.at(0.0).position, 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// x = 0: held where it was assembled.
    Held,
    /// x = s t.
    Constant {
        /// Rate s \[m/s or rad/s\].
        rate: f64,
    },
    /// The rate goes from one value to another along a cubic, with no jump of acceleration
    /// at either end.
    Ramp {
        /// Rate before the ramp \[m/s or rad/s\].
        from: f64,
        /// Rate after the ramp \[m/s or rad/s\].
        to: f64,
        /// Time at which the ramp begins \[s\].
        start: f64,
        /// Duration of the ramp \[s\], positive.
        duration: f64,
    },
    /// x = s t + Σ Aᵢ (sin(2π fᵢ t + φᵢ) − sin φᵢ).
    Harmonics {
        /// Mean rate s \[m/s or rad/s\].
        rate: f64,
        /// The sine terms.
        terms: Vec<Harmonic>,
    },
    /// x = s τ + Σ Aᵢ (sin(nᵢ ω̄ τ + φᵢ) − sin φᵢ),   τ = t − t₀, ω̄ τ the angle of a shaft at its mean speed.
    Orders {
        /// Mean rate s \[m/s or rad/s\].
        rate: f64,
        /// Mean speed ω̄ of the shaft whose turns count \[rad/s\].
        turning: f64,
        /// The orders.
        terms: Vec<Order>,
        /// Time t₀ at which the drive is assembled \[s\].
        since: f64,
    },
    /// Positions at given times, joined by a natural cubic spline.
    Table(Table),
    /// Speeds at given times, joined by straight lines.
    SpeedTable(SpeedTable),
    /// On from a place and speed, on a course that somebody has set.
    Onward(Box<Path>),
    /// Another motion, counted from where it was when the drive was assembled: x = y(t) − y(t₀).
    From {
        /// Its position y(t₀) \[m or rad\].
        place: f64,
        /// The motion y.
        motion: Box<Motion>,
    },
}

impl Motion {
    /// The same motion for a drive that is assembled at a time t₀ \[s\] other than 0, and how far \[m or rad\] it has moved the drive by
    /// then from where it was drawn.
    pub(crate) fn from(&self, begin: f64) -> (Self, f64) {
        let mut again = self.clone();
        if let Self::Orders { since, .. } = &mut again {
            *since = begin;
            return (again, 0.0);
        }
        let place = self.at(begin).position;
        let motion = Box::new(again);
        (Self::From { place, motion }, place)
    }

    /// Rate \[m/s or rad/s\] about which sine terms swing; that at time `t` \[s\] of a motion without any.
    pub(crate) fn mean_rate(&self, t: f64) -> f64 {
        match self {
            Self::Harmonics { rate, .. } | Self::Orders { rate, .. } => *rate,
            Self::From { motion, .. } => motion.mean_rate(t),
            _ => self.at(t).rate,
        }
    }

    /// Position, rate and acceleration at time `t` \[s\].
    pub fn at(&self, t: f64) -> Kinematics {
        match self {
            Self::Held => Kinematics::default(),
            Self::Constant { rate } => Kinematics {
                position: rate * t,
                rate: *rate,
                acceleration: 0.0,
            },
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => ramp(*from, *to, *start, *duration, t),
            Self::Harmonics { rate, terms } => {
                let circular = |term: &Harmonic| std::f64::consts::TAU * term.frequency;
                let terms = terms
                    .iter()
                    .map(|it| [it.amplitude, circular(it), it.phase]);
                swinging(*rate, t, terms)
            }
            Self::Orders {
                rate,
                turning,
                terms,
                since,
            } => {
                let terms = terms.iter();
                let terms = terms.map(|it| [it.amplitude, it.order * turning, it.phase]);
                swinging(*rate, t - since, terms)
            }
            Self::Table(table) => table.at(t),
            Self::SpeedTable(table) => table.at(t),
            Self::Onward(path) => path.at(t),
            Self::From { place, motion } => {
                let there = motion.at(t);
                Kinematics {
                    position: there.position - place,
                    ..there
                }
            }
        }
    }

    /// Time \[s\] of the first knot of a table after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        match self {
            Self::Table(table) => table.next_knot(t),
            Self::SpeedTable(table) => table.next_knot(t),
            Self::From { motion, .. } => motion.next_knot(t),
            Self::Onward(path) => path.next_knot(t),
            _ => None,
        }
    }

    /// Names the first parameter that is not finite or out of range.
    ///
    /// # Errors
    /// [`DriveError::Parameter`] with `name` as the place.
    pub fn check(&self, name: &str) -> Result<(), DriveError> {
        let finite = |key: &str, value: f64| DriveError::finite(name, key, value);
        match self {
            // Courses are checked where they are set.
            Self::Held | Self::Table(_) | Self::SpeedTable(_) | Self::Onward(_) => Ok(()),
            Self::Constant { rate } => finite("rate", *rate),
            Self::From { place, motion } => {
                finite("place", *place)?;
                motion.check(name)
            }
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => {
                finite("from", *from)?;
                finite("to", *to)?;
                finite("start", *start)?;
                DriveError::require(
                    *duration > 0.0 && duration.is_finite(),
                    &format!("{name}.duration"),
                    *duration,
                    "positive [s]",
                )
            }
            Self::Orders {
                rate,
                turning,
                terms,
                since,
            } => {
                finite("rate", *rate)?;
                finite("turning", *turning)?;
                finite("since", *since)?;
                terms.iter().try_for_each(|term| term.check(name))
            }
            Self::Harmonics { rate, terms } => {
                finite("rate", *rate)?;
                terms.iter().try_for_each(|term| {
                    finite("amplitude", term.amplitude)?;
                    finite("phase", term.phase)?;
                    DriveError::require(
                        term.frequency >= 0.0 && term.frequency.is_finite(),
                        &format!("{name}.frequency"),
                        term.frequency,
                        "not negative [Hz]",
                    )
                })
            }
        }
    }
}

/// A mean rate with sine terms: amplitude, circular frequency and phase of each.
fn swinging(rate: f64, t: f64, terms: impl Iterator<Item = [f64; 3]>) -> Kinematics {
    let mean = Kinematics {
        position: rate * t,
        rate,
        acceleration: 0.0,
    };
    terms.fold(mean, |sum, [amplitude, circular, phase]| {
        // x = A (sin(Ω t + φ) − sin φ)
        let (sine, cosine) = (circular * t + phase).sin_cos();
        Kinematics {
            position: sum.position + amplitude * (sine - phase.sin()),
            rate: sum.rate + amplitude * circular * cosine,
            acceleration: sum.acceleration - amplitude * circular * circular * sine,
        }
    })
}

fn ramp(from: f64, to: f64, start: f64, duration: f64, t: f64) -> Kinematics {
    let change = to - from;
    let s = ((t - start) / duration).clamp(0.0, 1.0);
    let after = (t - start - duration).max(0.0);
    // ẋ = from + Δ (3 s² − 2 s³),  s = (t − start) / duration
    Kinematics {
        position: from * t + change * (duration * (s * s * s - 0.5 * s.powi(4)) + after)
            - offset_before_zero(change, start, duration),
        rate: from + change * s * s * (3.0 - 2.0 * s),
        acceleration: if s > 0.0 && s < 1.0 {
            change * 6.0 * s * (1.0 - s) / duration
        } else {
            0.0
        },
    }
}

/// Value of the ramp's integral at t = 0, so that x(0) = 0 also for ramps that began earlier.
fn offset_before_zero(change: f64, start: f64, duration: f64) -> f64 {
    let s = (-start / duration).clamp(0.0, 1.0);
    let after = (-start - duration).max(0.0);
    change * (duration * (s * s * s - 0.5 * s.powi(4)) + after)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motions() -> Vec<Motion> {
        let times: Vec<f64> = (0..9).map(|i| 0.1 * f64::from(i)).collect();
        let values = times.iter().map(|t| (3.0 * t).sin()).collect();
        vec![
            Motion::Constant { rate: -13.3 },
            Motion::Ramp {
                from: 1.0,
                to: -4.0,
                start: 0.2,
                duration: 0.5,
            },
            Motion::Ramp {
                from: 0.0,
                to: 4.0,
                start: -0.2,
                duration: 0.5,
            },
            Motion::Harmonics {
                rate: 2.0,
                terms: vec![Harmonic {
                    amplitude: 0.01,
                    frequency: 7.0,
                    phase: 0.4,
                }],
            },
            Motion::Orders {
                rate: -2.0,
                turning: -4.0,
                terms: vec![Order {
                    amplitude: 0.01,
                    order: 1.5,
                    phase: 0.4,
                }],
                since: 0.0,
            },
            Motion::Table(Table::new(times, values).unwrap()),
        ]
    }

    #[test]
    fn rate_and_acceleration_are_derivatives_and_motion_starts_at_zero() {
        let h = 1e-5;
        for motion in motions() {
            assert!(motion.at(0.0).position.abs() < 1e-15, "{motion:?}");
            for i in 1..40 {
                let t = 0.0173 * f64::from(i);
                let (before, now, after) = (motion.at(t - h), motion.at(t), motion.at(t + h));
                let rate = (after.position - before.position) / (2.0 * h);
                let acceleration = (after.rate - before.rate) / (2.0 * h);
                assert!((rate - now.rate).abs() < 1e-6, "{motion:?} at {t}");
                assert!(
                    (acceleration - now.acceleration).abs() < 1e-3,
                    "{motion:?} at {t}"
                );
            }
        }
    }

    #[test]
    fn spline_reproduces_a_straight_line() {
        let table = Table::new(vec![0.0, 0.3, 1.0], vec![1.0, 1.6, 3.0]).unwrap();
        let kinematics = table.value(0.77);
        assert!((kinematics.position - 2.54).abs() < 1e-14);
        assert!(kinematics.acceleration.abs() < 1e-13);
    }

    #[test]
    fn polyline_neither_overshoots_nor_leaves_its_ends() {
        let table = Table::new(vec![0.0, 1.0, 1.5, 4.0], vec![0.0, 1.0, 0.0, 0.0]).unwrap();
        for (t, x) in [
            (-1.0, 0.0),
            (0.25, 0.25),
            (1.25, 0.5),
            (2.0, 0.0),
            (9.0, 0.0),
        ] {
            assert!((table.polyline(t) - x).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn a_table_that_goes_back_in_time_is_refused() {
        let problem = Table::new(vec![0.0, 1.0, 0.5], vec![0.0; 3]).unwrap_err();
        assert!(problem.to_string().contains("entry 2"));
    }
}
