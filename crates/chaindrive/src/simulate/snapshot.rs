//! A simulation as it was at a moment: in memory, or as bytes for a file or another process.

use std::fmt::{self, Write};
use std::sync::Arc;

use chaindrive_integrate::{IntegrationError, SecondOrderSystem, State, StepperMemory};
use chaindrive_mechanics::{
    ContactEvent, Course, Energy, Impact, Input, MemoryError, Observation, Record, SystemMemory,
};
use serde::{Deserialize, Serialize};

use super::{Moving, Period, PeriodEnd, Simulation};
use crate::seal::{SealedValue, opened, sealed};
use crate::{SealError, SimulationError};

/// A simulation as it was at a moment, to the last bit: contacts, windows and the time stepping with its memory.
///
/// All that follows from the drive is left out: a snapshot is put back into a simulation of the same drive that was begun
/// in the same way.
///
/// # Example
///
/// ```
/// use chaindrive::{Run, Scene, Simulation, Snapshot};
///
/// let drive = Scene::preset("spinning_ring")?.drive()?;
/// let mut simulation = Simulation::start(&drive, &Run::default())?;
/// simulation.advance_to(1e-3)?;
/// let bytes = simulation.snapshot().to_bytes();
/// let tension = simulation.advance_to(2e-3)?.link_tension[0];
///
/// let mut another = Simulation::start(&drive, &Run::default())?;
/// another.restore(&Snapshot::from_bytes(&bytes)?)?;
/// assert_eq!(another.advance_to(2e-3)?.link_tension[0].to_bits(), tension.to_bits());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot {
    /// Of the simulation, see [`Simulation::fingerprint`].
    fingerprint: u32,
    moving: DriveMemory,
    /// Handed out at the last reading, and since then.
    ended: [Vec<ContactEvent>; 2],
    struck: [Vec<Impact>; 2],
    periods: [Vec<Period>; 2],
    readings: [Vec<f64>; 2],
    period_end: PeriodEnd,
    before: Option<PreviousState>,
    /// Time reached \[s\].
    time: f64,
    read: f64,
    next: u64,
    observation: Box<Observation>,
    start_energy: Option<Energy>,
}

/// State of a drive in motion that does not follow from the drive.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DriveMemory {
    system: SystemMemory,
    state: State,
    stepper: StepperMemory<Record>,
}

/// State before the last step, kept so that a change at a time within that step can begin there.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PreviousState {
    moving: DriveMemory,
    /// What had been gathered since the last reading, and where the last period had ended.
    pub(super) gathered: [usize; 4],
    period_end: PeriodEnd,
    /// Time of the first event after it \[s\].
    event: f64,
    /// Plans made since then.
    planned: Vec<(f64, Input, Course)>,
}

impl PreviousState {
    /// The drive as it stands now, with what ended until now taken in.
    pub(super) fn of(simulation: &Simulation) -> Self {
        let moving = &simulation.moving;
        Self {
            moving: moving.remembered(),
            gathered: simulation.gathered(),
            period_end: simulation.period_end.clone(),
            event: moving.system.next_event(moving.state.t),
            planned: Vec::new(),
        }
    }

    /// Takes note of a plan, which going back does not undo.
    pub(super) fn plan(&mut self, time: f64, input: Input, course: Course) {
        self.planned.push((time, input, course));
    }
}

/// Why a simulation cannot go back to a snapshot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// It is of something else.
    #[error(
        "the snapshot is of another drive, or of a simulation that was begun with another method, step or interval"
    )]
    Other,

    /// Its parts are not those of the drive.
    #[error("the snapshot does not fit: {0}")]
    Memory(#[from] MemoryError),

    /// Its state is not that of the drive.
    #[error("the snapshot does not fit: {0}")]
    State(#[from] IntegrationError),
}

impl SealedValue for Snapshot {
    const KIND: &'static str = "snapshot";
}

impl Snapshot {
    /// Time that the simulation had reached \[s\].
    pub(crate) fn time(&self) -> f64 {
        self.time
    }

    /// The snapshot as bytes, for this version of the program to read back.
    pub fn to_bytes(&self) -> Vec<u8> {
        sealed(self)
    }

    /// The snapshot that was written down.
    ///
    /// # Errors
    /// [`SealError`]: something else, damaged, or of another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SealError> {
        opened(bytes)
    }
}

impl Simulation {
    /// The simulation as it is now.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            fingerprint: self.fingerprint(),
            moving: self.moving.remembered(),
            ended: self.ended.clone(),
            struck: self.struck.clone(),
            periods: self.periods.clone(),
            readings: self.readings.clone(),
            period_end: self.period_end.clone(),
            before: self.before.as_deref().cloned(),
            time: self.time(),
            read: self.read,
            next: self.next,
            observation: Box::new(self.observation.clone()),
            start_energy: self.start_energy,
        }
    }

    /// Goes back, or on, to what a snapshot holds; wall time spent is not taken back.
    ///
    /// # Errors
    /// [`SnapshotError`] for a snapshot of something else. Nothing is changed then.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotError> {
        if snapshot.fingerprint != self.fingerprint() {
            return Err(SnapshotError::Other);
        }
        let moving = self.recalled(&snapshot.moving)?;
        if let Some(before) = &snapshot.before {
            self.recalled(&before.moving)?;
            let all = [
                snapshot.ended[1].len(),
                snapshot.struck[1].len(),
                snapshot.periods[1].len(),
                snapshot.readings[1].len(),
            ];
            if before.gathered.iter().zip(all).any(|(own, all)| *own > all) {
                return Err(SnapshotError::Other);
            }
        }
        self.before = snapshot.before.clone().map(Box::new);
        self.moving = moving;
        self.ended.clone_from(&snapshot.ended);
        self.struck.clone_from(&snapshot.struck);
        self.periods.clone_from(&snapshot.periods);
        self.readings.clone_from(&snapshot.readings);
        self.period_end = snapshot.period_end.clone();
        self.ahead.clear();
        self.read = snapshot.read;
        self.next = snapshot.next;
        self.observation.clone_from(&snapshot.observation);
        self.start_energy = snapshot.start_energy;
        Ok(())
    }

    /// The drive as it stood before the last step.
    pub(super) fn as_before(&self, before: &PreviousState) -> Result<Moving, SnapshotError> {
        self.recalled(&before.moving)
    }

    /// Goes back to before the last step, with what was planned since then.
    pub(super) fn go_back(&mut self, before: PreviousState) -> Result<(), SimulationError> {
        let PreviousState {
            moving: then,
            gathered: [contacts, impacts, periods, readings],
            period_end,
            event,
            planned,
        } = before;
        self.ended[1].truncate(contacts);
        self.struck[1].truncate(impacts);
        self.periods[1].truncate(periods);
        self.readings[1].truncate(readings);
        self.period_end = period_end;
        let own = "the memory is of this drive";
        if event > self.moving.state.t {
            // Nothing was set in that step, and all else is memory.
            self.moving.take_back(then).expect(own);
        } else {
            self.moving = self.recalled(&then).expect(own);
        }
        for (time, input, course) in planned {
            self.moving.plan(time, input, course)?;
        }
        Ok(())
    }

    /// The drive in motion that remembers what it did then.
    fn recalled(&self, then: &DriveMemory) -> Result<Moving, SnapshotError> {
        let mut system = self.assembled.system.clone();
        system.set_onset_depth(self.moving.system.onset_depth());
        system.log_events(self.events);
        system.watch(self.moving.system.watch_plan().cloned());
        system.remember(then.system.clone())?;
        if let Some(record) = then.stepper.record() {
            system.check_record(record)?;
        }
        let mut stepper = self.moving.stepper.clone();
        stepper.remember(&system, &then.state, then.stepper.clone())?;
        Ok(Moving {
            system,
            state: then.state.clone(),
            stepper,
        })
    }

    /// A number that tells simulations apart whose snapshots do not go together: the drive in full, the method with its step,
    /// the interval between samples, and what is logged.
    fn fingerprint(&self) -> u32 {
        let mut print = Fingerprint::default();
        let assembled = Arc::as_ref(&self.assembled);
        let depth = self.moving.system.onset_depth();
        let begun = (self.moving.stepper.method(), self.every, depth, self.events);
        // Nothing is written anywhere that could refuse.
        let _ = write!(print, "{:?} {begun:?}", assembled.drive);
        print.0.finalize()
    }
}

impl Moving {
    /// Goes back to what it remembered, since when nothing was set.
    fn take_back(&mut self, then: DriveMemory) -> Result<(), SnapshotError> {
        let DriveMemory {
            system,
            state,
            stepper,
        } = then;
        self.system.remember(system)?;
        self.stepper.remember(&self.system, &state, stepper)?;
        self.state = state;
        Ok(())
    }

    fn remembered(&self) -> DriveMemory {
        DriveMemory {
            system: self.system.memory(),
            state: self.state.clone(),
            stepper: self.stepper.memory(),
        }
    }
}

/// The checksum of a text that is never put together.
#[derive(Default)]
struct Fingerprint(crc32fast::Hasher);

impl Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}
