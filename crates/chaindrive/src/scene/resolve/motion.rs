//! Prescribed motions.

use chaindrive_mechanics::{DriveError, Harmonic, Motion, Order, SpeedTable, Table};

use super::cursor::Cursor;
use crate::scene::schema::{self, SceneText};
use crate::scene::suggest::one_of;
use chaindrive_quantities::{Angle, AngularSpeed, Length, Speed};

/// Displacements along x and y.
pub(super) fn shifts(
    [x, y]: [&schema::Motion<Length, Speed>; 2],
    scene: &SceneText,
    mut at: Cursor<'_, '_>,
) -> Option<[Motion; 2]> {
    let x = shift(x, scene, at.key("x"));
    let y = shift(y, scene, at.key("y"));
    Some([x?, y?])
}

fn shift(
    text: &schema::Motion<Length, Speed>,
    scene: &SceneText,
    mut at: Cursor<'_, '_>,
) -> Option<Motion> {
    let turning = match text {
        schema::Motion::Orders { of: Some(of), .. } => mean_speed(of, scene, at.key("of"))?,
        schema::Motion::Orders { of: None, .. } => {
            let hint = "name the shaft whose turns count";
            at.key("of").refuse("missing", hint);
            return None;
        }
        _ => 0.0,
    };
    resolve(text, turning, at)
}

/// A rotation.
pub(super) fn turn(
    text: &schema::Motion<Angle, AngularSpeed>,
    scene: &SceneText,
    mut at: Cursor<'_, '_>,
) -> Option<Motion> {
    let turning = match text {
        schema::Motion::Orders { of: Some(of), .. } => mean_speed(of, scene, at.key("of"))?,
        schema::Motion::Orders { speed, .. } => {
            let own = speed.map(f64::from).filter(|speed| *speed != 0.0);
            if own.is_none() {
                let hint = "orders count turns: give the mean speed, or in `of` the name of a shaft that has one";
                at.key("speed").refuse("no mean speed", hint);
            }
            own?
        }
        _ => 0.0,
    };
    resolve(text, turning, at)
}

/// Mean speed \[rad/s\] of the shaft that a motion by orders names.
fn mean_speed(name: &str, scene: &SceneText, mut at: Cursor<'_, '_>) -> Option<f64> {
    let all = mean_speeds(scene);
    match all.iter().find(|(known, _)| *known == name) {
        Some((_, Some(speed))) => Some(*speed),
        Some((_, None)) => {
            let turning = all.iter().filter(|(_, speed)| speed.is_some());
            let turning: Vec<&str> = turning.map(|(known, _)| *known).collect();
            let hint = match turning.as_slice() {
                [] => "give it a motion that has a mean speed".to_owned(),
                known => format!("take one whose motion has: {}", known.join(", ")),
            };
            let message = format!("`{name}` has no mean speed that is given");
            at.refuse(message, hint);
            None
        }
        None => {
            let known: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
            let message = format!("no shaft or sprocket is named `{name}`");
            at.refuse(message, one_of(name, &known));
            None
        }
    }
}

/// Shafts and sprockets with the mean speeds \[rad/s\] that motions give them, through gears as well.
///
/// ```text
/// ω₁ = ∓ (z₀/z₁) ω₀     − for gears side by side
/// ```
fn mean_speeds(scene: &SceneText) -> Vec<(&str, Option<f64>)> {
    let shafts = scene.shafts.iter();
    let own = shafts.map(|shaft| (shaft.name.as_str(), speed_given(shaft.motion.as_ref())));
    let sprockets = scene.sprockets.iter();
    let sprockets = sprockets.map(|it| (it.name.as_str(), speed_given(it.motion.as_ref())));
    let mut all: Vec<(&str, Option<f64>)> = own.chain(sprockets).collect();
    let place = |name: &str| {
        let carrying = scene.shafts.iter().position(|shaft| {
            shaft.name == name || shaft.sprockets.iter().any(|sprocket| sprocket == name)
        });
        let sprocket = || scene.sprockets.iter().position(|it| it.name == name);
        carrying.or_else(|| sprocket().map(|index| scene.shafts.len() + index))
    };
    // Through as many gears as there are, one after the other.
    for _ in 0..scene.gears.len() {
        for gears in &scene.gears {
            let [Some(first), Some(second)] = [0, 1].map(|end| place(&gears.between[end])) else {
                continue;
            };
            let ratio = gears.ratio();
            match (all[first].1, all[second].1) {
                (Some(speed), None) => all[second].1 = Some(ratio * speed),
                (None, Some(speed)) => all[first].1 = Some(speed / ratio),
                _ => {}
            }
        }
    }
    // A sprocket turns with the shaft that carries it.
    for index in scene.shafts.len()..all.len() {
        if let Some(carrying) = place(all[index].0) {
            all[index].1 = all[carrying].1;
        }
    }
    all
}

/// Mean speed of a motion that has one, other than zero.
fn speed_given(motion: Option<&schema::Motion<Angle, AngularSpeed>>) -> Option<f64> {
    let speed = match motion? {
        schema::Motion::Constant { speed } => *speed,
        schema::Motion::Harmonics { speed, .. } | schema::Motion::Orders { speed, .. } => (*speed)?,
        _ => return None,
    };
    Some(speed.0).filter(|speed| *speed != 0.0)
}

/// `turning`: mean speed \[rad/s\] of the shaft whose turns orders count.
fn resolve<P: Copy + Into<f64>, R: Copy + Into<f64>>(
    text: &schema::Motion<P, R>,
    turning: f64,
    at: Cursor<'_, '_>,
) -> Option<Motion> {
    let rate = |speed: &Option<R>| speed.map_or(0.0, Into::into);
    Some(match text {
        schema::Motion::Held => Motion::Held,
        schema::Motion::Constant { speed } => Motion::Constant {
            rate: (*speed).into(),
        },
        schema::Motion::Ramp {
            from,
            to,
            start,
            duration,
        } => Motion::Ramp {
            from: (*from).into(),
            to: (*to).into(),
            start: start.0,
            duration: duration.0,
        },
        schema::Motion::Harmonics { speed, terms } => Motion::Harmonics {
            rate: rate(speed),
            terms: terms
                .iter()
                .map(|term| Harmonic {
                    amplitude: term.amplitude.into(),
                    frequency: term.frequency.0,
                    phase: term.phase.0,
                })
                .collect(),
        },
        schema::Motion::Orders { speed, terms, .. } => Motion::Orders {
            rate: rate(speed),
            turning,
            terms: orders(terms),
            since: 0.0,
        },
        schema::Motion::Table { times, values } => {
            Motion::Table(table(times, values, "times", at)?)
        }
        schema::Motion::SpeedTable { times, speeds } => {
            Motion::SpeedTable(tabled(times, speeds, "times", at, SpeedTable::new)?)
        }
    })
}

pub(super) fn orders<A: Copy + Into<f64>>(terms: &[schema::OrderTerm<A>]) -> Vec<Order> {
    let order = |term: &schema::OrderTerm<A>| Order {
        amplitude: term.amplitude.into(),
        order: term.order.0,
        phase: term.phase.0,
    };
    terms.iter().map(order).collect()
}

pub(super) fn table<A: Copy + Into<f64>, V: Copy + Into<f64>>(
    arguments: &[A],
    values: &[V],
    key: &str,
    at: Cursor<'_, '_>,
) -> Option<Table> {
    tabled(arguments, values, key, at, Table::new)
}

fn tabled<A: Copy + Into<f64>, V: Copy + Into<f64>, T>(
    arguments: &[A],
    values: &[V],
    key: &str,
    mut at: Cursor<'_, '_>,
    make: fn(Vec<f64>, Vec<f64>) -> Result<T, DriveError>,
) -> Option<T> {
    let arguments = arguments.iter().map(|it| (*it).into()).collect();
    let values = values.iter().map(|it| (*it).into()).collect();
    let table = make(arguments, values).map_err(|error| match error {
        DriveError::Table { problem } => problem.replace("times", key),
        error => error.to_string(),
    });
    at.key(key).keep(table)
}
