//! The table of a sweep in memory, with a row a variant.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use chaindrive::cell;
use chaindrive::record::{Ending, Existing};
use chaindrive::sweep::{Outcome, Progress, Sweep, SweepArrays};

use crate::csv::{TableClaim, VARIANT, claim, digits, failed, incomplete, named};
use crate::failure::Failure;

/// Wall time between two writes while the sweep goes on.
const WRITE_EVERY: Duration = Duration::from_secs(5);

/// Writing takes at most this share of the time, however large the result grows.
const SHARE: u32 = 20;

/// A table in the making, which is written anew as a whole.
#[derive(Debug)]
pub(super) struct Table {
    claimed: TableClaim,
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
        let made = File::create(claim.workshop());
        let made = made.and_then(|file| fill(file, sweep, &stacked, ending)?.sync_all());
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

/// Writes the table, with a row a variant, and hands back what it was written to.
pub(super) fn fill<W: Write>(
    to: W,
    sweep: &Sweep,
    stacked: &SweepArrays,
    ending: &Ending,
) -> io::Result<W> {
    let mut table = csv::Writer::from_writer(to);
    let columns = columns(sweep, stacked);
    table.write_record(columns.iter().map(|(heading, _)| heading))?;
    for variant in 0..sweep.len() {
        table.write_record(columns.iter().map(|(_, cell)| cell(variant)))?;
    }
    let mut to = table
        .into_inner()
        .map_err(csv::IntoInnerError::into_error)?;
    write!(to, "{}", incomplete(ending).unwrap_or_default())?;
    to.flush()?;
    Ok(to)
}

/// The heading of a column, and its cell by the number of the variant.
type Column<'a> = (String, Box<dyn Fn(usize) -> String + 'a>);

/// What tells the variants apart, the statistics of each, and what is said of it.
fn columns<'a>(sweep: &'a Sweep, stacked: &'a SweepArrays) -> Vec<Column<'a>> {
    let mut columns: Vec<Column<'a>> =
        vec![(VARIANT.to_owned(), Box::new(|variant| variant.to_string()))];
    for (which, dimension) in sweep.dimensions().iter().enumerate() {
        columns.push((
            named(&dimension.name, dimension.unit),
            Box::new(move |variant| {
                cell(&dimension.values.text(sweep.indices(variant)[which])).into_owned()
            }),
        ));
    }
    for it in &stacked.quantities {
        let (name, width) = (it.quantity.name(), it.values.len() / sweep.len());
        let labels = it.quantity.along().and_then(|along| {
            let mut labels = stacked.labels.iter();
            labels.find(|(known, _)| known == along)
        });
        for entry in 0..width {
            let name = match labels {
                None => name.to_owned(),
                Some((_, labels)) => format!("{name}[{}]", labels.text(entry)),
            };
            columns.push((
                named(&name, Some(&it.unit)),
                Box::new(move |variant| digits(it.values[variant * width + entry])),
            ));
        }
    }
    for it in &stacked.texts {
        columns.push((
            it.name.to_owned(),
            Box::new(|variant| cell(&it.texts[variant]).into_owned()),
        ));
    }
    columns
}
