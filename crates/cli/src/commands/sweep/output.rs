//! The table of a sweep in memory, with a row a variant.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use chaindrive::record::{Ending, Existing};
use chaindrive::sweep::{Coordinate, Outcome, Progress, Stacked, Sweep};

use crate::csv::{Claimed, VARIANT, claim, failed, incomplete, named};
use crate::failure::Failure;
use crate::stream::{Cells, Column};

/// Wall time between two writes while the sweep goes on.
const WRITE_EVERY: Duration = Duration::from_secs(5);

/// Writing takes at most this share of the time, however large the result grows.
const SHARE: u32 = 20;

/// A table in the making, which is written anew as a whole.
#[derive(Debug)]
pub(super) struct Table {
    claimed: Claimed,
    /// Whether it says in its place that the sweep goes on.
    running: bool,
    /// Variants that were finished when it was last written.
    known: usize,
    written: Instant,
    /// Time that writing took.
    took: Duration,
}

impl Table {
    /// Claims the place of a table.
    pub(super) fn begin(path: &Path, sweep: &Sweep, existing: Existing) -> Result<Self, Failure> {
        refuse_channels(path, sweep)?;
        Ok(Self {
            claimed: claim(path, existing)?,
            running: false,
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

    /// Writes what is known of all variants, and how the sweep ended: beside its place, and moves it there, so that it is whole at
    /// any time.
    pub(super) fn write(
        &mut self,
        sweep: &Sweep,
        outcomes: &[Outcome],
        ending: &Ending,
    ) -> Result<(), Failure> {
        let (claim, stacked) = (&self.claimed.claim, sweep.stack(outcomes));
        let made =
            File::create(claim.workshop()).and_then(|file| fill(file, sweep, &stacked, ending));
        made.map_err(|source| failed(&self.claimed.path, source))?;
        claim.put_in_place()?;
        self.running = *ending == Ending::None;
        Ok(())
    }

    /// Says in the place of `running` that it does not any more: that takes no space on a full disk.
    fn give_up(&self) -> io::Result<()> {
        let running = incomplete(&Ending::None).unwrap_or_default();
        let failed = incomplete(&Ending::Failed("failed".into())).unwrap_or_default();
        let mut file = OpenOptions::new()
            .write(true)
            .open(self.claimed.claim.place())?;
        let last = file.metadata()?.len().saturating_sub(running.len() as u64);
        file.seek(SeekFrom::Start(last))?;
        file.write_all(failed.as_bytes())?;
        file.set_len(last + failed.len() as u64)
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        if self.running {
            // Whoever drops a table has an error of his own to report.
            let _ = self.give_up();
        }
    }
}

/// Refuses channels, which fill more than a row a variant.
pub(super) fn refuse_channels(path: &Path, sweep: &Sweep) -> Result<(), Failure> {
    if sweep.record().is_empty() {
        return Ok(());
    }
    Err(Failure::Argument(format!(
        "{}: a table has no place for the channels of --record; take a .zarr store",
        path.display()
    )))
}

fn fill(file: File, sweep: &Sweep, stacked: &Stacked, ending: &Ending) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(file);
    let columns = columns(sweep, stacked);
    table.write_record(columns.iter().map(|it| named(&it.name, it.unit.as_deref())))?;
    for index in 0..sweep.len() {
        table.write_record(columns.iter().map(|it| it.cells.text(index)))?;
    }
    let mut file = table
        .into_inner()
        .map_err(csv::IntoInnerError::into_error)?;
    write!(file, "{}", incomplete(ending).unwrap_or_default())?;
    file.sync_all()
}

/// The table of a sweep, with a row a variant.
pub(super) fn columns(sweep: &Sweep, stacked: &Stacked) -> Vec<Column> {
    let variants = i64::try_from(sweep.len()).unwrap_or(i64::MAX);
    let mut columns = vec![Column {
        name: VARIANT.to_owned(),
        unit: None,
        cells: Cells::Whole((0..variants).collect()),
    }];
    let indices: Vec<Vec<usize>> = (0..sweep.len()).map(|it| sweep.indices(it)).collect();
    for (which, dimension) in sweep.dimensions().iter().enumerate() {
        let at = indices.iter().map(|indices| indices[which]);
        columns.push(Column {
            name: dimension.name.clone(),
            unit: dimension.unit.map(str::to_owned),
            cells: match &dimension.values {
                Coordinate::Numbers(numbers) => Cells::Numbers(at.map(|at| numbers[at]).collect()),
                Coordinate::Whole(numbers) => Cells::Whole(at.map(|at| numbers[at]).collect()),
                Coordinate::Texts(texts) => Cells::Texts(at.map(|at| texts[at].clone()).collect()),
            },
        });
    }
    for it in &stacked.quantities {
        let (name, width) = (it.quantity.name(), it.values.len() / sweep.len());
        let labels = it.quantity.along().and_then(|along| {
            let mut labels = stacked.labels.iter();
            labels.find(|(known, _)| known == along)
        });
        columns.extend((0..width).map(|entry| {
            Column {
                name: match labels {
                    None => name.to_owned(),
                    Some((_, labels)) => format!("{name}[{}]", labels.text(entry)),
                },
                unit: Some(it.unit.clone()),
                cells: Cells::Numbers(
                    it.values
                        .iter()
                        .skip(entry)
                        .step_by(width)
                        .copied()
                        .collect(),
                ),
            }
        }));
    }
    columns.extend(stacked.texts.iter().map(|it| Column {
        name: it.name.to_owned(),
        unit: None,
        cells: Cells::Texts(it.texts.clone()),
    }));
    columns
}
