//! Results as CSV: time, and a column `channel[label]` for every entry of every channel.
//!
//! Rows appear as they come. The table of a sweep is written elsewhere, but known here. A run that did not reach its end closes with a comment line.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use chaindrive::record::{Existing, labels};
use chaindrive::{Channel, Recording, Simulation};

use crate::failure::Failure;

/// The first column of a run.
const TIME: &str = "time";

/// The first column of a sweep.
pub(crate) const VARIANT: &str = "variant";

/// A table in the making.
#[derive(Debug)]
pub(crate) struct CsvWriter {
    path: PathBuf,
    file: BufWriter<File>,
    /// The last sample.
    row: Recording,
}

impl CsvWriter {
    /// Opens the file and writes the heading.
    pub(crate) fn create(
        path: &Path,
        simulation: &Simulation,
        channels: &[Channel],
        existing: Existing,
    ) -> Result<Self, Failure> {
        let file = open(path, existing)?;
        let mut writer = Self {
            path: path.to_owned(),
            file: BufWriter::new(file),
            row: Recording::new(channels, simulation.system()),
        };
        let heading = heading(simulation, channels);
        writer.write(&heading)?;
        Ok(writer)
    }

    /// Writes the last sample of the simulation.
    pub(crate) fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        self.row.clear();
        self.row.push(simulation.observation());
        let columns = self.row.columns.iter().flat_map(|column| &column.values);
        // The shortest digits that read back to the same number.
        let row: Vec<String> = self
            .row
            .time
            .iter()
            .chain(columns)
            .map(|v| format!("{v:?}"))
            .collect();
        self.write(&row)
    }

    /// Closes the file; a reason says that the run did not reach its end.
    pub(crate) fn finish(mut self, incomplete: Option<&str>) -> Result<(), Failure> {
        if let Some(reason) = incomplete {
            self.write(&[format!("# incomplete: {}", reason.replace('\n', "; "))])?;
        }
        self.file
            .flush()
            .map_err(|source| failed(&self.path, source))
    }

    fn write(&mut self, cells: &[String]) -> Result<(), Failure> {
        let written = writeln!(self.file, "{}", cells.join(","));
        written.map_err(|source| failed(&self.path, source))
    }
}

fn heading(simulation: &Simulation, channels: &[Channel]) -> Vec<String> {
    let mut cells = vec![TIME.to_owned()];
    for channel in channels {
        match labels(channel.axis(), simulation.system()) {
            None => cells.push(channel.name().to_owned()),
            Some(labels) => {
                let cell = |label: &String| quoted(&format!("{}[{label}]", channel.name()));
                cells.extend(labels.iter().map(cell));
            }
        }
    }
    cells
}

pub(crate) fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

pub(crate) fn failed(path: &Path, source: io::Error) -> Failure {
    Failure::File {
        path: path.display().to_string(),
        source,
    }
}

/// Opens a file for a table, unless something else is there.
pub(crate) fn open(path: &Path, existing: Existing) -> Result<File, Failure> {
    let taken = |found, hint| Failure::Taken {
        path: path.display().to_string(),
        found,
        hint,
    };
    match OpenOptions::new().write(true).create_new(true).open(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
        made => return made.map_err(|source| failed(path, source)),
    }
    if !path.is_file() || !is_table(path).map_err(|source| failed(path, source))? {
        return Err(taken("this is not a table of chaindrive", ""));
    }
    if existing == Existing::Keep {
        return Err(taken(
            "there is already a result here",
            ", or pass --overwrite",
        ));
    }
    File::create(path).map_err(|source| failed(path, source))
}

/// Whether a file is empty, or begins as our tables do.
fn is_table(path: &Path) -> io::Result<bool> {
    let mut begin = Vec::new();
    File::open(path)?
        .take(VARIANT.len() as u64 + 1)
        .read_to_end(&mut begin)?;
    let begins_with = |first: &str| {
        let rest = begin.strip_prefix(first.as_bytes());
        rest.is_some_and(|rest| matches!(rest.first(), Some(b',' | b'\n')))
    };
    Ok(begin.is_empty() || begins_with(TIME) || begins_with(VARIANT))
}
