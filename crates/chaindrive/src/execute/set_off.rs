//! From a request to a simulation that is ready to move: assemble, choose, run in.

use chaindrive_integrate::Method;
use chaindrive_mechanics::{Assembled, Drive};

use super::RunError;
use crate::patience::assemble;
use crate::precision::{Choice, Estimate, ShortRuns, choose_with, estimate};
use crate::record::Provenance;
use crate::run_in::{self, Beginning, Onlooker};
use crate::summary::Summary;
use crate::{Request, RunIn, Simulation, SimulationError};

/// A run that is ready to move.
pub(super) struct Begun {
    pub(super) drive: Drive,
    pub(super) simulation: Simulation,
    pub(super) provenance: Provenance,
    /// With which the choice was made, for the estimate.
    pub(super) short_runs: ShortRuns,
    /// The estimate, where it was made before.
    pub(super) estimate: Option<Estimate>,
    pub(super) summary: Summary,
}

/// Why a run could not begin.
pub(super) fn not_begun<E: std::error::Error>(error: SimulationError) -> RunError<E> {
    match error {
        SimulationError::Interrupted => RunError::Interrupted,
        error => RunError::Start(error),
    }
}

/// A drive that is assembled, and how it is to move.
pub(super) struct Chosen {
    pub(super) drive: Drive,
    pub(super) start: Assembled,
    pub(super) provenance: Provenance,
    /// With which the choice was made; none of a choice that was made before.
    pub(super) short_runs: Option<ShortRuns>,
    /// Verification of the choice at the end of the run-in: done or not.
    pub(super) is_verified: bool,
}

impl Chosen {
    /// The simulation that is run in.
    pub(super) fn simulation(&self) -> Result<Simulation, SimulationError> {
        Simulation::from_assembled(self.start.clone(), &self.provenance.run)
    }
}

/// Assembles the drive, and chooses method and step where an accuracy is asked for: by what is known of a drive like this one, or by
/// trials.
pub(super) fn choose<E: std::error::Error>(
    request: &Request,
    known: Option<&Choice>,
    onlooker: &dyn Onlooker,
) -> Result<Chosen, RunError<E>> {
    let watch = &|| onlooker.stop();
    let mut provenance = Provenance::of(&request.scene, &request.run);
    provenance.checkpoint_every = request.checkpoint_every;
    let drive = request.scene.drive().map_err(RunError::Scene)?;
    let start = assemble(&drive, watch).map_err(not_begun)?;
    let mut short_runs = ShortRuns::default();
    if let Some(accuracy) = request.accuracy {
        let choice = if let Some(known) = known {
            known.carried_over(&start, &request.run)
        } else {
            let accuracy = (accuracy, request.accuracy_of);
            let made = choose_with(&mut short_runs, &start, &request.run, accuracy, watch);
            made.map_err(not_begun)?
        };
        provenance.run = choice.run.clone();
        provenance.choice = Some(choice);
    }
    Ok(Chosen {
        drive,
        start,
        provenance,
        short_runs: Some(short_runs),
        is_verified: false,
    })
}

/// What the estimate goes on with that begins where the choice did.
pub(super) fn short_runs(
    request: &Request,
    provenance: &Provenance,
    start: &Assembled,
    onlooker: &dyn Onlooker,
) -> Result<ShortRuns, SimulationError> {
    match &provenance.choice {
        Some(choice) if request.estimate => choice.short_runs(start, &|| onlooker.stop()),
        _ => Ok(ShortRuns::default()),
    }
}

/// Holds what was chosen on the start against the state that the drive was run in to, which is another; where that does not keep the accuracy, chooses
/// again there, for as much less as it errs by more. Returns the estimate of a run that keeps it.
fn verified(
    provenance: &mut Provenance,
    start: &Assembled,
    onlooker: &dyn Onlooker,
) -> Result<Option<Estimate>, SimulationError> {
    let Some(choice) = provenance.choice.as_ref().filter(|it| it.kept) else {
        return Ok(None);
    };
    let watch = &|| onlooker.stop();
    let made = match estimate(start, &provenance.run, watch) {
        Ok(made) => made,
        Err(SimulationError::Interrupted) => return Err(SimulationError::Interrupted),
        // The judgement of the run will say why.
        Err(_) => return Ok(None),
    };
    let accuracy = choice.accuracy;
    // Losses are not estimated: the ledger of the whole run judges them.
    let Some(found) = made.of(choice.promise).filter(|it| *it > accuracy) else {
        return Ok(Some(made));
    };
    let less = accuracy * accuracy / found;
    let wanted = (less, choice.promise.quantity());
    let mut none_known = ShortRuns::default();
    let again = choose_with(&mut none_known, start, &provenance.run, wanted, watch)?;
    provenance.run = again.run.clone();
    provenance.choice = Some(Choice {
        accuracy,
        kept: again.error <= accuracy,
        evaluations: again.evaluations + choice.evaluations,
        ..again
    });
    Ok(None)
}

/// Runs the drive in, and starts the clock.
pub(super) fn set_off<E: std::error::Error>(
    request: &Request,
    chosen: Chosen,
    onlooker: &dyn Onlooker,
) -> Result<Begun, RunError<E>> {
    let failed = not_begun;
    let Chosen {
        drive,
        start,
        mut provenance,
        short_runs: known,
        is_verified,
    } = chosen;
    let (wanted, chosen_step) = (provenance.run.run_in.clone(), provenance.run.step);
    let mut beginning = run_in::begin(start.clone(), &provenance.run, onlooker).map_err(failed)?;
    let mut estimate = None;
    if request.estimate && !is_verified && beginning.has_moved() {
        estimate = verified(&mut provenance, &beginning.start, onlooker).map_err(failed)?;
        if estimate.is_none() && provenance.run.step != chosen_step {
            // Run in anew, so that the scene of the result gives the same run.
            provenance.run.run_in = wanted;
            beginning = run_in::begin(start, &provenance.run, onlooker).map_err(failed)?;
        }
    }
    let has_moved = beginning.has_moved();
    let Beginning {
        start,
        ran_in,
        simulation: mut going_on,
    } = beginning;
    if provenance.run.run_in == RunIn::Usual {
        let is_left_out = ran_in.as_ref().is_none_or(|it| it.left_out.is_some());
        provenance.run.run_in = if is_left_out {
            RunIn::None
        } else {
            RunIn::Auto
        };
    }
    provenance.ran_in = ran_in;
    let mut short_runs = match known {
        _ if !request.estimate || has_moved => ShortRuns::default(),
        Some(known) => known,
        None => short_runs(request, &provenance, &start, onlooker).map_err(failed)?,
    };
    let verified = provenance.run.step;
    // The run-in may have pressed contacts until they bound the step that was chosen before it.
    let longest = |method: Method| method.longest_step(method.time_scale(&start.system));
    going_on = going_on.filter(|it| it.method().step() <= longest(it.method()));
    let run = &mut provenance.run;
    if let Some(simulation) = &going_on {
        run.step = Some(simulation.method().step());
    } else if provenance.choice.is_some() {
        let longest = longest(run.method(&start.system));
        run.step = run.step.map(|step| step.min(longest));
    }
    estimate = estimate.filter(|_| provenance.run.step == verified);
    short_runs.keep_for(&provenance.run);
    let simulation = match going_on {
        Some(simulation) => simulation,
        None => Simulation::from_assembled(start, &provenance.run).map_err(failed)?,
    };
    Ok(Begun {
        summary: Summary::new(&simulation),
        drive,
        simulation,
        provenance,
        short_runs,
        estimate,
    })
}
