//! Where a sweep goes: nowhere, a Zarr store, or a table with a row a variant.

use std::fs::{self, File};
use std::io::{BufWriter, IntoInnerError, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use chaindrive::record::{Ending, Existing, SweepWriter};
use chaindrive::sweep::{Outcome, Progress, Stacked, Sweep};

use super::super::output::Target;
use crate::csv::{VARIANT, failed, open, quoted};
use crate::failure::Failure;

/// Wall time between two writes while the sweep goes on.
const WRITE_EVERY: Duration = Duration::from_secs(5);

/// Writing takes at most this share of the time, however large the result grows.
const SHARE: u32 = 20;

/// A result in the making.
#[derive(Debug)]
pub(super) struct Output {
    place: Place,
    /// Variants that were finished when the result was last written.
    known: usize,
    written: Instant,
    /// Time that writing took.
    took: Duration,
}

#[derive(Debug)]
enum Place {
    Nowhere,
    Zarr(Box<SweepWriter>),
    Csv(PathBuf),
}

impl Output {
    /// Begins the result.
    pub(super) fn begin(
        target: Target,
        sweep: &Sweep,
        existing: Existing,
    ) -> Result<Self, Failure> {
        let place = match target {
            Target::Nowhere => Place::Nowhere,
            Target::Zarr(path) => {
                Place::Zarr(Box::new(SweepWriter::create(&path, sweep, existing)?))
            }
            Target::Csv(path) if sweep.record().is_empty() => {
                open(&path, existing)?;
                Place::Csv(path)
            }
            Target::Csv(path) => {
                return Err(Failure::Argument(format!(
                    "{}: a table has no place for the channels of --record; take a .zarr store",
                    path.display()
                )));
            }
        };
        Ok(Self {
            place,
            known: 0,
            written: Instant::now(),
            took: Duration::ZERO,
        })
    }

    /// Writes what is known, if there is more than before and the last time was a while ago: at once when the
    /// first variant ends, for then the shape of the result is known.
    pub(super) fn keep(&mut self, sweep: &Sweep, state: Progress<'_>) -> Result<(), Failure> {
        let due = if self.known == 0 {
            Duration::ZERO
        } else {
            WRITE_EVERY.max(self.took * SHARE)
        };
        if state.finished == self.known || self.written.elapsed() < due {
            return Ok(());
        }
        let begin = Instant::now();
        self.write(sweep, state.outcomes, &Ending::None)?;
        self.known = state.finished;
        self.took = begin.elapsed();
        self.written = Instant::now();
        Ok(())
    }

    /// Writes what is known of all variants, and how the sweep ended.
    pub(super) fn write(
        &self,
        sweep: &Sweep,
        outcomes: &[Outcome],
        ending: &Ending,
    ) -> Result<(), Failure> {
        match &self.place {
            Place::Nowhere => Ok(()),
            Place::Zarr(writer) => Ok(writer.write(sweep, outcomes, ending)?),
            Place::Csv(path) => {
                let written = table(path, sweep, &sweep.stack(outcomes), ending);
                written.map_err(|source| failed(path, source))
            }
        }
    }
}

/// Writes the table beside its place and moves it there: it is whole at any time.
fn table(path: &Path, sweep: &Sweep, stacked: &Stacked, ending: &Ending) -> std::io::Result<()> {
    let part = path.with_extension("csv.part");
    let mut file = BufWriter::new(File::create(&part)?);
    let mut heading = vec![VARIANT.to_owned()];
    heading.extend(sweep.dimensions().iter().map(|it| quoted(&it.name)));
    for it in &stacked.quantities {
        let name = it.quantity.name();
        let labels = it.quantity.along().and_then(|along| {
            let mut labels = stacked.labels.iter();
            labels.find(|(known, _)| known == along)
        });
        match labels {
            None => heading.push(name.to_owned()),
            Some((_, labels)) => {
                let labels = (0..labels.len()).map(|at| labels.text(at));
                heading.extend(labels.map(|label| quoted(&format!("{name}[{label}]"))));
            }
        }
    }
    heading.push("error".to_owned());
    writeln!(file, "{}", heading.join(","))?;
    for (index, error) in stacked.errors.iter().enumerate() {
        let mut row = vec![index.to_string()];
        let places = sweep.dimensions().iter().zip(sweep.indices(index));
        row.extend(places.map(|(dimension, at)| quoted(&dimension.values.text(at))));
        for it in &stacked.quantities {
            let width = it.values.len() / sweep.len();
            let values = &it.values[index * width..][..width];
            // The shortest digits that read back to the same number.
            row.extend(values.iter().map(|value| format!("{value:?}")));
        }
        row.push(quoted(error));
        writeln!(file, "{}", row.join(","))?;
    }
    let incomplete = match ending {
        Ending::Complete => None,
        Ending::Interrupted => Some("interrupted"),
        Ending::None => Some("running"),
        Ending::Failed(reason) => Some(reason.as_str()),
    };
    if let Some(reason) = incomplete {
        writeln!(file, "# incomplete: {reason}")?;
    }
    file.into_inner()
        .map_err(IntoInnerError::into_error)?
        .sync_all()?;
    fs::rename(&part, path)
}
