//! Forces from outside on centres and carriers: how large they are, and what takes them.

use std::fmt;

use chaindrive_mechanics::{Action, Assembled, Forces, Push, Support};
use schemars::JsonSchema;
use serde::Serialize;

use crate::figure::Measure;

/// Forces from outside on a sprocket or a tensioner.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ForceFacts {
    /// The body, by its place in the scene.
    pub on: String,
    /// Their sum along x and y where the simulation begins \[N\].
    pub at_start: [f64; 2],
    /// True of forces that change with time or an angle.
    pub changes: bool,
    /// Their effect, in words.
    pub does: &'static str,
}

/// The forces of a drive.
pub(super) fn of(assembled: &Assembled) -> Vec<ForceFacts> {
    let parts = assembled.drive.parts();
    let is_locked = |index: usize| parts.tensioners[index].push == Push::Locked;
    let on_tensioner = |index: usize| {
        if is_locked(index) {
            "the locked tensioner bears them"
        } else {
            "their part along its way moves the tensioner"
        }
    };
    let centres = parts.sprockets.iter().map(|it| match it.support {
        Support::Fixed => "the bearing bears them",
        Support::Prescribed { .. } => "the motion of the centre works against them",
        Support::Springs { .. } => "they move the centre on its springs",
        Support::Tensioner(index) => on_tensioner(index),
    });
    let all = centres.chain((0..parts.tensioners.len()).map(on_tensioner));
    let forced = parts.forces().zip(all);
    let forced = forced.filter(|((_, forces), _)| !forces.is_empty());
    let facts = forced.map(|((on, forces), does)| ForceFacts {
        on,
        at_start: forces.unturned(assembled.drive.begin()),
        changes: changes(forces),
        does,
    });
    facts.collect()
}

fn changes(forces: &Forces) -> bool {
    forces
        .all()
        .any(|it| !matches!(it, Action::Constant { .. }))
}

impl fmt::Display for ForceFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.at_start.map(|force| Measure::Force.told(force));
        let changing = if self.changes { " at the start" } else { "" };
        write!(
            f,
            "{}: {x} along x, {y} along y{changing}; {}",
            self.on, self.does
        )
    }
}
