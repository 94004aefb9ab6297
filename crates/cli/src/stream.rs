//! The table of a run on standard output.

use std::io::{self, Stdout, Write};
use std::time::{Duration, Instant};

use chaindrive::record::Ending;
use chaindrive::{Channel, Recording, Simulation};

use crate::csv::{cells, heading, incomplete};
use crate::failure::Failure;

/// Rows are handed on after so long, or when a buffer is full.
const EVERY: Duration = Duration::from_secs(1);

/// A table in the making.
#[derive(Debug)]
pub(crate) struct Stream {
    table: csv::Writer<Stdout>,
    /// The last sample.
    row: Recording,
    written: Instant,
}

impl Stream {
    /// Writes the headings.
    pub(crate) fn begin(simulation: &Simulation, channels: &[Channel]) -> Result<Self, Failure> {
        let mut table = csv::Writer::from_writer(io::stdout());
        let written = table.write_record(heading(simulation, channels));
        written.map_err(|error| refused(error.into()))?;
        Ok(Self {
            table,
            row: Recording::new(channels, simulation.system()),
            written: Instant::now(),
        })
    }

    /// Takes the last sample of the simulation.
    pub(crate) fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        self.row.clear();
        self.row.push(simulation.observation());
        let written = self.table.write_record(cells(&self.row));
        written.map_err(|error| refused(error.into()))?;
        if self.written.elapsed() >= EVERY {
            self.table.flush().map_err(refused)?;
            self.written = Instant::now();
        }
        Ok(())
    }

    /// Writes the last rows, and a last line if the run did not reach its end.
    pub(crate) fn finish(mut self, ending: &Ending) -> Result<(), Failure> {
        self.table.flush().map_err(refused)?;
        let mut out = io::stdout();
        let last = incomplete(ending).unwrap_or_default();
        let written = out.write_all(last.as_bytes());
        written.and_then(|()| out.flush()).map_err(refused)
    }
}

/// Standard output cannot be written.
pub(crate) fn refused(source: io::Error) -> Failure {
    Failure::File {
        path: "stdout".to_owned(),
        source,
    }
}
