//! The cheapest method and step that keep an accuracy, found by trying.

use std::fmt;

use chaindrive_mechanics::Assembled;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Watch;
use super::compare::{Pair, rms};
use super::horizon::Horizon;
use super::short_runs::{ShortRunStart, ShortRuns};
use super::trace::{Gap, Strands, Trace};
use super::variant::{CAUTION, Candidates, Entry, Variant};
use super::window::{Window, automatic, pinned, sharper};
use crate::figure::{Measure, duration, percent};
use crate::scene::Quantity;
use crate::story::Story;
use crate::{Run, SimulationError, Stepping};

/// An accuracy that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Relative error \[–\].
    pub value: f64,
    /// Of what.
    pub of: Quantity,
}

impl From<f64> for Accuracy {
    fn from(value: f64) -> Self {
        let of = Quantity::default();
        Self { value, of }
    }
}

impl From<(f64, Quantity)> for Accuracy {
    fn from((value, of): (f64, Quantity)) -> Self {
        Self { value, of }
    }
}

/// Quantity that is kept within the accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Promise {
    /// The tension of the tight span, or of the tightest link where [`Choice::gap`] leaves a span without a
    /// tension, at every moment of the window, root mean square.
    Waveform,
    /// Mean and root mean square of the tension of every span or link, or no more than chance makes of them: the
    /// run goes on beyond its chaos horizon.
    Statistics,
    /// The energy lost, as it is without what chance makes of it, and what is unaccounted for beside it.
    Losses,
    /// Median and 99th percentile of the forces of impacts and median of their impulses, on the sprocket that differs most, or no more than
    /// chance makes of them.
    Impacts,
    /// Nothing: the chain carries no tension that could be compared, loses nothing, or strikes nothing.
    Nothing,
}

impl Promise {
    /// Quantity of the accuracy behind the promise.
    pub(crate) fn quantity(self) -> Quantity {
        match self {
            Self::Waveform | Self::Statistics | Self::Nothing => Quantity::Tension,
            Self::Losses => Quantity::Losses,
            Self::Impacts => Quantity::Impacts,
        }
    }
}

/// A candidate that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Method.
    pub stepping: Stepping,
    /// Step \[s\].
    pub step: f64,
    /// Deepest first penetration \[m\], where steps are rejected for it.
    pub onset_depth: Option<f64>,
    /// Bound of its error \[–\]; infinite if it failed.
    pub error: f64,
    /// Evaluations and solutions of equations a simulated second \[1/s\].
    pub work: f64,
}

/// Method and step for a drive, and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The run with method, step and onset depth.
    pub run: Run,
    /// Step over the time scale that limits the method; none where the method takes its own step.
    pub factor: Option<f64>,
    /// Accuracy asked for \[–\].
    pub accuracy: f64,
    /// Bound of the error of the run chosen \[–\].
    pub error: f64,
    /// True if the run keeps the requested accuracy; otherwise no method of the list does, and this is the best of them.
    pub kept: bool,
    /// The quantity whose accuracy is promised.
    pub promise: Promise,
    /// Time over which candidates were compared \[s\].
    pub window: f64,
    /// Why links were compared and not spans, if a span had no tension for some time.
    pub gap: Option<Gap>,
    /// All that were tried, in that order.
    pub trials: Vec<Trial>,
    /// Evaluations of all runs that it took, those included of judges, the twin and runs that failed.
    pub evaluations: u64,
}

/// The runs that a choice looks at.
struct Trials<'a> {
    start: &'a Assembled,
    run: &'a Run,
    window: Window,
    watch: Watch<'a>,
    short_runs: &'a mut ShortRuns,
    failed: Vec<Variant>,
}

impl Trials<'_> {
    fn take(&mut self, from: ShortRunStart, of: Variant) -> Result<usize, SimulationError> {
        let run = of.run(self.run);
        self.short_runs
            .take(self.start, from, &run, &self.window, self.watch)
    }

    /// Place of the trace of a candidate; none if it fails.
    fn place(&mut self, of: Variant) -> Result<Option<usize>, SimulationError> {
        if self.failed.contains(&of) {
            return Ok(None);
        }
        match self.take(ShortRunStart::Start, of) {
            Ok(place) => Ok(Some(place)),
            Err(SimulationError::Interrupted) => Err(SimulationError::Interrupted),
            Err(_) => {
                // Too long a step for this drive: out of the race, not the end of it.
                self.failed.push(of);
                Ok(None)
            }
        }
    }

    /// The traces of a candidate and its judge, if both are there.
    fn pair(&mut self, entry: &Entry) -> Result<Option<[&Trace; 2]>, SimulationError> {
        let places = (self.place(entry.candidate)?, self.place(entry.judge)?);
        let (Some(candidate), Some(judge)) = places else {
            return Ok(None);
        };
        Ok(Some([candidate, judge].map(|at| self.short_runs.trace(at))))
    }

    /// Which promise the drive allows, and by how much the statistics of equal runs differ.
    fn promise(&mut self, first: Variant, of: Quantity) -> Result<(Promise, f64), SimulationError> {
        let Some(base) = self.place(first)? else {
            return Ok((Promise::Waveform, 0.0));
        };
        if nothing(self.short_runs.trace(base), of) {
            return Ok((Promise::Nothing, 0.0));
        }
        let twin = self.take(ShortRunStart::Apart, first)?;
        let [base, twin] = [base, twin].map(|at| self.short_runs.trace(at));
        let strands = Strands::of([base, twin]);
        let apart = Pair::of(twin, base, strands);
        if of == Quantity::Losses {
            return Ok((Promise::Losses, apart.losses()));
        }
        if of == Quantity::Impacts {
            let names = self.start.system.sprocket_names();
            return Ok((Promise::Impacts, apart.impacts(&names, 1.0)));
        }
        let horizon = Horizon::of(base, twin, strands);
        let parted = [horizon.all, horizon.tight].map(|of| of.time());
        let within = |at: &f64| *at < self.run.until;
        let promise = if parted.iter().flatten().any(within) {
            Promise::Statistics
        } else {
            Promise::Waveform
        };
        Ok((promise, apart.statistics()))
    }
}

/// True for a quantity that is zero in the reference, and so has no relative error.
fn nothing(base: &Trace, of: Quantity) -> bool {
    match of {
        Quantity::Tension => base.tensions(Strands::of([base])).mean() <= 0.0,
        Quantity::Losses => base.energy.scale() <= 0.0,
        Quantity::Impacts => base.impacts.is_empty(),
    }
}

/// Chooses the cheapest candidate whose error stays within the accuracy.
///
/// ```text
/// e = ‖T − T′‖ / T̄ · caution ≤ accuracy,   T′: tension by a sharper candidate
/// ```
///
/// Candidates are tried from the cheapest on, each against a sharper one of the list, over half a [`Window`]. For runs within their
/// chaos horizon, by the judge of the first candidate and its twin, the waveform of the tight span counts, for longer ones mean and root mean
/// square of all spans; no twin is asked where one candidate keeps both from the first. Where the losses are
/// to be kept, the energy lost counts, less what chance makes of it, and what is unaccounted for: |R|/D ≤ accuracy; with implicit damping no more than
/// the accuracy may be unaccounted for of what was moved, nor three tenths of the losses; with play in the joints no more than a tenth of the
/// losses may be unaccounted for or differ from the sharper candidate. If none is
/// good enough, the run gets the best, and [`Choice::kept`] is false. Counts decide and never clocks: the same drive
/// gets the same answer.
///
/// # Errors
/// [`SimulationError::Setting`] for an accuracy that is not between 0 and 1,
/// [`SimulationError::Interrupted`] when `watch` says so, and what keeps the twin from running.
pub fn choose(
    start: &Assembled,
    run: &Run,
    accuracy: impl Into<Accuracy>,
    watch: Watch<'_>,
) -> Result<Choice, SimulationError> {
    choose_with(&mut ShortRuns::default(), start, run, accuracy, watch)
}

/// The same, leaving its short runs to whoever looks at the run chosen.
pub(crate) fn choose_with(
    short_runs: &mut ShortRuns,
    start: &Assembled,
    run: &Run,
    accuracy: impl Into<Accuracy>,
    watch: Watch<'_>,
) -> Result<Choice, SimulationError> {
    let Accuracy {
        value: accuracy,
        of,
    } = accuracy.into();
    if !(accuracy > 0.0 && accuracy < 1.0) {
        return Err(SimulationError::Setting {
            name: "accuracy",
            value: accuracy,
            allowed: "between 0 and 1, such as 0.01",
        });
    }
    let automatic = automatic(run);
    let window = examined(start, &automatic);
    let before = short_runs.evaluations();
    let candidates = Candidates::of(start);
    let mut trials = Trials {
        start,
        run,
        window,
        watch,
        short_runs,
        failed: Vec::new(),
    };
    let mut choice = Choice {
        run: automatic,
        factor: None,
        accuracy,
        error: f64::INFINITY,
        kept: false,
        promise: Promise::Waveform,
        window: window.until,
        gap: None,
        trials: Vec::new(),
        evaluations: 0,
    };
    let names = start.system.sprocket_names();
    let play = start.system.has_play();
    // What twins make of the promise: taken where something turns on it.
    let mut spread = None;
    let mut place = 0;
    while let Some(entry) = candidates.get(place) {
        let found = trials.pair(entry)?;
        let found = found
            .map(|[candidate, judge]| CandidateErrors::of(candidate, judge, entry, &names, play));
        let found = found.as_ref();
        let error_of =
            |promise, spread| found.map_or(f64::INFINITY, |it| it.error(promise, spread, accuracy));
        let keeps = |promise| error_of(promise, 0.0) <= accuracy;
        let whatever =
            of == Quantity::Tension && keeps(Promise::Waveform) && keeps(Promise::Statistics);
        if spread.is_none() && !whatever {
            let (promise, apart) = trials.promise(candidates.first_judge(), of)?;
            choice.promise = promise;
            spread = Some(apart);
        }
        if choice.promise == Promise::Nothing {
            break;
        }
        let error = error_of(choice.promise, spread.unwrap_or_default());
        let candidate = entry.candidate;
        choice.trials.push(Trial {
            stepping: candidate.stepping,
            // Every candidate has one.
            step: candidate.step.unwrap_or(f64::NAN),
            onset_depth: candidate.onset_depth,
            error,
            work: found.map_or(f64::NAN, |it| it.work),
        });
        // NaN is no error to be content with.
        if error < choice.error {
            choice.error = error;
            choice.run = candidate.run(run);
            choice.factor = Some(entry.factor);
            choice.gap = found.and_then(|it| it.gap.clone());
        }
        if error <= accuracy {
            choice.kept = true;
            break;
        }
        let feeds_itself = found.is_some_and(|it| it.fed(accuracy) > accuracy);
        place = candidates.after(place, error, accuracy, feeds_itself);
    }
    choice.evaluations = short_runs.evaluations() - before;
    Ok(choice)
}

/// The window over which candidates are compared.
fn examined(start: &Assembled, automatic: &Run) -> Window {
    let window = Window::of(start, &pinned(start, automatic));
    window.finely(start, automatic).first_half()
}

/// Share of the losses that impacts shorter than a step may leave open in the window; a run is distrusted for a half. *Assumed*: while a drive
/// sets off more is open than later, on the motorcycle at 1.5 to 2.2 µs 0.29 to 0.36 in the first 9 ms and 0.15 to 0.17 from the third
/// such window on.
const OPEN_LOSSES: f64 = 0.3;
/// The same with play in the joints, whose steps book all that they do, together with what losses differ from the sharper candidate, caution
/// included. *Assumed*, with regard to the motorcycle, which errs by 3.6 % at the step of 2.5 µs that this leaves, and by 8 % at 3.8 µs.
const UNCERTAIN_LOSSES: f64 = 0.1;

/// Errors of a candidate against its reference run.
struct CandidateErrors {
    /// Of the waveform of the tight span, root mean square over the mean \[–\].
    waveform: f64,
    /// Of means and root mean squares, the largest \[–\].
    statistics: f64,
    /// Of the energy lost \[–\].
    losses: f64,
    /// Of the impacts, with the caution already \[–\].
    impacts: f64,
    /// Energy unaccounted for over the losses \[–\].
    unaccounted: f64,
    /// The same over what was moved \[–\].
    open: f64,
    /// Losses that are open, over those that may be, with implicit steps: impacts shorter than a step may add energy, in the candidate and its
    /// reference alike \[–\].
    of_losses: Option<f64>,
    work: f64,
    gap: Option<Gap>,
}

impl CandidateErrors {
    fn of(candidate: &Trace, judge: &Trace, entry: &Entry, names: &[String], play: bool) -> Self {
        let pair = Pair::of(candidate, judge, Strands::of([candidate, judge]));
        let waveform = pair.distances().into_iter().map(|distance| distance.tight);
        let losses = pair.losses();
        let unaccounted = candidate.energy.residual / judge.energy.scale();
        let of_losses = if play {
            (unaccounted + CAUTION * losses) / UNCERTAIN_LOSSES
        } else {
            unaccounted / OPEN_LOSSES
        };
        let implicit = entry.candidate.stepping == Stepping::ImplicitDamping;
        Self {
            waveform: rms(waveform),
            statistics: pair.statistics(),
            losses,
            impacts: pair.impacts(names, CAUTION),
            unaccounted,
            open: candidate.energy.open(),
            of_losses: implicit.then_some(of_losses),
            work: candidate.work(),
            gap: candidate.gap.as_ref().or(judge.gap.as_ref()).cloned(),
        }
    }

    /// Bound of the error of what is promised, where equal runs differ by a spread; NaN where nothing can be compared.
    fn error(&self, promise: Promise, spread: f64, accuracy: f64) -> f64 {
        let bound = match promise {
            Promise::Statistics => CAUTION * beyond(self.statistics, spread),
            Promise::Losses => CAUTION * beyond(self.losses, spread),
            Promise::Impacts => beyond(self.impacts, spread),
            Promise::Waveform | Promise::Nothing => CAUTION * self.waveform,
        };
        let energy = match promise {
            Promise::Losses => self.unaccounted,
            _ => self.fed(accuracy),
        };
        // `f64::max` forgets what is not a number.
        if bound.is_nan() {
            bound
        } else {
            bound.max(energy)
        }
    }

    /// Error that impacts count as when they feed themselves: their open share of the energy moved, and more than the accuracy where
    /// they leave too much of the losses open.
    fn fed(&self, accuracy: f64) -> f64 {
        match self.of_losses {
            Some(of_losses) if of_losses > 1.0 => self.open.max(of_losses * accuracy),
            Some(_) => self.open,
            None => 0.0,
        }
    }
}

/// Excess of a difference over the spread of equal runs; a spread without bound excuses nothing.
fn beyond(difference: f64, spread: f64) -> f64 {
    if difference.is_finite() {
        (difference - spread).max(0.0)
    } else {
        f64::INFINITY
    }
}

impl Choice {
    /// The choice for another drive like the one that it was made for: the same method, and as long a step beside the time scale of this
    /// drive. Its error is that found on the other.
    pub(crate) fn carried_over(&self, start: &Assembled, run: &Run) -> Self {
        let Run {
            stepping,
            onset_depth,
            ..
        } = self.run;
        let step = |factor: f64| factor * stepping.time_scale(&start.system);
        Self {
            run: Run {
                stepping,
                step: self.factor.map(step),
                onset_depth,
                ..run.clone()
            },
            ..self.clone()
        }
    }

    /// The short runs that were left to the estimate of the run, taken again: a run that is carried on tells what it
    /// would have told.
    ///
    /// # Errors
    /// As [`choose`].
    pub(crate) fn short_runs(
        &self,
        start: &Assembled,
        watch: Watch<'_>,
    ) -> Result<ShortRuns, SimulationError> {
        let mut short_runs = ShortRuns::default();
        if self.run.step.is_none() {
            return Ok(short_runs);
        }
        let window = examined(start, &automatic(&self.run));
        let (sharper, _) = sharper(start, &self.run);
        for run in [&self.run, &sharper] {
            short_runs.take(start, ShortRunStart::Start, run, &window, watch)?;
        }
        Ok(short_runs)
    }

    /// The choice as attributes of a result.
    ///
    /// `is_missed`: whether the run finds in its own judgement that it does not keep the accuracy.
    pub fn attributes(&self, is_missed: bool) -> Map<String, Value> {
        let mut story = Story::default();
        story.number("accuracy", self.accuracy);
        let kept = match (self.promise, self.kept) {
            (Promise::Nothing, _) => "nothing to compare",
            (_, true) if is_missed => "not kept",
            (_, true) => "kept",
            (_, false) => "not reached",
        };
        story.text("accuracy_kept", kept);
        story.text("choice", &self.reason());
        story.number("accuracy_evaluations", self.evaluations as f64);
        story.number("accuracy_error", self.error);
        story.0
    }

    /// The choice and its reason, in a sentence.
    pub fn reason(&self) -> String {
        let (asked, window) = (percent(self.accuracy), duration(self.window));
        let what = match (self.promise, &self.gap) {
            (Promise::Waveform, None) => "the waveform of the tight span".to_owned(),
            (Promise::Waveform, Some(gap)) => {
                format!("the waveform of the tightest link ({gap})")
            }
            (Promise::Statistics, None) => {
                "mean and rms of the tension (the motion is chaotic)".to_owned()
            }
            (Promise::Statistics, Some(gap)) => {
                format!("mean and rms of the link tensions (the motion is chaotic, {gap})")
            }
            (Promise::Losses, _) => "the losses".to_owned(),
            (Promise::Impacts, _) => "the impacts of rollers".to_owned(),
            (Promise::Nothing, _) => {
                return "the method's own step, because there is no tension, loss or impact to compare"
                    .to_owned();
            }
        };
        let Some(step) = self.run.step else {
            return format!(
                "the method's own step, because none of {} candidates could be compared",
                self.trials.len()
            );
        };
        let depth = self
            .run
            .onset_depth
            .map_or_else(String::new, |depth| format!(", onset depth {depth:.0e} m"));
        let step = Measure::Time.told(step);
        let method = format!("{}, step {step}{depth}", self.run.stepping.name());
        let (error, tried) = (percent(self.error), self.trials.len());
        if self.kept {
            format!(
                "{method}: the cheapest that keeps {what} within {asked} over {window}; found {error}, {tried} tried"
            )
        } else {
            format!(
                "{method}: the best of {tried} tried; {what} errs by {error} over {window}, {asked} is not reached"
            )
        }
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "method chosen            {}", self.reason())
    }
}
