//! Differences between two scenes, defaults included.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use super::resolved::{ResolvedScene, leaf};
use super::validate::below;
use super::{Scene, SceneError};

/// A value that two scenes do not have in common.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Difference {
    /// Place in the scenes, with entries of lists by name where they have one.
    pub path: String,
    /// Value of the first scene, with its unit.
    pub first: Option<String>,
    /// Value of the second scene, likewise.
    pub second: Option<String>,
}

/// `sprockets.crank.teeth: 23 | 25`; a dash stands for nothing.
impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: &Option<String>| value.clone().unwrap_or_else(|| "–".into());
        let (first, second) = (shown(&self.first), shown(&self.second));
        write!(f, "{}: {first} | {second}", self.path)
    }
}

/// Differences between two scenes in full: given values, open ones, and the defaults that are then taken.
///
/// Values are compared in SI units, entries of lists by their names: another order, unit or spelling is no difference.
///
/// ```
/// use chaindrive::scene::{Scene, diff};
///
/// let scene = Scene::preset("marine_engine")?;
/// let other = scene.replace("sprockets.crank.teeth", "25")?;
/// let differences = diff(&scene, &other)?;
/// assert_eq!(differences[0].to_string(), "sprockets.crank.teeth: 48 | 25");
/// # Ok::<(), chaindrive::scene::SceneError>(())
/// ```
///
/// # Errors
/// As [`Scene::drive`].
pub fn diff(first: &Scene, second: &Scene) -> Result<Vec<Difference>, SceneError> {
    let (first, second) = (leaves(first)?, leaves(second)?);
    let of = |leaves: &[(String, String)], path: &str| {
        let found = leaves.iter().find(|(known, _)| known == path);
        found.map(|(_, value)| value.clone())
    };
    let mut differences = Vec::new();
    for (path, value) in &first {
        let other = of(&second, path);
        if other.as_ref() != Some(value) {
            differences.push(Difference {
                path: path.clone(),
                first: Some(value.clone()),
                second: other,
            });
        }
    }
    for (path, value) in second {
        if of(&first, &path).is_none() {
            differences.push(Difference {
                path,
                first: None,
                second: Some(value),
            });
        }
    }
    Ok(differences)
}

/// Every value of a scene in full, by its place.
fn leaves(scene: &Scene) -> Result<Vec<(String, String)>, SceneError> {
    let resolved = ResolvedScene::of(scene)?;
    let mut found = Vec::new();
    for (key, value) in &resolved.values {
        visit(value, key, key, &resolved, &mut found);
    }
    Ok(found)
}

/// `place` counts the entries of lists, `path` names them.
fn visit(
    value: &Json,
    place: &str,
    path: &str,
    resolved: &ResolvedScene,
    found: &mut Vec<(String, String)>,
) {
    match value {
        Json::Object(entries) => {
            for (key, value) in entries {
                visit(
                    value,
                    &below(place, key),
                    &below(path, key),
                    resolved,
                    found,
                );
            }
        }
        Json::Array(items) if items.iter().any(Json::is_object) => {
            for (index, item) in items.iter().enumerate() {
                let index = index.to_string();
                let name = item["name"].as_str().unwrap_or(&index);
                visit(
                    item,
                    &below(place, &index),
                    &below(path, name),
                    resolved,
                    found,
                );
            }
        }
        value => {
            let first = if value.is_array() {
                below(place, "0")
            } else {
                place.to_owned()
            };
            let unit = resolved.units.get(&first).filter(|unit| **unit != "1");
            let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
            // What fills more than a line is not for the eye.
            let mut text = leaf(value);
            if text.chars().count() > 200 {
                let sum: String = text.chars().take(40).collect();
                text = format!("{sum}… ({} characters, {:016x})", text.len(), hash(&text));
            }
            found.push((path.to_owned(), text + &unit));
        }
    }
}

/// FNV-1a: tells long lists apart, the same on every machine.
fn hash(text: &str) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325_u64;
    text.bytes().fold(start, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
