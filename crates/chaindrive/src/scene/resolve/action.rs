//! Torques and forces: what acts over time or an angle is read once for both.

use std::f64::consts::TAU;

use chaindrive_mechanics::{Action, Argument, Order, Table, Torque};
use chaindrive_quantities::{Angle, Ratio, Time};

use super::cursor::Cursor;
use super::ends::Ends;
use super::motion::{orders, table};
use crate::scene::schema;

/// A torque or force over time or an angle, in the words of a scene.
enum ActionText<'t, V> {
    Constant(V),
    Ramp(V, Time, Time),
    Harmonic(V, Ratio, Angle),
    Orders(Option<&'t String>, &'t [schema::OrderTerm<V>]),
    TimeTable(&'t [Time], &'t [V]),
    AngleTable(Option<&'t String>, u32, &'t [Angle], &'t [V]),
}

/// Names for messages: of the value, of the key of its table, of its unit.
struct Words {
    value: &'static str,
    table: &'static str,
    unit: &'static str,
}

const TORQUES: Words = Words {
    value: "torque",
    table: "torques",
    unit: "N m",
};
const FORCES: Words = Words {
    value: "force",
    table: "forces",
    unit: "N",
};

/// Torques of one list, each with its place.
pub(super) fn torques(
    list: &[schema::Torque],
    shafts: &Ends<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<Vec<Torque>> {
    let torques = list.iter().enumerate();
    let torques: Vec<_> = torques
        .map(|(i, text)| torque(text, shafts, at.entry(i)))
        .collect();
    torques.into_iter().collect()
}

fn torque(text: &schema::Torque, shafts: &Ends<'_>, at: Cursor<'_, '_>) -> Option<Torque> {
    let text = match text {
        schema::Torque::Resistance { linear, quadratic } => {
            return Some(Torque::Resistance {
                linear: linear.0,
                quadratic: quadratic.0,
            });
        }
        schema::Torque::SpeedTable { speeds, torques } => {
            return table(speeds, torques, "speeds", at).map(Torque::OverSpeed);
        }
        schema::Torque::Constant { torque } => ActionText::Constant(*torque),
        schema::Torque::Ramp {
            torque,
            start,
            duration,
        } => ActionText::Ramp(*torque, *start, *duration),
        schema::Torque::Harmonic {
            amplitude,
            order,
            phase,
        } => ActionText::Harmonic(*amplitude, *order, *phase),
        schema::Torque::Orders { of, terms } => ActionText::Orders(of.as_ref(), terms),
        schema::Torque::TimeTable { times, torques } => ActionText::TimeTable(times, torques),
        schema::Torque::AngleTable {
            of,
            turns,
            angles,
            torques,
        } => ActionText::AngleTable(of.as_ref(), turns.0, angles, torques),
    };
    action(&text, &TORQUES, shafts, at).map(Torque::Given)
}

/// Forces of one list, each with its place.
///
/// `has_shaft`: whether what they act on sits on a shaft whose angle counts where none is named.
pub(super) fn forces(
    list: &[schema::Force],
    has_shaft: bool,
    shafts: &Ends<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<Vec<Action>> {
    let forces = list.iter().enumerate();
    let forces: Vec<_> = forces
        .map(|(i, text)| {
            let mut at = at.entry(i);
            let found = force(text, shafts, at.again())?;
            if !has_shaft && found.turns_with_an_angle() && found.follows().is_none() {
                let hint = "name in `of` of the kind `orders` or `angle-table` the shaft, or a sprocket on it, whose angle counts";
                at.key("of").refuse("a tensioner has no shaft of its own", hint);
                return None;
            }
            Some(found)
        })
        .collect();
    forces.into_iter().collect()
}

fn force(text: &schema::Force, shafts: &Ends<'_>, at: Cursor<'_, '_>) -> Option<Action> {
    let text = match text {
        schema::Force::Constant { force } => ActionText::Constant(*force),
        schema::Force::Ramp {
            force,
            start,
            duration,
        } => ActionText::Ramp(*force, *start, *duration),
        schema::Force::Harmonic {
            amplitude,
            order,
            phase,
        } => ActionText::Harmonic(*amplitude, *order, *phase),
        schema::Force::Orders { of, terms } => ActionText::Orders(of.as_ref(), terms),
        schema::Force::TimeTable { times, forces } => ActionText::TimeTable(times, forces),
        schema::Force::AngleTable {
            of,
            turns,
            angles,
            forces,
        } => ActionText::AngleTable(of.as_ref(), turns.0, angles, forces),
    };
    action(&text, &FORCES, shafts, at)
}

fn action<V: Copy + Into<f64>>(
    text: &ActionText<'_, V>,
    words: &Words,
    shafts: &Ends<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<Action> {
    let of = match text {
        ActionText::Orders(Some(of), _) | ActionText::AngleTable(Some(of), ..) => {
            Some(shafts.one(of, at.key("of"))?)
        }
        _ => None,
    };
    let over = |over, curve: Option<Table>| curve.map(|curve| Action::Table { over, curve });
    match *text {
        ActionText::Constant(value) => Some(Action::Constant {
            value: value.into(),
        }),
        ActionText::Ramp(value, start, duration) => Some(Action::Ramp {
            value: value.into(),
            start: start.0,
            duration: duration.0,
        }),
        ActionText::Harmonic(amplitude, order, phase) => Some(Action::Orders {
            of,
            terms: vec![Order {
                amplitude: amplitude.into(),
                order: order.0,
                phase: phase.0,
            }],
        }),
        ActionText::Orders(_, terms) => Some(Action::Orders {
            of,
            terms: orders(terms),
        }),
        ActionText::TimeTable(times, values) => {
            over(Argument::Time, table(times, values, "times", at))
        }
        ActionText::AngleTable(_, turns, angles, values) => {
            let curve = table(angles, values, "angles", at.again());
            let resolved = over(Argument::Angle { of, turns }, curve)?;
            closes(turns, angles, values, words, at).then_some(resolved)
        }
    }
}

/// Whether a table covers its turns and ends as it begins; refused where it does not.
fn closes<V: Copy + Into<f64>>(
    turns: u32,
    angles: &[Angle],
    values: &[V],
    words: &Words,
    mut at: Cursor<'_, '_>,
) -> bool {
    let Words { value, table, unit } = words;
    let angles = || angles.iter().map(|angle| angle.0);
    let least = angles().fold(f64::INFINITY, f64::min);
    let most = angles().fold(f64::NEG_INFINITY, f64::max);
    if least > 1e-9 || most < f64::from(turns) * TAU - 1e-9 {
        let of_turns = if turns == 1 { "turn" } else { "two turns" };
        let message = format!(
            "the table covers {:.1}° to {:.1}° of the {of_turns}",
            least.to_degrees(),
            most.to_degrees()
        );
        let end = 360 * turns;
        let hint = format!("let it run from 0 to {end} deg, with the same {value} at both");
        at.key("angles").refuse(message, hint);
        return false;
    }
    if let [first, .., last] = values {
        let [first, last]: [f64; 2] = [(*first).into(), (*last).into()];
        if (first - last).abs() > 1e-9 * first.abs().max(last.abs()) {
            let message =
                format!("the {value} jumps from {last} to {first} {unit} where it repeats");
            let hint = format!(
                "give the same {value} at both ends; a quick change takes two points close together"
            );
            at.key(table).refuse(message, hint);
            return false;
        }
    }
    true
}
