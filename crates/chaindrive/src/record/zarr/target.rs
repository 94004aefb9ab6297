//! Targets that may be replaced: nothing, an empty folder, or an earlier result.

use std::fs;
use std::io;
use std::path::Path;

use serde_json::Value;

use super::folder::STAGED;
use super::{Existing, variants};
use crate::record::attributes::FORMAT;
use crate::record::error::WriteError;

/// State from which a run goes on, beside the arrays.
pub(super) const CHECKPOINT: &str = "checkpoint";

/// The document that makes a folder a Zarr group.
const GROUP: &str = "zarr.json";

/// Refuses a place that holds what must stay. The caller has claimed the place: a result that says `running` there
/// was left by a process that died.
pub(super) fn check(asked: &Path, place: &Path, existing: Existing) -> Result<(), WriteError> {
    let io = |source| WriteError::Io {
        path: asked.to_owned(),
        source,
    };
    let entries = match fs::read_dir(place) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(io)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(_) if place.is_file() => {
            return Err(foreign(asked, "this is a file, not a result".into()));
        }
        Err(error) => return Err(io(error)),
    };
    if entries.is_empty() {
        return Ok(());
    }
    let group = group(asked, place)?;
    if existing == Existing::Keep && !is_empty_torso(&group) {
        return Err(WriteError::Exists {
            path: asked.to_owned(),
        });
    }
    let arrays = group["consolidated_metadata"]["metadata"].as_object();
    let known = |name: &str| {
        // A killed run leaves files that it was about to put in place: `zarr.json#1234`.
        let name = name.split(STAGED).next().unwrap_or(name);
        name == GROUP
            || name == CHECKPOINT
            || variants::FILES.contains(&name)
            || arrays.is_some_and(|arrays| arrays.contains_key(name))
    };
    let names = entries
        .iter()
        .map(|entry| entry.file_name().to_string_lossy().into_owned());
    match names.into_iter().find(|name| !known(name)) {
        None => Ok(()),
        Some(stranger) => Err(foreign(
            asked,
            format!("`{stranger}` in this folder is not of chaindrive"),
        )),
    }
}

/// The group document of an earlier result; an error if the folder is anything else.
pub(super) fn group(asked: &Path, place: &Path) -> Result<Value, WriteError> {
    let not_ours = || foreign(asked, "this folder is not a result of chaindrive".into());
    let text = fs::read(place.join(GROUP)).map_err(|_| not_ours())?;
    let group: Value = serde_json::from_slice(&text).map_err(|_| not_ours())?;
    if group["attributes"]["format"] != FORMAT {
        return Err(not_ours());
    }
    Ok(group)
}

/// Whether a result was begun and left before it held anything.
fn is_empty_torso(group: &Value) -> bool {
    let attributes = &group["attributes"];
    let held = attributes.get("samples").or(attributes.get("finished"));
    attributes["status"] == "running" && held.is_some_and(|held| held == 0)
}

fn foreign(path: &Path, found: String) -> WriteError {
    WriteError::Foreign {
        path: path.to_owned(),
        found,
    }
}
