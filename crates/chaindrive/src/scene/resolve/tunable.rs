//! Parameters that may be changed while a drive moves.

use chaindrive_mechanics::{Input, Parts, Push, Rotation, Tunable};

use super::Findings;
use crate::scene::schema::SceneText;
use crate::scene::suggest::one_of;

/// The parameters that the scene lists, among these parts.
pub(super) fn resolve(
    scene: &SceneText,
    parts: &Parts,
    findings: &mut Findings<'_>,
) -> Vec<Tunable> {
    let known = all(parts);
    let mut found: Vec<Tunable> = Vec::new();
    for (index, place) in scene.tunable.iter().enumerate() {
        let path = format!("tunable[{index}]");
        if found.iter().any(|it| it.place == *place) {
            findings.refuse(&path, format!("`{place}` stands there twice"));
        } else if let Some(tunable) = known.iter().find(|it| it.place == *place) {
            found.push(tunable.clone());
        } else {
            let places: Vec<&str> = known.iter().map(|it| it.place.as_str()).collect();
            let hint = if places.is_empty() {
                "this drive has neither loads nor springs of tensioners: leave it out".to_owned()
            } else {
                one_of(place, &places)
            };
            findings.refuse_with(&path, format!("`{place}` cannot be tuned"), hint);
        }
    }
    found
}

/// Places of all that a scene of these parts may list under `tunable`.
pub fn tunable_places(parts: &Parts) -> Vec<String> {
    all(parts).into_iter().map(|it| it.place).collect()
}

/// All loads and springs of these parts.
fn all(parts: &Parts) -> Vec<Tunable> {
    let mut found = Vec::new();
    for (shaft, turning) in parts.shafts.iter().enumerate() {
        if matches!(&turning.rotation, Rotation::Free { load, .. } if !load.is_empty()) {
            found.push(Tunable {
                place: format!("{}.load", parts.shaft_name(shaft)),
                input: Input::Load { shaft },
            });
        }
    }
    for (tensioner, it) in parts.tensioners.iter().enumerate() {
        if matches!(it.push, Push::Spring(_) | Push::TorsionSpring(_)) {
            let at = |key: &str, input| Tunable {
                place: format!("tensioners.{}.push.{key}", it.name),
                input,
            };
            found.push(at("preload", Input::Preload { tensioner }));
            found.push(at("stiffness", Input::Stiffness { tensioner }));
        }
    }
    found
}
