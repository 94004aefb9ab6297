//! Inspection of stores of unknown origin.
//!
//! Readers trust the declarations of a store. So a store is inspected before it is read. It holds plain files and folders only. Its arrays have
//! the types and codecs of this program, and none of these carries out code. No chunk unpacks to more than its declared size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use serde_json::{Map, Value};

use super::names::{GROUP, STAGED};

/// Largest group document \[bytes\].
const DOCUMENT: u64 = 64 << 20;
/// Most that a chunk may hold \[bytes\]. Channels have chunks of 1 MiB; labels and columns are one chunk, however long.
const CHUNK: u64 = 256 << 20;
/// Folders within each other: array, `c`, and an index for each dimension.
const DEEPEST: usize = 12;
/// Bytes that the header of a compressed frame has at most.
const HEADER: u64 = 18;
/// Types of arrays, and bytes of an entry; texts have any length.
const TYPES: [(&str, Option<u64>); 6] = [
    ("float64", Some(8)),
    ("float32", Some(4)),
    ("int64", Some(8)),
    ("int32", Some(4)),
    ("bool", Some(1)),
    ("string", None),
];
const CODECS: [&str; 3] = ["bytes", "vlen-utf8", "zstd"];

/// Reads a file that is one, and not larger than it should be; none where there is nothing.
pub(crate) fn read_file(path: &Path, most: u64) -> io::Result<Option<Vec<u8>>> {
    let about = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        about => about?,
    };
    let refuse = |why: String| io::Error::new(io::ErrorKind::InvalidData, why);
    if !about.is_file() {
        return Err(refuse(format!("`{}` is no file", path.display())));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(refuse(format!(
            "`{}` is larger than {} MiB",
            path.display(),
            most >> 20
        )));
    }
    Ok(Some(bytes))
}

/// The group document of a store, as far as it can be one.
pub(crate) fn read_group(store: &Path) -> io::Result<Option<Vec<u8>>> {
    read_file(&store.join(GROUP), DOCUMENT)
}

/// Says what in a store is not as this program writes it.
///
/// # Errors
/// The place in the store, and what is wrong with it.
pub(crate) fn inspect(store: &Path, group: &Value) -> Result<(), String> {
    walk(store, Path::new(""), 0)?;
    if group["zarr_format"] != 3 {
        return Err("it is not of Zarr format 3".into());
    }
    let none = Map::new();
    let arrays = group["consolidated_metadata"]["metadata"].as_object();
    let is_run = group["attributes"].get("samples").is_some();
    for (name, about) in arrays.unwrap_or(&none) {
        let array = Array::of(name, about).map_err(|why| format!("`{name}`: {why}"))?;
        array.inspect(&store.join(name), is_run)?;
    }
    Ok(())
}

/// Goes through all folders: nothing but files and folders.
fn walk(store: &Path, within: &Path, depth: usize) -> Result<(), String> {
    let said = |error: io::Error| format!("`{}`: {error}", within.display());
    if depth > DEEPEST {
        return Err(format!("`{}` lies too deep", within.display()));
    }
    for entry in fs::read_dir(store.join(within)).map_err(said)? {
        let entry = entry.map_err(said)?;
        let place = within.join(entry.file_name());
        let kind = entry.file_type().map_err(said)?;
        if kind.is_dir() {
            walk(store, &place, depth + 1)?;
        } else if !kind.is_file() {
            return Err(format!(
                "`{}` is a link, a device or a pipe, where files and folders are expected",
                place.display()
            ));
        }
    }
    Ok(())
}

/// An array as the group document declares it.
struct Array<'a> {
    name: &'a str,
    /// Chunks along every dimension.
    chunks: Vec<u64>,
    /// Bytes of a chunk that is unpacked, at most.
    most: u64,
    is_compressed: bool,
    /// A coordinate: readers load it whole when they open the store.
    is_coordinate: bool,
}

impl<'a> Array<'a> {
    fn of(name: &'a str, about: &Value) -> Result<Self, String> {
        if name.is_empty() || name.contains(['/', '\\']) || name.starts_with('.') {
            return Err("is no name of an array".into());
        }
        let kind = about["data_type"].as_str().unwrap_or_default();
        let Some((_, size)) = TYPES.iter().find(|(known, _)| *known == kind) else {
            return Err("its type is none that chaindrive writes".into());
        };
        let codecs = about["codecs"].as_array().map_or(&[][..], Vec::as_slice);
        let mut names = codecs.iter().map(|codec| codec["name"].as_str());
        if !names.all(|name| name.is_some_and(|name| CODECS.contains(&name))) {
            return Err("it is packed by a codec that chaindrive does not use".into());
        }
        let lengths = |value: &Value| -> Option<Vec<u64>> {
            value.as_array()?.iter().map(Value::as_u64).collect()
        };
        let shape = lengths(&about["shape"]).ok_or("it has no shape")?;
        let chunk = lengths(&about["chunk_grid"]["configuration"]["chunk_shape"]);
        let chunk = chunk.filter(|chunk| chunk.len() == shape.len() && !chunk.contains(&0));
        let chunk = chunk.ok_or("it has no chunks")?;
        let entries = chunk.iter().try_fold(1, |all: u64, n| all.checked_mul(*n));
        let bytes = entries.and_then(|entries| entries.checked_mul(size.unwrap_or(8)));
        let bytes = bytes.filter(|bytes| *bytes <= CHUNK);
        let bytes = bytes.ok_or_else(|| format!("a chunk holds more than {} MiB", CHUNK >> 20))?;
        let dimensions = about["dimension_names"].as_array();
        Ok(Self {
            name,
            chunks: shape
                .iter()
                .zip(&chunk)
                .map(|(n, of)| n.div_ceil(*of))
                .collect(),
            most: size.map_or(CHUNK, |_| bytes),
            is_compressed: codecs.iter().any(|codec| codec["name"] == "zstd"),
            is_coordinate: dimensions.is_some_and(|it| it.len() == 1 && it[0] == name),
        })
    }

    fn inspect(&self, folder: &Path, is_run: bool) -> Result<(), String> {
        let mut found = 0;
        self.files(&folder.join("c"), &mut found)?;
        let declared = self
            .chunks
            .iter()
            .try_fold(1, |all: u64, n| all.checked_mul(*n));
        // A sweep that goes on has no chunks yet of what it has not come to.
        if (is_run || self.is_coordinate) && declared.is_none_or(|declared| declared > found) {
            return Err(format!("`{}` holds less than it declares", self.name));
        }
        Ok(())
    }

    /// Goes through the chunks in a folder, and counts them.
    fn files(&self, folder: &Path, found: &mut u64) -> Result<(), String> {
        let said = |error: io::Error| format!("`{}`: {error}", self.name);
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            // An array without dimensions is one file.
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                return self.chunk(folder, found);
            }
            entries => entries.map_err(said)?,
        };
        for entry in entries {
            let entry = entry.map_err(said)?;
            if entry.file_type().map_err(said)?.is_dir() {
                self.files(&entry.path(), found)?;
            } else if !entry.file_name().to_string_lossy().contains(STAGED) {
                // What a killed run was about to put in place is no chunk.
                self.chunk(&entry.path(), found)?;
            }
        }
        Ok(())
    }

    fn chunk(&self, path: &Path, found: &mut u64) -> Result<(), String> {
        *found += 1;
        let too_much = || format!("`{}`: a chunk holds more than it should", self.name);
        let size = match fs::metadata(path) {
            // A writer has put another in its place.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            about => about
                .map_err(|error| format!("`{}`: {error}", self.name))?
                .len(),
        };
        // What does not shrink grows by little.
        if size > self.most + self.most / 64 + 1024 {
            return Err(too_much());
        }
        if !self.is_compressed {
            return Ok(());
        }
        let mut header = Vec::new();
        let opened = File::open(path).and_then(|file| file.take(HEADER).read_to_end(&mut header));
        match opened {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            read => read.map_err(|error| format!("`{}`: {error}", self.name))?,
        };
        match zstd_safe::get_frame_content_size(&header) {
            Ok(Some(unpacked)) if unpacked <= self.most => Ok(()),
            Ok(Some(_)) => Err(too_much()),
            Ok(None) | Err(_) => Err(format!(
                "`{}`: a chunk does not say how much it holds",
                self.name
            )),
        }
    }
}
