//! One file that a command or a method makes: a picture, a page, a table, a unit.
//!
//! ```text
//! drive.svg                    what was there, until the new one is whole
//! .chaindrive-x8Lq0ZpT.svg     the new one in the making
//! ```
//!
//! Whoever reads the place finds the old file or the new one, whole, whenever the program is killed and however full the disk is.
//! A result that grows while it is read, a store or the table of a run, has a [`Claim`](crate::record::Claim) instead.

use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf, is_separator};

use tempfile::{Builder, NamedTempFile, TempPath};

use crate::zarr::{Existing, WriteError};

/// Beginning of the name of a file in the making. A program that is killed leaves it behind.
const PREFIX: &str = ".chaindrive-";

/// Longest ending that such a name takes over: programs of others know formats by it.
const LONGEST_ENDING: usize = 16;

/// A file that is to be made, in a place where it can be.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    existing: Existing,
    /// Folders that were made for it, the outermost first.
    made: Vec<PathBuf>,
}

/// A file in the making, beside its place, under a name that nobody else has. It is removed unless it is put in place.
#[derive(Debug)]
pub struct FilePart {
    /// Goes first: the folders that were made for it must be empty.
    part: TempPath,
    place: NewFile,
}

impl NewFile {
    /// Finds out before any work whether a file can be made in a place. Folders that are missing are made; they are removed
    /// again where nothing comes of the file.
    ///
    /// # Errors
    /// [`WriteError::FileExists`] where there is a file that is to be kept; [`WriteError::Foreign`] where there is something else than
    /// a file: a folder, a device, or a symbolic link, which is neither followed nor replaced; [`WriteError::Io`].
    pub fn at(path: &Path, existing: Existing) -> Result<Self, WriteError> {
        let mut place = Self {
            path: path.to_owned(),
            existing,
            made: Vec::new(),
        };
        place.check()?;
        place.begun().map_err(|source| place.io(source))?;
        Ok(place)
    }

    /// The place.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file and puts it in place.
    ///
    /// # Errors
    /// As [`at`](Self::at); what was in the place is still there, and nothing beside it.
    pub fn write(mut self, content: &[u8]) -> Result<(), WriteError> {
        let begun = self.begun().and_then(|mut part| {
            part.as_file_mut().write_all(content)?;
            Ok(part.into_temp_path())
        });
        let part = begun.map_err(|source| self.io(source))?;
        FilePart { part, place: self }.put_in_place()
    }

    /// Begins the file for a program of others to write: see [`FilePart`].
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn begin(mut self) -> Result<FilePart, WriteError> {
        let begun = self.begun().map_err(|source| self.io(source))?;
        let part = begun.into_temp_path();
        Ok(FilePart { part, place: self })
    }

    /// An empty file beside the place. It did not exist before, so that no link leads elsewhere.
    fn begun(&mut self) -> io::Result<NamedTempFile> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        self.make(&folder)?;
        let ending = self.path.extension().and_then(OsStr::to_str);
        let ending = ending.filter(|it| it.len() <= LONGEST_ENDING);
        let ending = ending.map(|it| format!(".{it}")).unwrap_or_default();
        let mut part = Builder::new();
        part.prefix(PREFIX).suffix(&ending).rand_bytes(16);
        // For everybody whom the system's mask lets read and write, as any new file.
        #[cfg(unix)]
        part.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        part.tempfile_in(folder)
    }

    fn make(&mut self, folder: &Path) -> io::Result<()> {
        let missing = folder.ancestors().take_while(|it| !it.exists());
        let missing: Vec<&Path> = missing.filter(|it| !it.as_os_str().is_empty()).collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(folder) {
                Ok(()) => self.made.push(folder.to_owned()),
                // Somebody else makes a file there too.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// The file that is replaced, if there is one. Refuses what is not to be replaced.
    fn check(&self) -> Result<Option<Metadata>, WriteError> {
        let foreign = |found: &str| WriteError::Foreign {
            path: self.path.clone(),
            found: found.to_owned(),
        };
        let last = self.path.as_os_str().as_encoded_bytes().last();
        if last.is_some_and(|it| is_separator(char::from(*it))) {
            return Err(foreign("this is the name of a folder"));
        }
        let about = match fs::symlink_metadata(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            about => about.map_err(|source| self.io(source))?,
        };
        if about.is_dir() {
            Err(foreign("there is a folder here"))
        } else if about.is_symlink() {
            let target = fs::read_link(&self.path).unwrap_or_default();
            Err(foreign(&format!(
                "there is a symbolic link to {} here, which is neither followed nor replaced",
                target.display()
            )))
        } else if !about.is_file() {
            Err(foreign("what is here is no file that could be replaced"))
        } else if self.existing == Existing::Keep {
            Err(self.taken())
        } else if about.permissions().readonly() {
            Err(foreign("there is a file here that must not be written"))
        } else {
            Ok(Some(about))
        }
    }

    fn taken(&self) -> WriteError {
        WriteError::FileExists {
            path: self.path.clone(),
        }
    }

    fn io(&self, source: io::Error) -> WriteError {
        // The library adds the path of the file in the making, which tells nobody anything.
        let source = match source.raw_os_error() {
            None => source.kind().into(),
            Some(_) => source,
        };
        WriteError::Io {
            path: self.path.clone(),
            source,
        }
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        // Those with a file in them stay.
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

impl FilePart {
    /// Where the file is written until it is whole: an empty file with the ending of the place.
    pub fn path(&self) -> &Path {
        &self.part
    }

    /// Puts the file in place, once the disk has it.
    ///
    /// # Errors
    /// As [`NewFile::at`]; what was in the place is still there, and nothing beside it.
    pub fn put_in_place(self) -> Result<(), WriteError> {
        let Self { part, place } = &self;
        let replaced = place.check()?;
        let ready = File::options().write(true).open(part).and_then(|file| {
            if let Some(replaced) = replaced {
                file.set_permissions(replaced.permissions())?;
            }
            file.sync_all()
        });
        ready.map_err(|source| place.io(source))?;
        let Self { part, place } = self;
        let put = match place.existing {
            Existing::Replace => part.persist(&place.path),
            Existing::Keep => part.persist_noclobber(&place.path),
        };
        put.map_err(|refused| match refused.error.kind() {
            io::ErrorKind::AlreadyExists if place.existing == Existing::Keep => place.taken(),
            _ => place.io(refused.error),
        })
    }
}

#[cfg(test)]
mod tests;
