//! Where the samples of a run go: nowhere, a Zarr store or a CSV file.

use std::path::{Path, PathBuf};

use chaindrive::record::{Ending, Existing, Provenance, ZarrWriter};
use chaindrive::{Channel, Judgement, Simulation};
use serde_json::{Map, Value};

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

    /// Begins the result.
    pub(crate) fn begin(
        self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: Provenance,
        existing: Existing,
    ) -> Result<Output, Failure> {
        Ok(match self {
            Self::Nowhere => Output::Nowhere,
            Self::Zarr(path) => {
                let writer = ZarrWriter::create(&path, simulation, channels, provenance, existing)?;
                Output::Zarr(Box::new(writer))
            }
            Self::Csv(path) => {
                let events = provenance.run.events;
                let writer = CsvWriter::create(&path, simulation, channels, events, existing)?;
                Output::Csv(Box::new(writer))
            }
        })
    }
}

/// A result in the making.
#[derive(Debug)]
pub(crate) enum Output {
    Nowhere,
    Zarr(Box<ZarrWriter>),
    Csv(Box<CsvWriter>),
}

impl Output {
    /// Takes the last sample of the simulation.
    pub(crate) fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        match self {
            Self::Nowhere => Ok(()),
            Self::Zarr(writer) => Ok(writer.push(simulation)?),
            Self::Csv(writer) => writer.push(simulation),
        }
    }

    /// Tells the result how exact it is; a table of numbers has no place for it.
    pub(crate) fn judge(&mut self, judgement: &Judgement) {
        if let Self::Zarr(writer) = self {
            writer.judge(judgement);
        }
    }

    /// Tells the result what it is to say about itself.
    pub(crate) fn tell(&mut self, attributes: &Map<String, Value>) {
        if let Self::Zarr(writer) = self {
            writer.tell(attributes);
        }
    }

    /// Ends the result, and says in it how the run ended.
    pub(crate) fn finish(self, simulation: &Simulation, ending: &Ending) -> Result<(), Failure> {
        match self {
            Self::Nowhere => Ok(()),
            Self::Zarr(writer) => Ok(writer.finish(simulation, ending)?),
            Self::Csv(writer) => writer.finish(simulation, ending),
        }
    }
}
