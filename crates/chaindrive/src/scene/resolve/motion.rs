//! Prescribed motions and torques.

use std::f64::consts::TAU;

use chaindrive_mechanics::{Argument, DriveError, Harmonic, Motion, Table, Torque};

use super::Findings;
use crate::scene::quantity::{Angle, AngularSpeed, Length, Speed};
use crate::scene::schema;

/// A displacement.
pub(super) fn shift(
    text: &schema::Motion<Length, Speed>,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Motion> {
    resolve(text, |length| length.0, |speed| speed.0, path, findings)
}

/// A rotation.
pub(super) fn turn(
    text: &schema::Motion<Angle, AngularSpeed>,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Motion> {
    resolve(text, |angle| angle.0, |speed| speed.0, path, findings)
}

fn resolve<P: Copy, R: Copy>(
    text: &schema::Motion<P, R>,
    position: impl Fn(P) -> f64,
    rate: impl Fn(R) -> f64,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Motion> {
    Some(match text {
        schema::Motion::Held => Motion::Held,
        schema::Motion::Constant { speed } => Motion::Constant { rate: rate(*speed) },
        schema::Motion::Ramp {
            from,
            to,
            start,
            duration,
        } => Motion::Ramp {
            from: rate(*from),
            to: rate(*to),
            start: start.0,
            duration: duration.0,
        },
        schema::Motion::Harmonics { speed, terms } => Motion::Harmonics {
            rate: speed.map_or(0.0, &rate),
            terms: terms
                .iter()
                .map(|term| Harmonic {
                    amplitude: position(term.amplitude),
                    frequency: term.frequency.0,
                    phase: term.phase.0,
                })
                .collect(),
        },
        schema::Motion::Table { times, values } => {
            let times = times.iter().map(|time| time.0).collect();
            let values = values.iter().map(|value| position(*value)).collect();
            Motion::Table(table(times, values, path, "times", findings)?)
        }
    })
}

/// Torques of one list, each with its place.
pub(super) fn torques(
    list: &[schema::Torque],
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Vec<Torque>> {
    let torques = list.iter().enumerate();
    let torques: Vec<_> = torques
        .map(|(i, text)| torque(text, &format!("{path}[{i}]"), findings))
        .collect();
    torques.into_iter().collect()
}

fn torque(text: &schema::Torque, path: &str, findings: &mut Findings<'_>) -> Option<Torque> {
    let mut over = |over, arguments: Vec<f64>, torques: &[crate::scene::quantity::Torque], key| {
        let values = torques.iter().map(|torque| torque.0).collect();
        let curve = table(arguments, values, path, key, findings)?;
        Some(Torque::Table { over, curve })
    };
    match text {
        schema::Torque::Constant { torque } => Some(Torque::Constant { torque: torque.0 }),
        schema::Torque::Ramp {
            torque,
            start,
            duration,
        } => Some(Torque::Ramp {
            torque: torque.0,
            start: start.0,
            duration: duration.0,
        }),
        schema::Torque::Resistance { linear, quadratic } => Some(Torque::Resistance {
            linear: linear.0,
            quadratic: quadratic.0,
        }),
        schema::Torque::Harmonic {
            amplitude,
            order,
            phase,
        } => Some(Torque::Harmonic {
            amplitude: amplitude.0,
            order: order.0,
            phase: phase.0,
        }),
        schema::Torque::TimeTable { times, torques } => over(
            Argument::Time,
            times.iter().map(|t| t.0).collect(),
            torques,
            "times",
        ),
        schema::Torque::AngleTable { angles, torques } => {
            let angles: Vec<f64> = angles.iter().map(|angle| angle.0).collect();
            let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
            let most = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let resolved = over(Argument::Angle, angles, torques, "angles")?;
            if least > 1e-9 || most < TAU - 1e-9 {
                let message = format!(
                    "the table covers {:.1}° to {:.1}° of the turn",
                    least.to_degrees(),
                    most.to_degrees()
                );
                let hint = "let it run from 0 to 360 deg, with the same torque at both";
                findings.refuse_with(&format!("{path}.angles"), message, hint);
                return None;
            }
            Some(resolved)
        }
        schema::Torque::SpeedTable { speeds, torques } => over(
            Argument::Speed,
            speeds.iter().map(|s| s.0).collect(),
            torques,
            "speeds",
        ),
    }
}

fn table(
    arguments: Vec<f64>,
    values: Vec<f64>,
    path: &str,
    key: &str,
    findings: &mut Findings<'_>,
) -> Option<Table> {
    let path = format!("{path}.{key}");
    match Table::new(arguments, values) {
        Ok(table) => Some(table),
        Err(DriveError::Table { problem }) => {
            findings.refuse(&path, problem.replace("times", key));
            None
        }
        Err(error) => {
            findings.refuse(&path, error.to_string());
            None
        }
    }
}
