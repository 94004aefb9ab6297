//! Samples and restart points that may become the start of the record.

use std::collections::VecDeque;

use chaindrive_mechanics::{Assembled, Observation, Sights};

use super::counted;
use crate::run_in::{RecordStart, RunInReport};
use crate::simulate::Sample;
use crate::{Run, RunIn, Simulation, SimulationError};

/// Restart points that are kept at most, and a few more: each has a copy of the drive, and among so many one is near enough.
const MOST_STARTS: usize = 32;
/// Room \[bytes\] for samples; a record that needs more begins later. *Assumed*: what every computer has to spare.
const ROOM: usize = 256 << 20;

/// A drive as it stands at the beginning of a block, and the number of the sample there.
type Restart = (Assembled, usize);

/// A drive in motion, with the last samples and restart points of it.
pub(super) struct RecordBuffer<'a> {
    simulation: Simulation,
    run: &'a Run,
    stop: &'a dyn Fn() -> bool,
    /// Time of the first sample \[s\].
    from: f64,
    /// By block, as far as they are kept; the last one is taken with the next sample.
    starts: Vec<Option<Restart>>,
    /// The last samples, and how many were taken before them.
    samples: VecDeque<Box<Sample>>,
    before: usize,
    /// The one that was forgotten last, for its room.
    spare: Box<Sample>,
    /// Samples that are kept at most.
    most: usize,
}

impl<'a> RecordBuffer<'a> {
    pub(super) fn new(
        start: &Assembled,
        run: &'a Run,
        sights: Sights,
        stop: &'a dyn Fn() -> bool,
    ) -> Result<Self, SimulationError> {
        let plain = Run {
            run_in: RunIn::None,
            ..run.clone()
        };
        let from = start.time;
        let mut simulation = Simulation::from_assembled(start.clone(), &plain)?;
        // Where a record begins does not hang on what it records.
        let bytes = size_of::<f64>() * simulation.numbers();
        simulation.sample_only(sights);
        let first = simulation.take_sample(from, false, Box::default(), stop)?.0;
        let wanted = counted(run.until / run.every + 1.0);
        Ok(Self {
            simulation,
            run,
            stop,
            from,
            starts: vec![Some((start.clone().recorded_from(from), 0))],
            samples: VecDeque::from([first]),
            before: 0,
            spare: Box::default(),
            most: wanted.min(ROOM / bytes.max(1)).max(1),
        })
    }

    /// Reads everything off the drive at a time \[s\], with the samples before it on the way.
    pub(super) fn look(&mut self, time: f64) -> Result<&Observation, SimulationError> {
        while self.next() < time {
            self.take()?;
        }
        self.simulation.look(time, self.stop)
    }

    /// Time of the next sample \[s\].
    fn next(&self) -> f64 {
        self.from + (self.before + self.samples.len()) as f64 * self.run.every
    }

    /// Takes a sample, and the restart point of a block that has ended since the last one.
    fn take(&mut self) -> Result<(), SimulationError> {
        let number = self.before + self.samples.len();
        let time = self.next();
        let due = self.starts.last().is_some_and(Option::is_none);
        let spare = std::mem::take(&mut self.spare);
        let (sample, start) = self.simulation.take_sample(time, due, spare, self.stop)?;
        if let (Some(start), Some(last)) = (start, self.starts.last_mut()) {
            *last = Some((start.recorded_from(time), number));
        }
        self.samples.push_back(sample);
        if self.samples.len() > self.most {
            self.spare = self.samples.pop_front().unwrap_or_default();
            self.before += 1;
        }
        Ok(())
    }

    /// Ends a block: the next one has a restart point at its first sample.
    pub(super) fn end_block(&mut self) {
        self.starts.push(None);
    }

    /// Whether the restart point of a block is there.
    pub(super) fn can_begin(&self, block: usize) -> bool {
        self.starts[block].is_some()
    }

    /// Forgets restart points before a block, and all but every second, fourth, … of many after it.
    pub(super) fn thin_out(&mut self, earliest: usize) {
        let last = self.starts.len() - 1;
        self.starts[..earliest].fill(None);
        let apart = (last / MOST_STARTS).next_power_of_two();
        for between in (earliest..last).filter(|d| d % apart != 0) {
            self.starts[between] = None;
        }
    }

    /// The record of a run-in that cannot go on, with what there is of it: that fails as well.
    ///
    /// # Errors
    /// The failure, where the record would end before it.
    pub(super) fn failed(
        mut self,
        failure: SimulationError,
    ) -> Result<RecordStart, SimulationError> {
        while self.starts.last().is_some_and(Option::is_none) {
            self.starts.pop();
        }
        let last = self.starts.last().and_then(Option::as_ref);
        let reached = self.simulation.time();
        if last.is_none_or(|(start, _)| start.zero + self.run.until < reached) {
            return Err(failure);
        }
        self.begin_from(0, false)
    }

    /// The record that begins at the first restart point from a block on that is near enough to the end.
    pub(super) fn begin_from(
        mut self,
        block: usize,
        is_steady: bool,
    ) -> Result<RecordStart, SimulationError> {
        while self.starts.last().is_some_and(Option::is_none) {
            self.take()?;
        }
        let (time, before) = (self.simulation.time(), self.before);
        let is_near =
            |(start, number): &Restart| time - start.zero <= self.run.until && *number >= before;
        let mut known: Vec<_> = self.starts.drain(block..).flatten().collect();
        // The last one is at the end, whatever is shorter than a step.
        let first = known.iter().position(is_near);
        let (start, number) = known.swap_remove(first.unwrap_or(known.len() - 1));
        let ahead = self.samples.drain(number - before..);
        let simulation = self.simulation.begun_at(start.clone(), self.run, ahead);
        Ok(RecordStart {
            simulation: Some(simulation),
            ran_in: Some(RunInReport::lasted(start.zero, Some(is_steady))),
            start,
        })
    }
}
