//! Checks of shafts, couplings and gears.

use super::{conflict, reference};
use crate::drive::{Adjust, GearPair, Layout, Parts, Rotation, Shaft, StartSpeed, Support};
use crate::groups::Sets;
use crate::trains::trains;
use crate::{Action, Bearing, Coupling, DriveError, Torque};

/// Every reason why the shafts of `parts` cannot turn.
pub(super) fn problems(parts: &Parts) -> Vec<DriveError> {
    let mut found = references(parts);
    if !found.is_empty() {
        // What follows looks shafts up.
        return found;
    }
    for (index, shaft) in parts.shafts.iter().enumerate() {
        found.extend(shaft_problems(index, shaft, parts));
    }
    found.extend(parts.couplings.iter().flat_map(coupling_problems));
    found.extend(gear_problems(parts));
    found.extend(inertia_problems(parts));
    found.extend(adjust_problems(parts));
    found
}

fn references(parts: &Parts) -> Vec<DriveError> {
    let known = parts.shafts.len();
    let shaft = |place: String, index: usize| reference(&place, "shaft", index, known);
    let mut found = Vec::new();
    for (index, turned) in parts.shafts.iter().enumerate() {
        let followed = turned.torques().filter_map(Torque::follows);
        found.extend(followed.filter_map(|other| shaft(parts.shaft_name(index), other)));
    }
    for (place, forces) in parts.forces() {
        let followed = forces.all().filter_map(Action::follows);
        found.extend(followed.filter_map(|other| shaft(place.clone(), other)));
    }
    for sprocket in &parts.sprockets {
        found.extend(shaft(
            format!("sprockets.{}", sprocket.name),
            sprocket.shaft,
        ));
    }
    for coupling in &parts.couplings {
        let ends = coupling.shafts.into_iter();
        found.extend(ends.filter_map(|end| shaft(format!("couplings.{}", coupling.name), end)));
    }
    for pair in &parts.gears {
        let ends = pair.shafts.into_iter();
        found.extend(ends.filter_map(|end| shaft(format!("gears.{}", pair.name), end)));
    }
    found
}

fn shaft_problems(index: usize, shaft: &Shaft, parts: &Parts) -> Vec<DriveError> {
    let place = parts.shaft_name(index);
    let mut found = Vec::new();
    let ok = shaft.inertia >= 0.0 && shaft.inertia.is_finite();
    let path = format!("{place}.inertia");
    found.extend(DriveError::require(ok, &path, shaft.inertia, "not negative [kg m²]").err());
    found.extend(shaft.loss.problems(&place));
    if !matches!(shaft.loss.bearing, None | Some(Bearing::Torque { .. })) {
        let problem =
            "a bearing that is no sprocket's has a stated torque: nothing says what it carries";
        found.push(conflict(&format!("{place}.bearing"), problem.into()));
    }
    match &shaft.rotation {
        Rotation::Prescribed(motion) => {
            found.extend(motion.check(&format!("{place}.motion")).err());
        }
        Rotation::Free { drive, load, start } => {
            if let StartSpeed::Given(speed) = start {
                let path = format!("{place}.speed");
                found.extend(
                    DriveError::require(speed.is_finite(), &path, *speed, "finite [rad/s]").err(),
                );
            }
            for (name, torques) in [("drive", drive), ("load", load)] {
                for (i, torque) in torques.iter().enumerate() {
                    found.extend(torque.check(&format!("{place}.{name}[{i}]")).err());
                }
            }
        }
    }
    let mut on_it = parts.sprockets.iter().filter(|s| s.shaft == index);
    let Some(first) = on_it.next() else {
        if shaft.name.is_none() {
            found.push(conflict(
                &place,
                "a shaft without sprockets needs a name".into(),
            ));
        }
        return found;
    };
    for other in on_it {
        if shaft.name.is_none() {
            let problem = "a shaft of several sprockets needs a name".into();
            found.push(conflict(&place, problem));
        }
        let sprocket = format!("sprockets.{}", other.name);
        if (other.centre - first.centre).norm() > COAXIAL {
            let problem = format!(
                "`{}` and `{}` share a shaft and so must have the same centre; gears join shafts that stand apart",
                first.name, other.name
            );
            found.push(conflict(&format!("{sprocket}.centre"), problem));
        }
        let sprung = matches!(first.support, Support::Springs { .. });
        if sprung || other.support != first.support {
            let problem = format!(
                "`{}` and `{}` share a shaft and so must be held alike, and not on springs of their own",
                first.name, other.name
            );
            found.push(conflict(&format!("{sprocket}.support"), problem));
        }
    }
    found
}

/// Distance of centres \[m\] up to which sprockets are on one axis.
const COAXIAL: f64 = 1e-9;

fn coupling_problems(coupling: &Coupling) -> Vec<DriveError> {
    let place = format!("couplings.{}", coupling.name);
    let mut found = Vec::new();
    let [from, to] = coupling.shafts;
    if from == to {
        found.push(conflict(&place, "joins a shaft with itself".into()));
    }
    let Coupling {
        stiffness, damping, ..
    } = *coupling;
    for (name, value, allowed) in [
        ("stiffness", stiffness, "not negative [N m/rad]"),
        ("damping", damping, "not negative [N m s/rad]"),
    ] {
        let ok = value >= 0.0 && value.is_finite();
        found.extend(DriveError::require(ok, &format!("{place}.{name}"), value, allowed).err());
    }
    if stiffness == 0.0 && damping == 0.0 {
        let problem = "joins nothing without stiffness and damping; give one of them".into();
        found.push(conflict(&place, problem));
    }
    found
}

fn gear_problems(parts: &Parts) -> Vec<DriveError> {
    let mut found = Vec::new();
    let mut sets = Sets::new(parts.shafts.len());
    let mut given: Vec<Option<usize>> = parts
        .shafts
        .iter()
        .enumerate()
        .map(|(i, shaft)| matches!(shaft.rotation, Rotation::Prescribed(_)).then_some(i))
        .collect();
    for GearPair {
        name,
        shafts,
        ratio,
    } in &parts.gears
    {
        let place = format!("gears.{name}");
        let turns = ratio.is_finite() && ratio.abs() > 0.0;
        let path = format!("{place}.ratio");
        found.extend(DriveError::require(turns, &path, *ratio, "finite and not zero").err());
        let [from, to] = shafts.map(|shaft| sets.least(shaft));
        if shafts[0] == shafts[1] {
            found.push(conflict(&place, "joins a shaft with itself".into()));
            continue;
        }
        if !sets.join(shafts[0], shafts[1]) {
            let problem =
                "closes a loop of gears, which would lock or be redundant; leave one pair out";
            found.push(conflict(&place, problem.into()));
            continue;
        }
        if let (Some(first), Some(second)) = (given[from], given[to]) {
            let problem = format!(
                "joins two shafts whose motions are both given, {} and {}; leave one motion out",
                parts.shaft_name(first),
                parts.shaft_name(second)
            );
            found.push(conflict(&place, problem));
        }
        given[from.min(to)] = given[from].or(given[to]);
    }
    found
}

/// Whatever turns freely has an inertia.
fn inertia_problems(parts: &Parts) -> Vec<DriveError> {
    let trains = trains(parts);
    let mut inertias = vec![0.0; parts.shafts.len()];
    for (shaft, train) in parts.shafts.iter().zip(&trains) {
        inertias[train.leader] += shaft.inertia;
    }
    for sprocket in &parts.sprockets {
        inertias[trains[sprocket.shaft].leader] += sprocket.inertia;
    }
    let mut found = Vec::new();
    for (index, shaft) in parts.shafts.iter().enumerate() {
        let free = matches!(shaft.rotation, Rotation::Free { .. });
        let leads = trains[index].leader == index;
        let inertia = inertias[index];
        let heavy = inertia > 0.0;
        if free && leads && !heavy {
            let path = format!("{}.inertia", parts.shaft_name(index));
            let allowed = "positive [kg m²] on whatever turns freely";
            found.extend(DriveError::require(false, &path, inertia, allowed).err());
        }
    }
    found
}

/// A sprocket that is moved until the links close takes its shaft along, and the others on it.
fn adjust_problems(parts: &Parts) -> Vec<DriveError> {
    let mut found = Vec::new();
    for (index, placed) in parts.chains.iter().enumerate() {
        let Layout::Route { fit, .. } = &placed.layout else {
            continue;
        };
        let Adjust::Sprocket { sprocket, .. } = fit.adjust else {
            continue;
        };
        let Some(moved) = parts.sprockets.get(sprocket) else {
            continue;
        };
        let on_it = parts.sprockets.iter().filter(|s| s.shaft == moved.shaft);
        if on_it.count() > 1 {
            let place = if parts.chains.len() > 1 {
                format!("chains[{index}].route.adjust")
            } else {
                "route.adjust".to_owned()
            };
            let problem = format!(
                "`{}` shares its shaft with other sprockets, which would stay where they are; move one that has a shaft of its own",
                moved.name
            );
            found.push(conflict(&place, problem));
        }
    }
    found
}
