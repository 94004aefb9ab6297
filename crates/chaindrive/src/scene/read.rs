//! Reads scenes from files and other sources of bytes.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use serde_json::Value as Json;

use super::presets::presets;
use super::{Problem, Scene, SceneError, limits};

impl Scene {
    /// Reads a scene file, TOML or JSON; or the scene of a result, from its folder.
    ///
    /// # Errors
    /// A file that is missing, empty, not text or larger than 16 MiB; otherwise those of
    /// [`Scene::from_text`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let text = text_of(path).map_err(|problem| SceneError::new(&name, vec![problem]))?;
        Self::from_text(&text, &name)
    }

    /// Reads TOML or JSON from a source such as standard input; `name` is what messages call it.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn read_from(source: impl Read, name: &str) -> Result<Self, SceneError> {
        let text = limits::read_text(source, "the text");
        let text = text.map_err(|problem| SceneError::new(name, vec![problem]))?;
        Self::from_text(&text, name)
    }
}

fn text_of(path: &Path) -> Result<String, Problem> {
    let refuse = |message: String| Problem::new("", None, message);
    if path.is_dir() {
        let folder = || refuse("this is a folder, not a scene file".into());
        return of_result(path)?.ok_or_else(folder);
    }
    let file = fs::File::open(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => refuse("there is no such file".into()).hint(instead_of(path)),
        _ => refuse(format!("the file cannot be read: {error}")),
    })?;
    limits::read_text(file, "the file")
}

/// The scene that a result carries, in full where it has it; none where the folder is no result.
fn of_result(folder: &Path) -> Result<Option<String>, Problem> {
    let Ok(file) = fs::File::open(folder.join("zarr.json")) else {
        return Ok(None);
    };
    let text = limits::read_text(file, "`zarr.json`")?;
    let group: Json = serde_json::from_str(&text).unwrap_or_default();
    let attributes = &group["attributes"];
    let scene = ["resolved_scene", "scene"]
        .into_iter()
        .find_map(|name| attributes[name].as_str());
    Ok(scene.map(str::to_owned))
}

/// Advice where there is no file: its name may be that of an embedded scene.
fn instead_of(path: &Path) -> String {
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let preset = stem.and_then(|stem| presets().iter().find(|(name, _)| *name == stem));
    match preset {
        Some((name, _)) => format!(
            "`{name}` is an embedded scene: `chaindrive run {name}`, or `chaindrive.scenes.{name}()` in Python"
        ),
        None => "check the path; `chaindrive scenes` lists the embedded scenes".to_owned(),
    }
}
