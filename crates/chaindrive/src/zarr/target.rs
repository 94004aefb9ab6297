//! Targets that may be replaced: nothing, an empty folder or place, or an earlier result.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;
use std::sync::Arc;

use serde_json::Value;

use super::Existing;
use super::bucket::{Bucket, Objects};
use super::inspect::read_group;
use super::names::{CHECKPOINT, GROUP, IDENTITY, OF_SWEEPS, RECIPE, STAGED};
use super::write_error::WriteError;
use crate::story::FORMAT;

/// Refuses a place that holds what must stay. The caller has claimed the place: a result that says `running` there
/// was left by a process that died.
pub(crate) fn check(asked: &Path, place: &Path, existing: Existing) -> Result<(), WriteError> {
    let io = |source| WriteError::Io {
        path: asked.to_owned(),
        source,
    };
    let entries = match fs::read_dir(place) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(io)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(_) if place.is_file() => {
            return Err(foreign(asked, "this is a file, not a result"));
        }
        Err(error) => return Err(io(error)),
    };
    let names = entries.iter().map(fs::DirEntry::file_name);
    let names: BTreeSet<String> = names.map(|it| it.to_string_lossy().into_owned()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let group = group(asked, place)?;
    check_names(asked, &names, &group, existing)
}

/// Refuses a place in an object store that holds what must stay, and empties it of what need not.
pub(crate) fn clear(
    asked: &Path,
    objects: &dyn Objects,
    existing: Existing,
) -> Result<(), WriteError> {
    let io = |source| WriteError::Io {
        path: asked.to_owned(),
        source,
    };
    let mut keys = objects.list("").map_err(io)?;
    if keys.is_empty() {
        return Ok(());
    }
    let names = keys.iter().filter_map(|key| key.split('/').next());
    let names: BTreeSet<String> = names.map(str::to_owned).collect();
    let identity = objects.get(IDENTITY).map_err(io)?;
    let is_ours = identity.is_some_and(|object| Bucket::is_identity(&object.bytes));
    let path = || asked.to_owned();
    if is_ours && !names.contains(GROUP) {
        // Begun, and not laid out: nobody has listed the arrays, but they look like arrays.
        let part = |key: &String| {
            let (name, rest) = key.split_once('/').unwrap_or((key, ""));
            key == IDENTITY
                || OF_SWEEPS.contains(&name)
                || rest == GROUP
                || rest == "c"
                || rest.starts_with("c/")
        };
        if let Some(stranger) = keys.iter().find(|key| !part(key)) {
            let found = format!("`{stranger}` is not of chaindrive");
            return Err(foreign(asked, &found));
        }
        if existing == Existing::Keep {
            return Err(WriteError::HalfBegun { path: path() });
        }
    } else {
        let text = objects.get(GROUP).map_err(io)?;
        let group = document(asked, text.as_ref().map(|object| object.bytes.as_slice()))?;
        check_names(asked, &names, &group, existing)?;
        // Nobody can see whether a torso is left or in work.
        if existing == Existing::Keep {
            return Err(WriteError::Exists { path: path() });
        }
    }
    // Readers find nothing as soon as the first is gone, and nobody begins in this place before the last is.
    keys.sort_by_key(|key| match key.as_str() {
        GROUP => 0,
        IDENTITY => 2,
        _ => 1,
    });
    objects.erase(&keys).map_err(io)
}

/// A store that was begun in an object store, or copied there from a disk.
pub(crate) fn bucket(asked: &Path, objects: &Arc<dyn Objects>) -> Result<Bucket, WriteError> {
    let found = Bucket::open(objects).and_then(|found| match found {
        None if objects.size(RECIPE)?.is_some() => {
            Bucket::begin(objects)?;
            Bucket::open(objects)
        }
        found => Ok(found),
    });
    let found = found.map_err(|source| WriteError::Io {
        path: asked.to_owned(),
        source,
    })?;
    found.ok_or_else(|| foreign(asked, "there is no sweep of chaindrive here"))
}

/// Refuses a result that is to stay, and whatever is not of chaindrive.
fn check_names(
    asked: &Path,
    names: &BTreeSet<String>,
    group: &Value,
    existing: Existing,
) -> Result<(), WriteError> {
    if existing == Existing::Keep && !is_empty_torso(group) {
        return Err(WriteError::Exists {
            path: asked.to_owned(),
        });
    }
    let arrays = group["consolidated_metadata"]["metadata"].as_object();
    let known = |name: &str| {
        // A killed run leaves files that it was about to put in place: `zarr.json#1234`.
        let name = name.split(STAGED).next().unwrap_or(name);
        [GROUP, CHECKPOINT, IDENTITY].contains(&name)
            || OF_SWEEPS.contains(&name)
            || arrays.is_some_and(|arrays| arrays.contains_key(name))
    };
    match names.iter().find(|name| !known(name)) {
        None => Ok(()),
        Some(stranger) => {
            let found = format!("`{stranger}` in this folder is not of chaindrive");
            Err(foreign(asked, &found))
        }
    }
}

/// The group document of an earlier result; an error if the folder is anything else.
pub(crate) fn group(asked: &Path, place: &Path) -> Result<Value, WriteError> {
    document(asked, read_group(place).ok().flatten().as_deref())
}

/// The same of what is in that file.
pub(crate) fn document(asked: &Path, text: Option<&[u8]>) -> Result<Value, WriteError> {
    let group: Option<Value> = text.and_then(|text| serde_json::from_slice(text).ok());
    group
        .filter(|group| group["attributes"]["format"] == FORMAT)
        .ok_or_else(|| foreign(asked, "this folder is not a result of chaindrive"))
}

/// Whether a result was abandoned before it held any samples.
fn is_empty_torso(group: &Value) -> bool {
    let attributes = &group["attributes"];
    let held = attributes.get("samples").or(attributes.get("finished"));
    attributes["status"] == "running" && held.is_some_and(|held| held == 0)
}

fn foreign(path: &Path, found: &str) -> WriteError {
    WriteError::Foreign {
        path: path.to_owned(),
        found: found.to_owned(),
    }
}
