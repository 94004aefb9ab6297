//! The run-in: motion before t = 0, so that the record begins where it is steady.

mod steady;

use std::f64::consts::TAU;
use std::fmt;

use chaindrive_mechanics::{Assembled, Drive, EventKinds, Sights};
use serde::{Deserialize, Serialize};

use crate::figure::Measure;
use crate::interruptible::{LOOK, assemble};
use crate::{Run, RunIn, Simulation, SimulationError};

/// Circuits of the chain \[–\] after which a run-in that ends by itself gives up. *Assumed*: what swings longer than that is no
/// start that dies out.
pub const MOST_CIRCUITS: u32 = 32;

/// Observes a run while it is simulated, and may stop it.
pub trait Onlooker {
    /// Whether the user wants it to stop; asked after every sample, and every 50 ms where there is none.
    fn stop(&self) -> bool;

    /// Is told how far the run is, as often as [`stop`](Self::stop) is asked.
    fn see(&self, simulation: &Simulation) {
        let _ = simulation;
    }

    /// Is told how much of the run-in is done, 0 to 1, as often as [`stop`](Self::stop) is asked there. Where a run-in ends by
    /// itself, first how much of the longest that is tried, and then of the one that is carried out.
    fn see_run_in(&self, share: f64) {
        let _ = share;
    }

    /// Whether it wants to be told before a run begins how long that will take, where that is long: then the first steps are taken twice.
    fn asks_for_time(&self) -> bool {
        false
    }

    /// Is told before a run begins how long it will take, in a sentence.
    fn foretell(&self, sentence: &str) {
        let _ = sentence;
    }
}

impl<F: Fn() -> bool> Onlooker for F {
    fn stop(&self) -> bool {
        self()
    }
}

/// Record of a run-in: its length, why it ended, or why there was none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunInReport {
    /// Simulated before t = 0 \[s\].
    pub time: f64,
    /// Whether the tensions were found steady by then; none where the time was given, for nobody checked.
    pub is_steady: Option<bool>,
    /// Run-in by default, not by request.
    pub by_default: bool,
    /// Reason for no run-in by default.
    pub left_out: Option<String>,
}

impl RunInReport {
    /// A run-in longer than nothing: the record begins after the assembly.
    pub(crate) fn has_moved(&self) -> bool {
        self.time > 0.0
    }

    fn lasted(time: f64, is_steady: Option<bool>) -> Self {
        Self {
            time,
            is_steady,
            by_default: false,
            left_out: None,
        }
    }
}

impl fmt::Display for RunInReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(why) = &self.left_out {
            return write!(
                f,
                "The record begins at the start, without a run-in: {why}."
            );
        }
        let time = Measure::Time.told(self.time);
        write!(f, "The drive was run in for {time} before t = 0")?;
        match self.is_steady {
            None => write!(f, ", as asked.")?,
            Some(true) => write!(f, ", until the tension of every span was steady.")?,
            Some(false) => write!(f, ", the longest that is tried; not every span was steady.")?,
        }
        if self.by_default {
            write!(f, " --run-in 0 leaves it out.")?;
        }
        Ok(())
    }
}

impl Simulation {
    /// Assembles the drive, runs it in if the run says so, and starts the clock at t = 0.
    ///
    /// # Errors
    /// [`SimulationError`] when the drive does not assemble, a setting is out of range, the method is
    /// not for this chain, or the step asked for is unstable.
    pub fn start(drive: &Drive, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        let (start, _) = run_in(drive.assemble()?, run, &|| false)?;
        Self::from_assembled(start, run)
    }
}

/// Runs an assembled drive in if the run asks for it, and returns it as it stands at t = 0 of the record.
///
/// The drive is assembled again, so long before, and moved with the method, step and tolerance of the run. What this leaves is
/// a start like any other: the error of the run counts from there. A run-in that ends by itself begins where the clock of the drive does, and leaves it at a
/// time that is the [zero](Assembled::zero) of the record.
///
/// # Errors
/// As [`Simulation::start`]; a sprocket that does not turn, or is not there; [`SimulationError::Interrupted`] when the onlooker
/// says so.
pub fn run_in(
    start: Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<(Assembled, Option<RunInReport>), SimulationError> {
    if run.run_in == RunIn::Usual {
        return Ok((start, None));
    }
    let record = record_start(start, run, Sights::default(), onlooker)?;
    Ok((record.start, record.ran_in))
}

/// Where a record begins.
pub(crate) struct RecordStart {
    /// The drive there.
    pub(crate) start: Assembled,
    /// The run-in before, if there was one or none by default.
    pub(crate) ran_in: Option<RunInReport>,
    /// The simulation of the run-in, where it went on beyond the start of the record: it has samples from there on.
    pub(crate) simulation: Option<Simulation>,
}

impl RecordStart {
    /// The start of a record that nothing is simulated of so far.
    fn at(start: Assembled, ran_in: Option<RunInReport>) -> Self {
        Self {
            start,
            ran_in,
            simulation: None,
        }
    }

    /// A run-in longer than nothing.
    pub(crate) fn has_moved(&self) -> bool {
        self.ran_in.as_ref().is_some_and(RunInReport::has_moved)
    }
}

/// Runs an assembled drive in, if the run says so; samples that are taken there have these sights.
pub(crate) fn record_start(
    start: Assembled,
    run: &Run,
    sights: Sights,
    onlooker: &dyn Onlooker,
) -> Result<RecordStart, SimulationError> {
    let stop = &|| onlooker.stop();
    run.check()?;
    let time = match &run.run_in {
        RunIn::None => return Ok(RecordStart::at(start, None)),
        RunIn::Time(time) => *time,
        RunIn::Turns { turns, sprocket } => turns_last(&start, *turns, sprocket.as_deref())?,
        RunIn::Usual => {
            if let Some(why) = start.why_it_does_not_repeat() {
                let ran_in = RunInReport {
                    by_default: true,
                    left_out: Some(why.to_owned()),
                    ..RunInReport::lasted(0.0, None)
                };
                return Ok(RecordStart::at(start, Some(ran_in)));
            }
            let asked = Run {
                run_in: RunIn::Auto,
                ..run.clone()
            };
            let mut record = record_start(start, &asked, sights, onlooker)?;
            if let Some(ran_in) = &mut record.ran_in {
                ran_in.by_default = true;
            }
            return Ok(record);
        }
        RunIn::Auto => return steady::steady_start(&start, run, sights, onlooker),
    };
    let ran_in = Some(RunInReport::lasted(time, None));
    let mut moving = before(&start.drive, time, run, stop)?;
    onlooker.see_run_in(0.0);
    while !moving.advance(LOOK)? {
        onlooker.see_run_in(1.0 + moving.time() / time);
        if stop() {
            return Err(SimulationError::Interrupted);
        }
    }
    Ok(RecordStart::at(moving.as_start(), ran_in))
}

/// The drive in motion from so long before t = 0 \[s\]; nothing is logged on the way.
fn before(
    drive: &Drive,
    time: f64,
    run: &Run,
    stop: &dyn Fn() -> bool,
) -> Result<Simulation, SimulationError> {
    let start = assemble(&drive.beginning(-time)?, stop)?;
    let silent = Run {
        run_in: RunIn::None,
        events: EventKinds::default(),
        watched: false,
        ..run.clone()
    };
    Simulation::from_assembled(start, &silent)
}

/// Times \[s\] that are simulated before t = 0 at least and at most, those in which a run-in by itself looks for its end included. Not numbers where torques bring
/// a drive up to speed before: nobody knows how long that takes.
///
/// # Errors
/// As [`run_in`].
pub(crate) fn bounds(start: &Assembled, run: &Run) -> Result<[f64; 2], SimulationError> {
    match &run.run_in {
        RunIn::None => Ok([0.0; 2]),
        RunIn::Usual if start.why_it_does_not_repeat().is_some() => Ok([0.0; 2]),
        RunIn::Time(time) => Ok([*time; 2]),
        RunIn::Turns { turns, sprocket } => {
            Ok([turns_last(start, *turns, sprocket.as_deref())?; 2])
        }
        RunIn::Auto if steady::stands(start) => Ok([f64::NAN; 2]),
        RunIn::Auto | RunIn::Usual => steady::bounds(start, run),
    }
}

/// Finds out before a drive is assembled whether it has the sprocket whose turns its run-in counts.
///
/// # Errors
/// [`SimulationError::RunIn`].
pub(crate) fn check_sprocket(drive: &Drive, run: &Run) -> Result<(), SimulationError> {
    let RunIn::Turns { sprocket, .. } = &run.run_in else {
        return Ok(());
    };
    let sprockets = drive.parts().sprockets.iter();
    let names: Vec<String> = sprockets.map(|it| it.name.clone()).collect();
    number_of(&names, sprocket.as_deref()).map(drop)
}

/// Number of the sprocket whose turns are counted.
fn number_of(names: &[String], sprocket: Option<&str>) -> Result<usize, SimulationError> {
    let index = match sprocket {
        Some(name) => names.iter().position(|known| known == name),
        None => (!names.is_empty()).then_some(0),
    };
    index.ok_or_else(|| {
        let wanted = sprocket.unwrap_or("a sprocket");
        let known = match names.len() {
            0 => "the drive has none: give a time".to_owned(),
            _ => format!("there are {}", names.join(", ")),
        };
        let reason = format!("turns of {wanted}: {known}");
        SimulationError::RunIn { reason }
    })
}

/// Finds out before method and step are chosen whether that sprocket turns.
///
/// # Errors
/// [`SimulationError::RunIn`].
pub(crate) fn check_turns(start: &Assembled, run: &Run) -> Result<(), SimulationError> {
    match &run.run_in {
        RunIn::Turns { turns, sprocket } => {
            turns_last(start, *turns, sprocket.as_deref()).map(drop)
        }
        _ => Ok(()),
    }
}

/// Time \[s\] that a sprocket takes for some turns at its mean speed.
fn turns_last(
    start: &Assembled,
    turns: f64,
    sprocket: Option<&str>,
) -> Result<f64, SimulationError> {
    let names = start.system.sprocket_names();
    let index = number_of(&names, sprocket)?;
    let speed = start.mean_speeds()[index].abs();
    // t = n 2π/ω
    let time = turns * TAU / speed;
    if time.is_finite() {
        Ok(time)
    } else {
        let name = &names[index];
        let reason = format!(
            "`{name}` turns at {speed} rad/s in the mean: give a time, or turns of a sprocket that turns"
        );
        Err(SimulationError::RunIn { reason })
    }
}
