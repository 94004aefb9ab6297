//! Shafts, and what joins them.

use chaindrive_mechanics::{Coupling, GearPair, Rotation, Shaft, StartSpeed};

use super::cursor::Cursor;
use super::ends::Ends;
use super::force::{self, ForcesOfBodies};
use super::{Findings, Names, action, loss, motion};
use crate::scene::schema::{self, SceneText};
use chaindrive_quantities::{Angle, AngularSpeed};

/// All that turns.
#[derive(Debug)]
pub(super) struct Turning {
    /// Those of single sprockets, then those of the scene.
    pub(super) shafts: Vec<Shaft>,
    /// The shaft of every sprocket.
    pub(super) of_sprockets: Vec<usize>,
    pub(super) couplings: Vec<Coupling>,
    pub(super) gears: Vec<GearPair>,
    /// Forces on bodies, which may follow the angles of shafts.
    pub(super) forces: ForcesOfBodies,
}

pub(super) fn resolve(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<Turning> {
    let carriers = carriers(scene, names, findings);
    let mut of_sprockets = Vec::new();
    let own = carriers.iter().filter(|carrier| carrier.is_none()).count();
    let mut next = 0..own;
    for carrier in &carriers {
        let own_shaft = || next.next().unwrap_or(own);
        of_sprockets.push(carrier.map_or_else(own_shaft, |shaft| own + shaft));
    }
    let ends = Ends {
        shafts: names.shafts.clone(),
        sprockets: names.sprockets.clone(),
        own,
        of_sprockets: &of_sprockets,
    };
    let mut shafts = Vec::new();
    for (i, (text, carrier)) in scene.sprockets.iter().zip(&carriers).enumerate() {
        let mut at = findings.at(format!("sprockets[{i}]"));
        if let Some(shaft) = carrier {
            refuse_own_turning(text, &scene.shafts[*shaft].name, at);
            continue;
        }
        if text.motion.is_none() && text.inertia.is_none() {
            let hint =
                "give the moment of inertia of what turns with the sprocket, or its `motion`";
            at.key("inertia").refuse("missing", hint);
        }
        let turned = (&text.motion, &text.drive, &text.load, text.speed);
        shafts.push(rotation(turned, (scene, &ends), at).map(Shaft::of_one));
    }
    for (i, text) in scene.shafts.iter().enumerate() {
        let mut at = findings.at(format!("shafts[{i}]"));
        let turned = (&text.motion, &text.drive, &text.load, text.speed);
        let rotation = rotation(turned, (scene, &ends), at.again());
        let loss = loss::resolve(text.bearing.as_ref(), text.drag.as_ref(), at);
        shafts.push(rotation.zip(loss).map(|(rotation, loss)| Shaft {
            name: Some(text.name.clone()),
            rotation,
            inertia: text.inertia.map_or(0.0, f64::from),
            loss,
        }));
    }
    let forces = force::resolve(scene, &ends, findings);
    let couplings = scene.couplings.iter().enumerate();
    let couplings: Vec<_> = couplings
        .map(|(i, text)| {
            Some(Coupling {
                name: text.name.clone(),
                shafts: ends.find(&text.between, findings.at(format!("couplings[{i}]")))?,
                stiffness: text.stiffness.0,
                damping: text.damping.0,
            })
        })
        .collect();
    let gears = scene.gears.iter().enumerate();
    let gears: Vec<_> = gears
        .map(|(i, text)| {
            Some(GearPair {
                name: text.name.clone(),
                shafts: ends.find(&text.between, findings.at(format!("gears[{i}]")))?,
                ratio: text.ratio(),
            })
        })
        .collect();
    Some(Turning {
        shafts: shafts.into_iter().collect::<Option<_>>()?,
        couplings: couplings.into_iter().collect::<Option<_>>()?,
        gears: gears.into_iter().collect::<Option<_>>()?,
        forces: forces?,
        of_sprockets,
    })
}

/// The shaft of the scene that carries every sprocket, where one does.
fn carriers(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Vec<Option<usize>> {
    let mut carriers: Vec<Option<usize>> = vec![None; scene.sprockets.len()];
    for (index, shaft) in scene.shafts.iter().enumerate() {
        for (i, name) in shaft.sprockets.iter().enumerate() {
            let mut at = findings.at(format!("shafts[{index}].sprockets[{i}]"));
            let Some(sprocket) = at.lookup(&names.sprockets, "sprocket", name) else {
                continue;
            };
            if let Some(other) = carriers[sprocket] {
                let message = format!("`{name}` sits on shaft `{}` already", names.shafts[other]);
                at.refuse(message, "a sprocket sits on one shaft");
            }
            carriers[sprocket] = Some(index);
        }
    }
    carriers
}

/// A sprocket on a shaft has no rotation of its own.
fn refuse_own_turning(text: &schema::Sprocket, shaft: &str, mut at: Cursor<'_, '_>) {
    let given = [
        ("motion", text.motion.is_some()),
        ("drive", !text.drive.is_empty()),
        ("load", !text.load.is_empty()),
        ("speed", text.speed.is_some()),
    ];
    let message = format!("`{}` turns with shaft `{shaft}`", text.name);
    at.refuse_given(given, &message, &format!("give it to `shafts.{shaft}`"));
}

type ShaftInputs<'t> = (
    &'t Option<schema::Motion<Angle, AngularSpeed>>,
    &'t Vec<schema::Torque>,
    &'t Vec<schema::Torque>,
    Option<schema::StartSpeed>,
);

/// Drive of a shaft: a motion, or torques that drive and load it.
fn rotation(
    (given, drive, load, speed): ShaftInputs<'_>,
    (scene, ends): (&SceneText, &Ends<'_>),
    mut at: Cursor<'_, '_>,
) -> Option<Rotation> {
    if let Some(given) = given {
        let message = "`motion` is given too";
        let torques = [("drive", !drive.is_empty()), ("load", !load.is_empty())];
        let hint = "keep one of them: a prescribed motion supplies whatever torque it takes";
        at.refuse_given(torques, message, hint);
        let hint = "leave `speed` out: the motion says how fast it turns";
        at.refuse_given([("speed", speed.is_some())], message, hint);
        return motion::turn(given, scene, at.key("motion")).map(Rotation::Prescribed);
    }
    let drive = action::torques(drive, ends, at.key("drive"));
    let load = action::torques(load, ends, at.key("load"));
    Some(Rotation::Free {
        drive: drive?,
        load: load?,
        start: match speed {
            None => StartSpeed::Joined,
            Some(schema::StartSpeed::Given(speed)) => StartSpeed::Given(speed.0),
            Some(schema::StartSpeed::Word(_)) => StartSpeed::WorkingPoint,
        },
    })
}
