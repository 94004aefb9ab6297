//! One run, whoever asks for it: assemble, choose, step, sample, judge.

mod start;
#[cfg(feature = "stores")]
mod stopped_run;

use std::convert::Infallible;

use chaindrive_mechanics::{Assembled, Drive, Sights};
use serde_json::{Map, Value};

use crate::describe::wraps;
use crate::interruptible::LOOK;
use crate::precision::{Choice, Judgement};
use crate::record::{Checkpoint, End, Ending, Provenance, Sink, attributes};
use crate::run_in::Onlooker;
use crate::scene::SceneError;
use crate::summary::Summary;
use crate::{
    ChainVerdict, Channel, Request, Run, RunIn, RunInReport, Simulation, SimulationError,
    SnapshotError, Verdict,
};

use start::{RunState, Setup, not_started};

/// Why there is no result at all, or no whole one.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E: std::error::Error> {
    /// The scene is not a drive.
    #[error(transparent)]
    Scene(SceneError),

    /// The run could not begin.
    #[error(transparent)]
    Start(SimulationError),

    /// The checkpoint is not of this scene.
    #[error(transparent)]
    Snapshot(SnapshotError),

    /// The user stopped it before it began.
    #[error("interrupted")]
    Interrupted,

    /// The result could not be written.
    #[error(transparent)]
    Sink(E),
}

/// Outcome of a run, beside its samples.
#[derive(Debug)]
pub struct Report {
    /// The simulation at its last state.
    pub simulation: Simulation,
    /// The drive.
    pub drive: Drive,
    /// The run as it was carried out, with the method and step chosen.
    pub run: Run,
    /// Choice of method and step, if one was made.
    pub choice: Option<Choice>,
    /// The run-in, if there was one.
    pub ran_in: Option<RunInReport>,
    /// The account of its samples.
    pub summary: Summary,
    /// Estimate of the numerical error; none for a run that failed.
    pub judgement: Option<Judgement>,
    /// Verdict on how far the result can be trusted.
    pub verdict: Verdict,
    /// Reason for the end of the run.
    pub stop: Stop,
    /// Attributes of the result: the same in memory and in a store.
    pub attributes: Map<String, Value>,
}

/// Why a run stopped.
#[derive(Debug)]
pub enum Stop {
    /// It reached its end.
    End,
    /// The user stopped it.
    Interrupted,
    /// It could not go on.
    Failed(SimulationError),
}

impl Stop {
    /// The same, as a result tells it.
    pub fn ending(&self) -> Ending {
        match self {
            Self::End => Ending::Complete,
            Self::Interrupted => Ending::Interrupted,
            Self::Failed(error) => Ending::Failed(error.to_string()),
        }
    }
}

/// Carries out a request: assembles the drive, chooses method and step where an accuracy is asked for, hands every
/// sample to the sink, and judges the result.
///
/// The same request gives the same bits and the same attributes, whoever asks and wherever the samples go, but for the
/// wall times. A run that fails or is stopped under way is a report too: what there is of it is kept.
///
/// # Errors
/// [`RunError`] when the run cannot begin, or the sink refuses.
///
/// # Example
///
/// ```
/// use chaindrive::{SettingValue, Memory, Request, Scene, Settings, execute};
///
/// let settings = Settings::default().with("until", SettingValue::Number(2e-3));
/// let request = Request::new(&Scene::preset("spinning_ring")?, &settings)?;
/// let mut memory = Memory::default();
/// let report = execute(&request, &mut memory, &|| false)?;
/// assert_eq!(report.attributes["status"], "complete");
/// assert_eq!(report.attributes["samples"], memory.recording.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn execute<S: Sink>(
    request: &Request,
    sink: &mut S,
    onlooker: &dyn Onlooker,
) -> Result<Report, RunError<S::Error>> {
    execute_by(None, request, sink, onlooker)
}

/// The choice of method and step that a request begins with, where it asks for an accuracy.
pub(crate) fn choice(
    request: &Request,
    onlooker: &dyn Onlooker,
) -> Result<Option<Choice>, RunError<Infallible>> {
    Ok(Setup::new(request, None, onlooker)?.provenance.choice)
}

/// Carries out a request by a choice that was made for a drive like this one, if there is one.
pub(crate) fn execute_by<S: Sink>(
    known: Option<&Choice>,
    request: &Request,
    sink: &mut S,
    onlooker: &dyn Onlooker,
) -> Result<Report, RunError<S::Error>> {
    let mut setup = Setup::new(request, known, onlooker)?;
    if onlooker.asks_for_time() {
        setup.foretell(onlooker).map_err(not_started)?;
    }
    let mut waiting = None;
    if setup.provenance.run.run_in != RunIn::None {
        let simulation = setup.simulation().map_err(not_started)?;
        let channels = channels(request, &setup.assembled).map_err(RunError::Start)?;
        sink.has_room(&simulation, &channels, &setup.provenance.run)
            .map_err(RunError::Sink)?;
        if request.checkpoint_every.is_some() {
            // Whoever is stopped or killed in the run-in goes on from here.
            let mut provenance = setup.provenance.clone();
            announce(request, &mut provenance, &simulation, sink)?;
            let summary = Summary::new(&simulation);
            let checkpoint = Checkpoint::of_beginning(request, &provenance, &simulation);
            sink.keep(&simulation, &checkpoint)
                .map_err(RunError::Sink)?;
            waiting = Some((simulation, provenance, summary));
        }
    }
    let sights = sights(request, sink, &setup.assembled).map_err(RunError::Start)?;
    let started = setup.run_in(request, sights, onlooker);
    let started = started.map_err(not_started);
    let state = match (started, waiting) {
        (Err(error), Some((simulation, provenance, summary))) => {
            let ending = match &error {
                RunError::Interrupted => Ending::Interrupted,
                error => Ending::Failed(error.to_string()),
            };
            close(sink, &provenance, &simulation, &summary, &ending, None)
                .map_err(RunError::Sink)?;
            return Err(error);
        }
        (started, _) => started?,
    };
    complete(request, state, sink, onlooker)
}

/// Takes a run to its end.
fn complete<S: Sink>(
    request: &Request,
    state: RunState,
    sink: &mut S,
    onlooker: &dyn Onlooker,
) -> Result<Report, RunError<S::Error>> {
    let RunState {
        drive,
        mut simulation,
        mut provenance,
        mut short_runs,
        estimate,
        mut summary,
    } = state;
    let watch = || onlooker.stop();
    let run = provenance.run.clone();
    announce(request, &mut provenance, &simulation, sink)?;
    summary.kept = sink.keeps_samples();
    let sights = sights(request, sink, simulation.assembled()).map_err(RunError::Start)?;
    simulation.sample_only(sights);

    if request.checkpoint_every.is_some() && summary.samples == 0 {
        // With no sample before it: a store that is killed here is in nobody's way.
        let checkpoint = Checkpoint::of(request, &provenance, &simulation, &summary);
        sink.keep(&simulation, &checkpoint)
            .map_err(RunError::Sink)?;
    }
    let mut marks = Marks::after(request.checkpoint_every, &simulation);
    let carried = carry_out(
        &mut simulation,
        onlooker,
        |simulation| -> Result<(), S::Error> {
            summary.take(simulation);
            sink.push(simulation)?;
            // Those that the run-in took are gone through in no time.
            if marks.pass(simulation) && !simulation.has_samples_ahead() {
                let checkpoint = Checkpoint::of(request, &provenance, simulation, &summary);
                sink.keep(simulation, &checkpoint)?;
            }
            Ok(())
        },
    );
    let carried = carried.and_then(|stop| -> Result<Stop, S::Error> {
        let goes_on = match &stop {
            Stop::End => request.checkpoint_every.is_some(),
            Stop::Interrupted => true,
            Stop::Failed(_) => false,
        };
        if goes_on {
            let checkpoint = Checkpoint::of(request, &provenance, &simulation, &summary);
            sink.keep(&simulation, &checkpoint)?;
        }
        Ok(stop)
    });
    // What is kept to go on from has no end of the account.
    summary.end(&simulation);
    let mut stop = match carried {
        Ok(stop) => stop,
        Err(refused) => {
            // The result is to say that it is not whole, if it still can.
            let ending = Ending::Failed(refused.to_string());
            close(sink, &provenance, &simulation, &summary, &ending, None).ok();
            return Err(RunError::Sink(refused));
        }
    };
    let judgement = match &stop {
        Stop::Failed(_) => None,
        _ if !request.estimate => Some(Judgement::SwitchedOff),
        Stop::Interrupted => Some(Judgement::Interrupted),
        Stop::End => Some(match estimate {
            Some(made) => Judgement::Made(Box::new(made)),
            None => Judgement::with(&mut short_runs, &simulation, &run, &watch),
        }),
    };
    let ending = stop.ending();
    let judged = judgement.as_ref();
    let told = close(sink, &provenance, &simulation, &summary, &ending, judged);
    let (verdict, attributes) = told.map_err(RunError::Sink)?;
    if judgement == Some(Judgement::Interrupted) {
        // The samples are complete, but the user wants to get away.
        stop = Stop::Interrupted;
    }
    Ok(Report {
        verdict,
        simulation,
        drive,
        run,
        ran_in: provenance.ran_in,
        choice: provenance.choice,
        summary,
        judgement,
        stop,
        attributes,
    })
}

/// Tells the sink of a run that is about to begin.
fn announce<S: Sink>(
    request: &Request,
    provenance: &mut Provenance,
    simulation: &Simulation,
    sink: &mut S,
) -> Result<(), RunError<S::Error>> {
    if sink.keeps_attributes() {
        let run = provenance.run.table(simulation.method());
        let resolved = request.scene.resolved_text(run);
        let (text, assumed) = resolved.map_err(RunError::Scene)?;
        provenance.resolved_scene = Some(text);
        provenance.assumed = assumed;
    }
    let channels = channels(request, simulation.assembled()).map_err(RunError::Start)?;
    sink.begin(simulation, &channels, provenance)
        .map_err(RunError::Sink)
}

/// The channels that are asked for, or those that the drive has by default.
fn channels(request: &Request, assembled: &Assembled) -> Result<Vec<Channel>, SimulationError> {
    if request.record.is_empty() {
        Ok(Channel::defaults(&assembled.drive))
    } else {
        Channel::chosen(&request.record, &assembled.system)
    }
}

/// Readings that samples are made of: those of the channels, where somebody keeps them, and what the account of the run takes in.
fn sights<S: Sink>(
    request: &Request,
    sink: &S,
    assembled: &Assembled,
) -> Result<Sights, SimulationError> {
    if !sink.keeps_samples() {
        return Ok(Sights::ENERGIES);
    }
    let channels = channels(request, assembled)?;
    Ok(Channel::sights_of(&channels).and(Sights::ENERGIES))
}

/// Tells the sink how the run ended; returns the verdict, and what the result says about itself.
fn close<S: Sink>(
    sink: &mut S,
    provenance: &Provenance,
    simulation: &Simulation,
    summary: &Summary,
    ending: &Ending,
    judgement: Option<&Judgement>,
) -> Result<(Verdict, Map<String, Value>), S::Error> {
    let (ran_in, choice) = (provenance.ran_in.as_ref(), provenance.choice.as_ref());
    let mut verdict = Verdict::of(summary, simulation, ran_in, choice, judgement);
    let assembled = simulation.assembled();
    let wraps = wraps(&assembled.drive, assembled);
    verdict.chains = ChainVerdict::of(summary, simulation, &wraps);
    let attributes = if sink.keeps_attributes() {
        attributes(
            provenance,
            simulation,
            Some((summary, &verdict)),
            summary.samples,
            ending,
            judgement,
        )
    } else {
        Map::new()
    };
    sink.end(&End {
        simulation,
        summary,
        judgement,
        ending,
        attributes: &attributes,
    })?;
    Ok((verdict, attributes))
}

/// Simulated times at which checkpoints are due: counted, so that a run that is carried on has the same.
struct Marks {
    every: Option<f64>,
    /// Number of the last one passed.
    passed: f64,
}

impl Marks {
    fn after(every: Option<f64>, simulation: &Simulation) -> Self {
        let mut marks = Self { every, passed: 0.0 };
        marks.pass(simulation);
        marks
    }

    /// True at the first sample after each multiple of `every`.
    fn pass(&mut self, simulation: &Simulation) -> bool {
        let Some(every) = self.every else {
            return false;
        };
        let now = (simulation.read_at() / every).floor();
        now > std::mem::replace(&mut self.passed, now)
    }
}

impl Simulation {
    /// Begins what a request asks for, to be moved from outside: see [`advance_to`](Self::advance_to).
    ///
    /// # Errors
    /// [`RunError`] when the run cannot begin.
    pub fn of(request: &Request, onlooker: &dyn Onlooker) -> Result<Self, RunError<Infallible>> {
        let mut request = request.clone();
        request.run.watched = false;
        if request.run.run_in == RunIn::Usual {
            request.run.run_in = RunIn::None;
        }
        let setup = Setup::new(&request, None, onlooker)?;
        let state = setup.run_in(&request, Sights::default(), onlooker);
        let state = state.map_err(not_started)?;
        if !state.simulation.has_samples_ahead() {
            return Ok(state.simulation);
        }
        // It is read at any time from t = 0 on, and not at the samples that the run-in took.
        let start = state.simulation.assembled().clone();
        Self::from_assembled(start, &state.provenance.run).map_err(not_started)
    }
}

/// Takes sample after sample to the end of the run, or until somebody stops it.
pub(crate) fn carry_out<E>(
    simulation: &mut Simulation,
    onlooker: &dyn Onlooker,
    mut keep: impl FnMut(&Simulation) -> Result<(), E>,
) -> Result<Stop, E> {
    loop {
        match simulation.advance(LOOK) {
            Ok(true) => match simulation.next_sample() {
                Ok(Some(_)) => keep(simulation)?,
                Ok(None) => {
                    onlooker.see(simulation);
                    return Ok(Stop::End);
                }
                Err(error) => return Ok(Stop::Failed(error)),
            },
            Ok(false) => {}
            Err(error) => return Ok(Stop::Failed(error)),
        }
        onlooker.see(simulation);
        if onlooker.stop() {
            return Ok(Stop::Interrupted);
        }
    }
}
