//! Results as CSV: time, and a column `channel[label] [unit]` for every entry of every channel.
//!
//! Rows appear as they come. Logged contacts go to a second table, `run.events.csv` beside `run.csv`. A table that is not
//! at its end closes with a comment line that says so, at any time and however the program dies. The table of a sweep is
//! written elsewhere, but known here.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use chaindrive::channel::labels;
use chaindrive::record::{Claim, Ending, EventColumn, Existing, WriteError};
use chaindrive::{
    Channel, ContactEvent, EventKinds, EventTable, Recording, Simulation, cell, one_line,
};

use crate::failure::Failure;

/// The first column of a run.
const TIME: &str = "time";

/// The first column of a sweep.
pub(crate) const VARIANT: &str = "variant";

/// Rows are written when there are so many bytes of them, or after so long.
const COMMIT_BYTES: usize = 1 << 20;
const COMMIT_EVERY: Duration = Duration::from_secs(1);

/// A run as a table, and its contacts as another one.
#[derive(Debug)]
pub(crate) struct CsvWriter {
    samples: Table,
    contacts: Option<Table>,
    /// The last sample, and the last contact.
    row: Recording,
    contact: EventTable,
}

/// Claims of both places of a run, before its work begins.
#[derive(Debug)]
pub(crate) struct RunClaims {
    samples: TableClaim,
    contacts: TableClaim,
}

impl RunClaims {
    /// Claims the place of the samples, and that of the contacts beside it.
    pub(crate) fn take(path: &Path, existing: Existing) -> Result<Self, Failure> {
        Ok(Self {
            samples: claim(path, existing)?,
            // Nobody has named this place: samples that are there are another run's.
            contacts: claim_table(
                &path.with_extension("events.csv"),
                existing,
                &[EventColumn::Kind.name()],
            )?,
        })
    }
}

impl CsvWriter {
    /// Opens the files and writes their headings.
    pub(crate) fn create(
        claims: RunClaims,
        simulation: &Simulation,
        channels: &[Channel],
        events: EventKinds,
    ) -> Result<Self, Failure> {
        let RunClaims { samples, contacts } = claims;
        // Contacts of an earlier run do not stay beside the samples of this one.
        let contacts = if events == EventKinds::default() {
            contacts.remove()?;
            None
        } else {
            let heading = EventColumn::ALL.map(|it| named(it.name(), it.unit()));
            Some(Table::begin(contacts, &heading)?)
        };
        let samples = Table::begin(samples, &heading(simulation, channels))?;
        Ok(Self {
            samples,
            contacts,
            row: Recording::new(channels, simulation.system()),
            contact: EventTable::new(simulation.system()),
        })
    }

    /// Writes the last sample of the simulation, and the contacts that have ended.
    pub(crate) fn push(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        self.row.clear();
        self.row.push(simulation.observation());
        self.samples.push(cells(&self.row))?;
        self.push_contacts(simulation.events())
    }

    fn push_contacts(&mut self, events: &[ContactEvent]) -> Result<(), Failure> {
        let Some(table) = &mut self.contacts else {
            return Ok(());
        };
        for event in events {
            self.contact.clear();
            self.contact.push(event);
            let cells = EventColumn::ALL.map(|column| match column {
                EventColumn::Kind => self.contact.kind.concat(),
                EventColumn::Body => cell(&self.contact.body.concat()).into_owned(),
                EventColumn::Roller => self.contact.roller.iter().map(i64::to_string).collect(),
                _ => self
                    .contact
                    .numbers(column)
                    .into_iter()
                    .flatten()
                    .copied()
                    .map(digits)
                    .collect(),
            });
            table.push(cells)?;
        }
        table.keep_up()
    }

    /// Closes the files, and says in them how the run ended.
    pub(crate) fn finish(
        mut self,
        simulation: &Simulation,
        ending: &Ending,
    ) -> Result<(), Failure> {
        self.push_contacts(&simulation.outstanding_events())?;
        if let Some(contacts) = self.contacts {
            contacts.finish(ending)?;
        }
        self.samples.finish(ending)
    }
}

/// The shortest digits that read back to the same number.
pub(crate) fn digits(value: f64) -> String {
    format!("{value:?}")
}

/// The cells of one sample.
pub(crate) fn cells(sample: &Recording) -> impl Iterator<Item = String> {
    let columns = sample.columns.iter().flat_map(|column| &column.values);
    sample.time.iter().chain(columns).copied().map(digits)
}

/// Last line of a table that is not at its end.
pub(crate) fn incomplete(ending: &Ending) -> Option<String> {
    let reason = match ending {
        Ending::Complete => return None,
        Ending::None => "running",
        Ending::Interrupted => "interrupted",
        Ending::Failed(reason) => reason,
    };
    Some(format!(
        "# incomplete: {}\n",
        one_line(&reason.replace('\n', "; "))
    ))
}

/// The shortest last line of a table that failed. It is no longer than the one of a table that is running.
fn failed_line() -> String {
    incomplete(&Ending::Failed("failed".to_owned())).expect("a failure is no end")
}

/// A table in the making. After its last row a line says that it is still running.
#[derive(Debug)]
struct Table {
    claimed: TableClaim,
    file: File,
    /// Length of the heading and the rows in the file.
    length: u64,
    /// Rows to be written.
    pending: csv::Writer<Vec<u8>>,
    committed: Instant,
    ended: bool,
}

impl Table {
    fn begin(claimed: TableClaim, heading: &[String]) -> Result<Self, Failure> {
        let made = File::create(claimed.claim.workshop());
        let mut table = Self {
            file: made.map_err(|source| failed(&claimed.path, source))?,
            claimed,
            length: 0,
            pending: csv::Writer::from_writer(Vec::new()),
            committed: Instant::now(),
            ended: false,
        };
        let written = table.add(heading).and_then(|()| table.write());
        written.map_err(|source| failed(&table.claimed.path, source))?;
        table.claimed.claim.put_in_place()?;
        Ok(table)
    }

    fn add(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) -> io::Result<()> {
        Ok(self.pending.write_record(cells)?)
    }

    fn push(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) -> Result<(), Failure> {
        let added = self.add(cells);
        added.map_err(|source| failed(&self.claimed.path, source))?;
        self.keep_up()
    }

    /// Writes the rows if the last time was a while ago.
    fn keep_up(&mut self) -> Result<(), Failure> {
        if self.pending.get_ref().len() < COMMIT_BYTES && self.committed.elapsed() < COMMIT_EVERY {
            return Ok(());
        }
        self.commit()
    }

    fn commit(&mut self) -> Result<(), Failure> {
        if !self.claimed.claim.holds(&self.file) {
            self.ended = true;
            let (path, what) = (self.claimed.path.clone(), "the result".into());
            return Err(WriteError::Vanished { path, what }.into());
        }
        let written = self.write();
        written.map_err(|source| {
            self.give_up(&format!("the result could not be written: {source}"));
            failed(&self.claimed.path, source)
        })
    }

    fn write(&mut self) -> io::Result<()> {
        let empty = csv::Writer::from_writer(Vec::new());
        let pending = std::mem::replace(&mut self.pending, empty).into_inner();
        let mut pending = pending.map_err(csv::IntoInnerError::into_error)?;
        let rows = pending.len() as u64;
        pending.extend(incomplete(&Ending::None).unwrap_or_default().into_bytes());
        self.file.seek(SeekFrom::Start(self.length))?;
        let written = self.file.write_all(&pending);
        if written.is_err() {
            // On a full disk some of the rows are there. Whole ones are kept that leave room for a closing line.
            let room = failed_line().len() as u64;
            let end = self
                .file
                .metadata()?
                .len()
                .saturating_sub(self.length + room);
            let there = &pending[..usize::try_from(end.min(rows)).unwrap_or(0)];
            self.length += there
                .iter()
                .rposition(|&b| b == b'\n')
                .map_or(0, |at| at as u64 + 1);
        } else {
            self.length += rows;
        }
        self.committed = Instant::now();
        written
    }

    /// Closes the table, and says in it how the run ended.
    fn finish(mut self, ending: &Ending) -> Result<(), Failure> {
        self.commit()?;
        self.ended = true;
        if let Err(source) = self.close(incomplete(ending)) {
            // Some of a long line may stand there.
            self.give_up(&format!("the result could not be written: {source}"));
            return Err(failed(&self.claimed.path, source));
        }
        Ok(())
    }

    /// Puts a last line in the place of the one that says that the run goes on.
    fn close(&mut self, last: Option<String>) -> io::Result<()> {
        let last = last.unwrap_or_default();
        self.file.seek(SeekFrom::Start(self.length))?;
        self.file.write_all(last.as_bytes())?;
        self.file.set_len(self.length + last.len() as u64)
    }

    /// Keeps the rows that were written whole, and says why there are no more.
    fn give_up(&mut self, reason: &str) {
        self.ended = true;
        let full = incomplete(&Ending::Failed(reason.to_owned()));
        // Nothing is cut off beforehand: what stands there is room on a full disk, enough for the shorter line.
        for last in [full, Some(failed_line())] {
            if self.close(last).is_ok() {
                return;
            }
        }
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        if !self.ended {
            // Whoever drops a table has an error of his own to report.
            let _ = self.write();
            self.give_up("the program gave the result up before its end");
        }
    }
}

/// The headings of a run.
pub(crate) fn heading(simulation: &Simulation, channels: &[Channel]) -> Vec<String> {
    let mut headings = vec![named(TIME, Some("s"))];
    for channel in channels {
        let name = channel.name();
        let units = channel.units(simulation.system());
        match labels(channel.axis(), simulation.system()) {
            None => headings.extend(units.into_iter().map(|unit| named(name, Some(unit)))),
            Some(labels) => {
                let entries = labels.iter().zip(units);
                let heading = |(label, unit)| named(&format!("{name}[{label}]"), Some(unit));
                headings.extend(entries.map(heading));
            }
        }
    }
    headings
}

/// The heading of a column.
pub(crate) fn named(name: &str, unit: Option<&str>) -> String {
    let name = cell(name);
    unit.map_or_else(|| name.to_string(), |unit| format!("{name} [{unit}]"))
}

pub(crate) fn failed(path: &Path, source: io::Error) -> Failure {
    Failure::File {
        path: path.display().to_string(),
        source,
    }
}

/// Claim of the path of a table: the right to write there.
#[derive(Debug)]
pub(crate) struct TableClaim {
    pub(crate) claim: Claim,
    pub(crate) path: PathBuf,
}

impl TableClaim {
    /// Removes an earlier table.
    fn remove(self) -> Result<(), Failure> {
        match fs::remove_file(self.claim.place()) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(&self.path, error)),
            _ => Ok(()),
        }
    }
}

/// Claims a place for a table: an empty one, or that of an earlier table.
pub(crate) fn claim(path: &Path, existing: Existing) -> Result<TableClaim, Failure> {
    claim_table(path, existing, &[TIME, VARIANT, EventColumn::Kind.name()])
}

/// Claims an empty place, or that of an earlier table with one of these first columns.
fn claim_table(path: &Path, existing: Existing, firsts: &[&str]) -> Result<TableClaim, Failure> {
    let taken = |found, hint| Failure::Taken {
        path: path.display().to_string(),
        found,
        hint,
    };
    // As every verb does it: folders that are missing are made, links are refused.
    if path.is_symlink() {
        return Err(taken(
            "there is a symbolic link here, which is neither followed nor replaced",
            "",
        ));
    }
    if let Some(folder) = path.parent().filter(|it| !it.exists()) {
        fs::create_dir_all(folder).map_err(|source| failed(path, source))?;
    }
    let claimed = TableClaim {
        claim: Claim::take(path)?,
        path: path.to_owned(),
    };
    let place = claimed.claim.place();
    if !place.exists() {
        return Ok(claimed);
    }
    if !place.is_file() || !is_table(place, firsts).map_err(|source| failed(path, source))? {
        return Err(taken("this is not a table of chaindrive", ""));
    }
    if existing == Existing::Keep {
        return Err(taken(
            "there is already a result here",
            ", or pass --overwrite",
        ));
    }
    Ok(claimed)
}

/// Tells an empty file, or a table with one of these first columns, from another.
fn is_table(path: &Path, firsts: &[&str]) -> io::Result<bool> {
    let longest = firsts.iter().map(|first| first.len()).max().unwrap_or(0);
    let mut begin = Vec::new();
    File::open(path)?
        .take(longest as u64 + 1)
        .read_to_end(&mut begin)?;
    let begins_with = |first: &&str| {
        let rest = begin.strip_prefix(first.as_bytes());
        rest.is_some_and(|rest| matches!(rest.first(), Some(b',' | b'\n' | b' ')))
    };
    Ok(begin.is_empty() || firsts.iter().any(begins_with))
}
