//! Where the samples of a run go: nowhere, a Zarr store, a CSV file or standard output.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use chaindrive::record::{Existing, Provenance, ZarrSink, take_over};
use chaindrive::{Channel, Checkpoint, End, NewFile, Simulation, Sink};
use clap::{Args, ValueEnum};

use crate::csv::{CsvWriter, RunClaims};
use crate::failure::Failure;
use crate::stream::Stream;
use crate::terminal::{print, say};

/// Formats of a table on standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Comma separated values, with the units in the headings
    Csv,
    /// Arrow IPC stream, with the units in the metadata of the columns, by the command of the Python package
    Arrow,
}

/// Destination of a result.
#[derive(Debug, Args)]
pub(crate) struct OutputArguments {
    /// Where the result goes: a Zarr store (.zarr), readable while it grows, a table (.csv), or - for a table on
    /// standard output
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// Format of a table on standard output, csv unless given
    #[arg(long, value_enum, requires = "output")]
    format: Option<Format>,

    /// Replaces an earlier result of the same name
    #[arg(long)]
    overwrite: bool,

    /// Takes over where another user, or a process that died, left the folder of a writer
    #[arg(long)]
    take_over: bool,
}

impl OutputArguments {
    /// Fate of an earlier result; the folder of its writer is taken over on request.
    pub(crate) fn existing(&self) -> Result<Existing, Failure> {
        if let Some(path) = self.output.as_ref().filter(|_| self.take_over) {
            take_over(path)?;
        }
        Ok(Existing::overwriting(self.overwrite))
    }
}

/// A file that a verb makes in one piece: before its work, the verb finds out whether that can be written.
pub(crate) fn new_file(path: &Path, overwrite: bool) -> Result<NewFile, Failure> {
    Ok(NewFile::at(path, Existing::overwriting(overwrite))?)
}

/// A file that was built beside the program; `option` names another one, and `hint` says how to get it.
pub(crate) fn beside_program(name: &str, option: &str, hint: &str) -> Result<PathBuf, Failure> {
    let program = std::env::current_exe().map_err(|source| Failure::File {
        path: name.to_owned(),
        source,
    })?;
    let path = program.with_file_name(name);
    if path.is_file() {
        return Ok(path);
    }
    let path = path.display();
    Err(Failure::Argument(format!(
        "{option}: {path} is missing; {hint}"
    )))
}

/// Destination of the samples, by its name.
#[derive(Debug)]
pub(crate) enum Target {
    Nowhere,
    Zarr(PathBuf),
    Csv(PathBuf),
    /// Standard output.
    Stream,
}

impl Target {
    /// The extension decides; on standard output, the format that is asked for.
    pub(crate) fn of(place: &OutputArguments) -> Result<Self, Failure> {
        let path = match (place.output.as_deref(), place.format) {
            (Some(path), Some(Format::Arrow)) if path == Path::new("-") => {
                let message = "--format arrow: the command of the Python package writes Arrow streams, \
                               with pip install 'chaindrive[parquet]'; leave --format out for CSV";
                return Err(Failure::Argument(message.to_owned()));
            }
            (Some(path), _) if path == Path::new("-") => return Ok(Self::Stream),
            (_, Some(_)) => {
                let message =
                    "--format: the name of a file tells its format; give --format with -o - only";
                return Err(Failure::Argument(message.to_owned()));
            }
            (None, None) => return Ok(Self::Nowhere),
            (Some(path), None) => path,
        };
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("zarr") => Ok(Self::Zarr(path.to_owned())),
            Some("csv") => Ok(Self::Csv(path.to_owned())),
            _ => Err(Failure::Argument(format!(
                "{}: the name must end in .zarr or .csv, or be - for standard output",
                path.display()
            ))),
        }
    }

    pub(crate) fn page(&self) -> Page {
        match self {
            Self::Stream => Page::Aside,
            _ => Page::Out,
        }
    }

    /// Refuses a place that could not be carried on.
    pub(crate) fn for_checkpoints(&self) -> Result<(), Failure> {
        let found = match self {
            Self::Zarr(_) => return Ok(()),
            Self::Nowhere => "nothing is written".to_owned(),
            Self::Csv(path) => format!("{}: a table cannot be carried on", path.display()),
            Self::Stream => "standard output cannot be carried on".to_owned(),
        };
        Err(Failure::Argument(format!(
            "--checkpoint-every: {found}; give a Zarr store, such as -o run.zarr"
        )))
    }

    /// Refuses standard output, which has no place for contacts.
    pub(crate) fn for_contacts(&self) -> Result<(), Failure> {
        if matches!(self, Self::Stream) {
            let message =
                "--events: standard output takes one table; give -o run.csv or -o run.zarr";
            return Err(Failure::Argument(message.to_owned()));
        }
        Ok(())
    }

    /// The place, still to be begun; that of a table is claimed.
    pub(crate) fn output(self, existing: Existing) -> Result<Output, Failure> {
        Ok(match self {
            Self::Nowhere => Output::Nowhere,
            Self::Zarr(path) => Output::Zarr(Box::new(ZarrSink::new(path, existing))),
            Self::Csv(path) => Output::NewCsv(Box::new(RunClaims::take(&path, existing)?)),
            Self::Stream => Output::NewStream,
        })
    }
}

/// Stream on which people read the page of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Page {
    /// On stdout.
    Out,
    /// On stderr, since the table is on stdout.
    Aside,
}

impl Page {
    pub(crate) fn tell(self, text: impl Display) -> Result<(), Failure> {
        match self {
            Self::Out => print(text),
            Self::Aside => {
                say(text);
                Ok(())
            }
        }
    }
}

/// Message about two documents on stdout.
pub(crate) const ONE_DOCUMENT: &str =
    "--json: standard output takes one document; give -o a file, or leave --json out";

/// A result in the making.
#[derive(Debug)]
pub(crate) enum Output {
    Nowhere,
    Zarr(Box<ZarrSink>),
    /// A table that is begun when the run is.
    NewCsv(Box<RunClaims>),
    Csv(Box<CsvWriter>),
    /// A table on standard output that is begun when the run is.
    NewStream,
    Stream(Box<Stream>),
}

impl Sink for Output {
    type Error = Failure;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        if let Self::Zarr(store) = self {
            return Ok(store.begin(simulation, channels, provenance)?);
        }
        match std::mem::replace(self, Self::Nowhere) {
            Self::NewCsv(claims) => {
                let events = provenance.run.events;
                let writer = CsvWriter::create(*claims, simulation, channels, events)?;
                *self = Self::Csv(Box::new(writer));
            }
            Self::NewStream => {
                // Contacts of the scene have no place there; those of an option were refused.
                let stream = Stream::begin(simulation, channels)?;
                *self = Self::Stream(Box::new(stream));
            }
            begun => *self = begun,
        }
        Ok(())
    }

    fn keeps_samples(&self) -> bool {
        !matches!(self, Self::Nowhere)
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::NewCsv(..) | Self::NewStream => Ok(()),
            Self::Zarr(store) => Ok(store.push(simulation)?),
            Self::Csv(writer) => writer.push(simulation),
            Self::Stream(stream) => stream.push(simulation),
        }
    }

    fn keep(&mut self, simulation: &Simulation, checkpoint: &Checkpoint) -> Result<(), Failure> {
        match self {
            Self::Zarr(store) => Ok(store.keep(simulation, checkpoint)?),
            _ => Ok(()),
        }
    }

    /// A table of numbers has no place for what the result says about itself.
    fn end(&mut self, end: &End<'_>) -> Result<(), Failure> {
        match std::mem::replace(self, Self::Nowhere) {
            Self::Nowhere | Self::NewCsv(..) | Self::NewStream => Ok(()),
            Self::Zarr(mut store) => Ok(store.end(end)?),
            Self::Csv(writer) => writer.finish(end.simulation, end.ending),
            Self::Stream(stream) => stream.finish(end.ending),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrow is left to the Python package, and the message says how to get it.
    #[test]
    fn an_arrow_stream_is_refused_with_what_to_do() {
        let place = OutputArguments {
            output: Some("-".into()),
            format: Some(Format::Arrow),
            overwrite: false,
            take_over: false,
        };
        let refusal = Target::of(&place).unwrap_err().to_string();
        for words in ["Python package", "chaindrive[parquet]", "CSV"] {
            assert!(refusal.contains(words), "{refusal}");
        }
    }
}
