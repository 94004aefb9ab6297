//! The table of a sweep in memory, with a row a variant.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use chaindrive::record::{Ending, Existing};
use chaindrive::sweep::{Outcome, Progress, Stacked, Sweep};

use crate::csv::{Claimed, VARIANT, claim, failed, incomplete, named};
use crate::failure::Failure;

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
        if !sweep.record().is_empty() {
            return Err(Failure::Argument(format!(
                "{}: a table has no place for the channels of --record; take a .zarr store",
                path.display()
            )));
        }
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

fn fill(file: File, sweep: &Sweep, stacked: &Stacked, ending: &Ending) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(file);
    let mut heading = vec![VARIANT.to_owned()];
    let swept = sweep.dimensions().iter();
    heading.extend(swept.map(|it| named(&it.name, it.unit)));
    for it in &stacked.quantities {
        let (name, unit) = (it.quantity.name(), it.unit.as_str());
        let labels = it.quantity.along().and_then(|along| {
            let mut labels = stacked.labels.iter();
            labels.find(|(known, _)| known == along)
        });
        match labels {
            None => heading.push(named(name, Some(unit))),
            Some((_, labels)) => {
                let labels = (0..labels.len()).map(|at| labels.text(at));
                heading.extend(labels.map(|label| named(&format!("{name}[{label}]"), Some(unit))));
            }
        }
    }
    heading.extend(stacked.texts.iter().map(|it| it.name.to_owned()));
    table.write_record(heading)?;
    for index in 0..sweep.len() {
        let mut row = vec![index.to_string()];
        let places = sweep.dimensions().iter().zip(sweep.indices(index));
        row.extend(places.map(|(dimension, at)| dimension.values.text(at)));
        for it in &stacked.quantities {
            let width = it.values.len() / sweep.len();
            let values = &it.values[index * width..][..width];
            // The shortest digits that read back to the same number.
            row.extend(values.iter().map(|value| format!("{value:?}")));
        }
        row.extend(stacked.texts.iter().map(|it| it.texts[index].clone()));
        table.write_record(row)?;
    }
    let mut file = table
        .into_inner()
        .map_err(csv::IntoInnerError::into_error)?;
    write!(file, "{}", incomplete(ending).unwrap_or_default())?;
    file.sync_all()
}
