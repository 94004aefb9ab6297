//! Forces from outside on the centres of sprockets and on carriers.

use chaindrive_geometry::Point;
use chaindrive_mechanics::Forces;

use super::cursor::Cursor;
use super::ends::Ends;
use super::{Findings, action, point};
use crate::scene::schema::{self, SceneText};

/// Forces of all bodies.
#[derive(Debug)]
pub(super) struct ForcesOfBodies {
    pub(super) sprockets: Vec<Forces>,
    /// Each with the point of an arm on which they act.
    pub(super) tensioners: Vec<(Forces, Option<Point>)>,
}

pub(super) fn resolve(
    scene: &SceneText,
    ends: &Ends<'_>,
    findings: &mut Findings<'_>,
) -> Option<ForcesOfBodies> {
    let sprockets = scene.sprockets.iter().enumerate();
    let sprockets: Vec<_> = sprockets
        .map(|(i, text)| {
            let at = findings.at(format!("sprockets[{i}]"));
            forces([&text.force_x, &text.force_y], true, ends, at)
        })
        .collect();
    let tensioners = scene.tensioners.iter().enumerate();
    let tensioners: Vec<_> = tensioners
        .map(|(i, text)| {
            let mut at = findings.at(format!("tensioners[{i}]"));
            let found = forces([&text.force_x, &text.force_y], false, ends, at.again())?;
            let placed = is_placed(text, !found.is_empty(), at.key("force_at"));
            placed.then(|| (found, text.force_at.map(point)))
        })
        .collect();
    Some(ForcesOfBodies {
        sprockets: sprockets.into_iter().collect::<Option<_>>()?,
        tensioners: tensioners.into_iter().collect::<Option<_>>()?,
    })
}

fn forces(
    [x, y]: [&[schema::Force]; 2],
    has_shaft: bool,
    ends: &Ends<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<Forces> {
    let x = action::forces(x, has_shaft, ends, at.key("force_x"));
    let y = action::forces(y, has_shaft, ends, at.key("force_y"));
    Some(Forces { x: x?, y: y? })
}

/// Whether the point on which forces on a carrier act is given where it has to be; refused where it is missing, or means nothing.
fn is_placed(text: &schema::Tensioner, is_forced: bool, mut at: Cursor<'_, '_>) -> bool {
    let is_arm = text.carrier.word("kind") == "arm";
    let given = text.force_at.is_some();
    if is_arm && is_forced && !given {
        let hint =
            "give the point of the arm on which the forces act, such as [\"0.1 m\", \"0.2 m\"]";
        at.refuse("missing", hint);
        return false;
    }
    if given && !is_arm {
        let hint = "leave it out: all points of a slider move alike";
        at.refuse("a force on a slider needs no point", hint);
        return false;
    }
    true
}
