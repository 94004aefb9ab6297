//! Where the samples of a run go: nowhere, a Zarr store or a CSV file.

use std::path::{Path, PathBuf};

use chaindrive::record::{Existing, InStore, Provenance};
use chaindrive::{Channel, Checkpoint, End, Simulation, Sink};

use crate::csv::CsvWriter;
use crate::failure::Failure;

/// Where the samples go, by the name asked for.
#[derive(Debug)]
pub(crate) enum Target {
    Nowhere,
    Zarr(PathBuf),
    Csv(PathBuf),
}

impl Target {
    /// The extension decides.
    pub(crate) fn of(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else {
            return Ok(Self::Nowhere);
        };
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("zarr") => Ok(Self::Zarr(path.to_owned())),
            Some("csv") => Ok(Self::Csv(path.to_owned())),
            _ => Err(Failure::Argument(format!(
                "{}: the name must end in .zarr or .csv",
                path.display()
            ))),
        }
    }

    /// Refuses a place that could not be carried on.
    pub(crate) fn for_checkpoints(&self) -> Result<(), Failure> {
        let found = match self {
            Self::Zarr(_) => return Ok(()),
            Self::Nowhere => "nothing is written".to_owned(),
            Self::Csv(path) => format!("{}: a table cannot be carried on", path.display()),
        };
        Err(Failure::Argument(format!(
            "--checkpoint-every: {found}; give a Zarr store, such as -o run.zarr"
        )))
    }

    /// The place, still to be begun.
    pub(crate) fn output(self, existing: Existing) -> Output {
        match self {
            Self::Nowhere => Output::Nowhere,
            Self::Zarr(path) => Output::Zarr(Box::new(InStore::new(path, existing))),
            Self::Csv(path) => Output::NewCsv(path, existing),
        }
    }
}

/// A result in the making.
#[derive(Debug)]
pub(crate) enum Output {
    Nowhere,
    Zarr(Box<InStore>),
    /// A table that is begun when the run is.
    NewCsv(PathBuf, Existing),
    Csv(Box<CsvWriter>),
}

impl Sink for Output {
    type Error = Failure;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::Csv(_) => {}
            Self::Zarr(store) => store.begin(simulation, channels, provenance)?,
            Self::NewCsv(path, existing) => {
                let events = provenance.run.events;
                let writer = CsvWriter::create(path, simulation, channels, events, *existing)?;
                *self = Self::Csv(Box::new(writer));
            }
        }
        Ok(())
    }

    fn keeps_samples(&self) -> bool {
        !matches!(self, Self::Nowhere)
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::NewCsv(..) => Ok(()),
            Self::Zarr(store) => Ok(store.push(simulation)?),
            Self::Csv(writer) => writer.push(simulation),
        }
    }

    fn keep(&mut self, simulation: &Simulation, checkpoint: &Checkpoint) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::NewCsv(..) | Self::Csv(_) => Ok(()),
            Self::Zarr(store) => Ok(store.keep(simulation, checkpoint)?),
        }
    }

    /// A table of numbers has no place for what the result says about itself.
    fn end(&mut self, end: &End<'_>) -> Result<(), Failure> {
        match std::mem::replace(self, Self::Nowhere) {
            Self::Nowhere | Self::NewCsv(..) => Ok(()),
            Self::Zarr(mut store) => Ok(store.end(end)?),
            Self::Csv(writer) => writer.finish(end.simulation, end.ending),
        }
    }
}
