//! Cross-checks between the parts of a drive.

pub(crate) mod clash;
mod shafts;

use std::collections::HashSet;

use chaindrive_geometry::{Point, Vector};

use crate::drive::{
    Adjust, Drive, Fit, GuideSupport, Layout, Parts, PlacedChain, Sprocket, Stop, Support,
};
use crate::{DriveError, Ends};

impl Drive {
    /// Checks the parts.
    ///
    /// # Errors
    /// Every problem found, not only the first.
    pub fn new(parts: Parts) -> Result<Self, Vec<DriveError>> {
        let problems = problems(&parts);
        if problems.is_empty() {
            Ok(Self { parts, begin: 0.0 })
        } else {
            Err(problems)
        }
    }
}

/// Every reason why `parts` is not a drive.
fn problems(parts: &Parts) -> Vec<DriveError> {
    let mut found = Vec::new();
    if parts.chains.is_empty() {
        found.push(conflict("chains", "a drive has at least one chain".into()));
    }
    for (index, placed) in parts.chains.iter().enumerate() {
        let mut own = placed.chain.problems();
        own.extend(layout_problems(placed, parts));
        own.extend(plane_problems(placed, parts));
        if parts.chains.len() > 1 {
            for problem in &mut own {
                problem.place_in(&format!("chains[{index}]"));
            }
        }
        found.extend(own);
    }
    found.extend(shafts::problems(parts));
    for sprocket in &parts.sprockets {
        found.extend(sprocket_problems(sprocket, parts.tensioners.len()));
    }
    for guide in &parts.guides {
        let place = format!("guides.{}", guide.name);
        found.extend(guide.surface.problems(&place));
        match &guide.support {
            GuideSupport::Fixed => {}
            GuideSupport::Prescribed { x, y } => {
                found.extend(x.check(&format!("{place}.support.x")).err());
                found.extend(y.check(&format!("{place}.support.y")).err());
            }
            GuideSupport::Tensioner(index) => {
                found.extend(reference(
                    &place,
                    "tensioner",
                    *index,
                    parts.tensioners.len(),
                ));
            }
        }
    }
    for tensioner in &parts.tensioners {
        found.extend(tensioner.problems());
    }
    found.extend(finite(parts.gravity, "gravity"));
    found.extend(duplicate_names(parts));
    found.extend(clash::overlaps(parts));
    found
}

fn sprocket_problems(sprocket: &Sprocket, tensioners: usize) -> Vec<DriveError> {
    let place = format!("sprockets.{}", sprocket.name);
    let mut found = sprocket.surface.problems(&place);
    if let Some(flank) = &sprocket.flank {
        let law = |source| DriveError::Law {
            path: format!("{place}.contact.flank"),
            source,
        };
        found.extend(flank.elastic.check().map_err(law).err());
        let path = format!("{place}.contact.flank.width");
        let fits = flank.width > 0.0 && flank.width.is_finite();
        found.extend(DriveError::require(fits, &path, flank.width, "positive [m]").err());
    }
    let mut need = |ok: bool, what: &str, value: f64, allowed: &'static str| {
        found.extend(DriveError::require(ok, &format!("{place}.{what}"), value, allowed).err());
    };
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let not_negative = |value: f64| value >= 0.0 && value.is_finite();
    need(
        not_negative(sprocket.inertia),
        "inertia",
        sprocket.inertia,
        "not negative [kg m²]",
    );
    let floats = matches!(sprocket.support, Support::Springs { .. });
    need(
        not_negative(sprocket.mass) && (!floats || sprocket.mass > 0.0),
        "mass",
        sprocket.mass,
        "positive [kg] where the centre is free, not negative elsewhere",
    );
    need(
        sprocket.gap_angle.is_finite(),
        "gap_angle",
        sprocket.gap_angle,
        "finite [rad]",
    );
    let gap = &sprocket.gap;
    found.extend(sprocket.loss.problems(&place));
    found.extend(sprocket.forces.problems(&place));
    found.extend(sprocket.tolerance.problems(&place, gap.teeth, gap.pitch));
    let mut need = |ok: bool, what: &str, value: f64, allowed: &'static str| {
        found.extend(DriveError::require(ok, &format!("{place}.{what}"), value, allowed).err());
    };
    if let Support::Springs { stiffness, damping } = &sprocket.support {
        for (axis, (k, c)) in ["x", "y"].iter().zip(stiffness.iter().zip(damping)) {
            need(
                not_negative(*k),
                &format!("support.stiffness.{axis}"),
                *k,
                "not negative [N/m]",
            );
            need(
                not_negative(*c),
                &format!("support.damping.{axis}"),
                *c,
                "not negative [N s/m]",
            );
        }
        need(
            positive(sprocket.mass),
            "mass",
            sprocket.mass,
            "positive [kg]",
        );
    }
    match &sprocket.support {
        Support::Prescribed { x, y } => {
            found.extend(x.check(&format!("{place}.support.x")).err());
            found.extend(y.check(&format!("{place}.support.y")).err());
        }
        Support::Tensioner(index) => {
            found.extend(reference(&place, "tensioner", *index, tensioners));
        }
        Support::Fixed | Support::Springs { .. } => {}
    }
    found.extend(finite(sprocket.centre.coords, &format!("{place}.centre")));
    found
}

fn finite(v: Vector, path: &str) -> Option<DriveError> {
    let bad = v.iter().copied().find(|value| !value.is_finite())?;
    DriveError::require(false, path, bad, "finite").err()
}

fn reference(path: &str, kind: &'static str, index: usize, known: usize) -> Option<DriveError> {
    (index >= known).then(|| DriveError::Reference {
        path: path.to_owned(),
        kind,
        index,
        known,
    })
}

fn duplicate_names(parts: &Parts) -> Vec<DriveError> {
    let names = parts.sprockets.iter().map(|s| ("sprockets", &s.name));
    let names = names.chain(parts.guides.iter().map(|g| ("guides", &g.name)));
    let names = names.chain(parts.tensioners.iter().map(|t| ("tensioners", &t.name)));
    let chains = parts.chains.iter().filter_map(|c| c.name.as_ref());
    let names = names.chain(chains.map(|name| ("chains", name)));
    let shafts = parts.shafts.iter().filter_map(|s| s.name.as_ref());
    let names = names.chain(shafts.map(|name| ("shafts", name)));
    let names = names.chain(parts.couplings.iter().map(|c| ("couplings", &c.name)));
    let names = names.chain(parts.gears.iter().map(|g| ("gears", &g.name)));
    let mut seen = HashSet::new();
    names
        .filter(|entry| !seen.insert(*entry))
        .map(|(kind, name)| DriveError::Conflict {
            path: kind.to_owned(),
            problem: format!("two of them are named `{name}`; names must differ"),
        })
        .collect()
}

fn conflict(path: &str, problem: String) -> DriveError {
    DriveError::Conflict {
        path: path.to_owned(),
        problem,
    }
}

fn layout_problems(placed: &PlacedChain, parts: &Parts) -> Vec<DriveError> {
    match &placed.layout {
        Layout::Points {
            positions,
            velocities,
        } => {
            let rollers = placed.chain.rollers();
            let mut found = Vec::new();
            for (name, count) in [
                ("positions", positions.len()),
                ("velocities", velocities.len()),
            ] {
                if count != rollers {
                    found.push(conflict(
                        "chain.start",
                        format!("{count} {name} for {rollers} rollers; give one for each"),
                    ));
                }
            }
            let numbers = positions
                .iter()
                .map(|p: &Point| p.coords)
                .chain(velocities.iter().copied());
            found.extend(numbers.filter_map(|v| finite(v, "chain.start")).take(1));
            found
        }
        Layout::Route {
            stops, phase, fit, ..
        } => {
            let mut found = Vec::new();
            if placed.chain.ends != Ends::Closed {
                found.push(conflict(
                    "route",
                    "an open strand has no route; lay it by `start`".into(),
                ));
            }
            if stops.len() < 2 {
                found.push(conflict(
                    "route.stops",
                    "a loop needs at least two stops".into(),
                ));
            }
            let mut seen = HashSet::new();
            for stop in stops {
                if !seen.insert(*stop) {
                    found.push(conflict("route.stops", format!("{stop:?} stands twice")));
                }
                found.extend(match *stop {
                    Stop::Sprocket(i) => reference("route", "sprocket", i, parts.sprockets.len()),
                    Stop::Guide(i) => reference("route", "guide", i, parts.guides.len()),
                });
            }
            if !matches!(stops.first(), Some(Stop::Sprocket(_)) | None) {
                found.push(conflict(
                    "route.stops",
                    "the first stop must be a sprocket".into(),
                ));
            }
            found.extend(
                DriveError::require(
                    (0.0..=1.0).contains(phase),
                    "route.phase",
                    *phase,
                    "between 0 and 1",
                )
                .err(),
            );
            found.extend(fit_problems(fit, parts));
            found
        }
    }
}

/// What a chain can touch: there, no body twice, and every stop of the route among it.
fn plane_problems(placed: &PlacedChain, parts: &Parts) -> Vec<DriveError> {
    let mut found = Vec::new();
    let kinds = [
        ("sprocket", &placed.sprockets, parts.sprockets.len()),
        ("guide", &placed.guides, parts.guides.len()),
    ];
    for (kind, indices, known) in kinds {
        let mut seen = HashSet::new();
        for &index in indices {
            found.extend(reference("chain", kind, index, known));
            if !seen.insert(index) {
                found.push(conflict("chain", format!("{kind} {index} stands twice")));
            }
        }
    }
    if let Layout::Route { stops, .. } = &placed.layout {
        let missing = stops.iter().find(|stop| match stop {
            Stop::Sprocket(index) => !placed.sprockets.contains(index),
            Stop::Guide(index) => !placed.guides.contains(index),
        });
        found.extend(missing.map(|stop| {
            conflict(
                "route.stops",
                format!("{stop:?} is not among what the chain can touch"),
            )
        }));
    }
    found
}

/// Largest growth of a frame. *Assumed*: aluminium grows by as much against steel over more than 1000 K.
const MOST_GROWTH: f64 = 0.02;

fn fit_problems(fit: &Fit, parts: &Parts) -> Vec<DriveError> {
    let mut found = Vec::new();
    found.extend(
        DriveError::require(
            fit.pretension >= 0.0 && fit.pretension.is_finite(),
            "route.pretension",
            fit.pretension,
            "not negative [N]",
        )
        .err(),
    );
    let grows = fit.growth.abs() <= MOST_GROWTH;
    let allowed = "between -0.02 and 0.02, as metals grow";
    found.extend(DriveError::require(grows, "route.growth", fit.growth, allowed).err());
    let within = match fit.adjust {
        Adjust::Nothing => 1.0,
        Adjust::Sprocket {
            sprocket, within, ..
        } => {
            found.extend(reference(
                "route.adjust",
                "sprocket",
                sprocket,
                parts.sprockets.len(),
            ));
            within
        }
        Adjust::Tensioner { tensioner, within } => {
            found.extend(reference(
                "route.adjust",
                "tensioner",
                tensioner,
                parts.tensioners.len(),
            ));
            within
        }
    };
    found.extend(
        DriveError::require(
            within > 0.0 && within.is_finite(),
            "route.adjust.within",
            within,
            "positive",
        )
        .err(),
    );
    found
}
