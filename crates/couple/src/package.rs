//! The archive of a functional mock-up unit.

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::description::Standard;
use crate::export::LIBRARY;
use crate::model::Model;

/// Licences of the libraries within that of units: `make licences`.
const THIRD_PARTY: &str = include_str!("../third-party.txt");

/// Why a unit was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// No library is there.
    #[error("{}: the library of units cannot be read: {source}; name it, or install chaindrive anew", .path.display())]
    Library {
        /// Where it was looked for.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },

    /// The archive cannot be made.
    #[error("the archive cannot be made: {0}")]
    Archive(#[from] ZipError),

    /// The archive cannot be made.
    #[error("the archive cannot be made: {0}")]
    Bytes(#[from] std::io::Error),
}

/// Folder of libraries of a platform in a unit, such as `linux64` or `x86_64-linux`, and the ending of their names.
pub fn platform(standard: Standard) -> (String, &'static str) {
    let (architecture, system) = (std::env::consts::ARCH, std::env::consts::OS);
    let folder = match standard {
        Standard::Two => {
            let system = match system {
                "windows" => "win",
                "macos" => "darwin",
                other => other,
            };
            match architecture {
                "x86_64" => format!("{system}64"),
                "x86" => format!("{system}32"),
                // The standard names no others; importers have agreed on this.
                other => format!("{other}-{system}"),
            }
        }
        Standard::Three => {
            let system = if system == "macos" { "darwin" } else { system };
            format!("{architecture}-{system}")
        }
    };
    (folder, std::env::consts::DLL_SUFFIX)
}

/// The library of units, as bytes.
///
/// # Errors
/// [`PackageError::Library`].
pub fn read_library(path: &Path) -> Result<Vec<u8>, PackageError> {
    fs::read(path).map_err(|source| PackageError::Library {
        path: path.to_owned(),
        source,
    })
}

/// A unit of a model as the bytes of its archive, with the library of this platform.
///
/// The same model and library give the same bytes.
///
/// # Errors
/// [`PackageError`]: the archive cannot be made.
pub fn package(model: &Model, standard: Standard, library: &[u8]) -> Result<Vec<u8>, PackageError> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let mut file = |name: &str, content: &[u8], mode: u32| {
        archive.start_file(name, options.unix_permissions(mode))?;
        archive.write_all(content)?;
        Ok::<(), PackageError>(())
    };
    let description = standard.description(model);
    file("modelDescription.xml", description.as_bytes(), 0o644)?;
    let (folder, ending) = platform(standard);
    file(
        &format!("binaries/{folder}/{LIBRARY}{ending}"),
        library,
        0o755,
    )?;
    file(
        "documentation/licenses/third-party.txt",
        THIRD_PARTY.as_bytes(),
        0o644,
    )?;
    for (name, text) in model.resources() {
        file(&format!("resources/{name}"), text.as_bytes(), 0o644)?;
    }
    Ok(archive.finish()?.into_inner())
}
