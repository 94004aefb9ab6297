//! Work against precision: many methods and steps, measured on one drive.

use chaindrive_integrate::Statistics;
use chaindrive_mechanics::Assembled;

use super::Watch;
use super::compare::Errors;
use super::horizon::Horizon;
use super::short_runs::APART;
use super::trace::{Gap, Strands, Trace};
use super::variant::{Variant, references, usual};
use super::window::{Window, automatic, pinned};
use crate::clock::{Instant, on_processor};
use crate::{Run, RunInReport, SimulationError, run_in};

/// Settings of a work-precision study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Variants to compare; empty: the usual methods and steps of the drive's kind.
    pub variants: Vec<Variant>,
    /// Time over which to compare \[s\]; absent: half a [`Window`].
    pub until: Option<f64>,
    /// Timed runs of every variant, of which the median counts; at least one.
    pub repeats: usize,
    /// Runs of the reference that start some 1e-12 m apart, for the spread of the statistics; at least one.
    pub replicates: usize,
}

impl Default for Study {
    fn default() -> Self {
        Self {
            variants: Vec::new(),
            until: None,
            repeats: 5,
            replicates: 2,
        }
    }
}

/// One variant, measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The variant that was run.
    pub variant: Variant,
    /// Wall time \[s\], median; NaN of a failure.
    pub wall: f64,
    /// Time on the processor \[s\], median.
    pub cpu: f64,
    /// Simulated over wall time \[–\].
    pub real_time_factor: f64,
    /// Counts of the time stepping.
    pub statistics: Statistics,
    /// Errors against the reference.
    pub errors: Errors,
    /// Whether the error of the tension is below that of the reference itself: then it is an upper bound only.
    pub reference_limited: bool,
    /// Why there is nothing else in the row, if the run failed.
    pub failure: Option<String>,
}

/// Findings of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// One row a variant, in the order of the study.
    pub rows: Vec<Row>,
    /// The run-in before, if there was one.
    pub ran_in: Option<RunInReport>,
    /// Time over which was compared \[s\].
    pub window: f64,
    /// Time for which twins of the reference stay together; pointwise errors end there.
    pub horizon: Horizon,
    /// The reference.
    pub reference: Variant,
    /// The independent method that checks it.
    pub check: Variant,
    /// Differences between the two.
    pub agreement: Errors,
    /// Differences between replicates of the reference.
    pub spread: Errors,
    /// Mean tension of all spans, or of all links where they are compared \[N\].
    pub mean_tension: f64,
    /// Why links were compared and not spans, if a span of the reference had no tension for some time.
    pub gap: Option<Gap>,
    /// Timed runs a row.
    pub repeats: usize,
    /// Replicates of the reference.
    pub replicates: usize,
}

/// Measures work and precision of methods and steps on the beginning of a run.
///
/// A run-in is carried out once, with the method of `run`, and all begin where it ends.
///
/// Pointwise errors are taken up to the horizon of the reference, statistics over the whole window, to be held
/// against the spread of replicates. Everything but the times is the same to the last bit whenever the same
/// binary does it again on the same kind of processor.
///
/// # Errors
/// [`SimulationError`] when reference, check or a replicate fails, a setting is out of range, or `watch` says stop. A
/// variant that fails stays in the table, with its message.
pub fn work_precision(
    start: &Assembled,
    run: &Run,
    study: &Study,
    watch: Watch<'_>,
) -> Result<Table, SimulationError> {
    let window = window(start, run, study)?;
    for variant in &study.variants {
        let wanted = Run {
            until: window.until,
            ..variant.run(run)
        };
        wanted.check()?;
    }
    let (start, ran_in) = run_in(start.clone(), run, &|| watch())?;
    let start = &start;
    let taken =
        |variant: &Variant, from: &Assembled| Trace::take(from, &variant.run(run), &window, watch);
    let [reference, check] = references(start);
    let exact = taken(&reference, start)?;
    let mut twins = Vec::new();
    for k in 1..=study.replicates {
        let from = start.nudged(APART * k as f64);
        twins.push(taken(&reference, &from)?);
    }
    let strands = Strands::of(twins.iter().chain([&exact]));
    let horizon = Horizon::of(&exact, twins.first().unwrap_or(&exact), strands);
    let until = horizon.all.time().unwrap_or(f64::INFINITY);
    let errors = |trace: &Trace| Errors::of(trace, &exact, strands, until, window.period);
    let spread = twins
        .iter()
        .map(errors)
        .reduce(|a, b| a.larger(&b))
        .unwrap_or_else(Errors::none);
    let agreement = errors(&taken(&check, start)?);

    let variants = if study.variants.is_empty() {
        usual(start)
    } else {
        study.variants.clone()
    };
    let mut rows = Vec::new();
    for variant in variants {
        let run = pinned(start, &variant.run(run));
        let row = match Trace::take(start, &run, &window, watch) {
            Err(SimulationError::Interrupted) => return Err(SimulationError::Interrupted),
            Err(error) => Row::failed(variant, error.to_string()),
            Ok(trace) => {
                let [wall, cpu] = timed(start, &run, &window, study.repeats, watch)?;
                let errors = errors(&trace);
                Row {
                    variant: Variant {
                        step: run.step,
                        ..variant
                    },
                    wall,
                    cpu,
                    real_time_factor: window.until / wall,
                    statistics: trace.statistics,
                    reference_limited: errors.tension <= agreement.tension,
                    errors,
                    failure: None,
                }
            }
        };
        rows.push(row);
    }
    Ok(Table {
        rows,
        ran_in,
        window: window.until,
        horizon,
        reference,
        check,
        agreement,
        spread,
        mean_tension: exact.tensions(strands).mean(),
        gap: twins.into_iter().chain([exact]).find_map(|trace| trace.gap),
        repeats: study.repeats,
        replicates: study.replicates,
    })
}

/// The window of a study, once its settings are found in range.
fn window(start: &Assembled, run: &Run, study: &Study) -> Result<Window, SimulationError> {
    let setting = |name, value, allowed| SimulationError::Setting {
        name,
        value,
        allowed,
    };
    if study.repeats == 0 {
        return Err(setting("repeats", 0.0, "at least 1"));
    }
    if study.replicates == 0 {
        return Err(setting("replicates", 0.0, "at least 1"));
    }
    let usual = Window::of(start, &pinned(start, &automatic(run))).first_half();
    match study.until {
        None => Ok(usual),
        Some(until) if until > 0.0 && until.is_finite() => Ok(usual.with_end(until)),
        Some(until) => Err(setting("until", until, "positive")),
    }
}

/// Medians of wall time and time on the processor \[s\], sampling left out.
///
/// Nothing but the steps may lie between the two looks at the clock: no sink, no summary, no question whether to stop.
fn timed(
    start: &Assembled,
    run: &Run,
    window: &Window,
    repeats: usize,
    watch: Watch<'_>,
) -> Result<[f64; 2], SimulationError> {
    let run = Run {
        until: window.until,
        every: window.until,
        ..run.clone()
    };
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..repeats {
        let mut simulation = crate::Simulation::from_assembled(start.clone(), &run)?;
        let (wall, cpu) = (Instant::now(), on_processor());
        while simulation.next_sample()?.is_some() {}
        times[0].push(wall.elapsed().as_secs_f64());
        times[1].push(on_processor() - cpu);
        if watch() {
            return Err(SimulationError::Interrupted);
        }
    }
    Ok(times.map(|mut times| {
        times.sort_unstable_by(f64::total_cmp);
        let half = times.len() / 2;
        if times.len() % 2 == 1 {
            times[half]
        } else {
            0.5 * (times[half - 1] + times[half])
        }
    }))
}

impl Row {
    fn failed(variant: Variant, why: String) -> Self {
        Self {
            variant,
            wall: f64::NAN,
            cpu: f64::NAN,
            real_time_factor: f64::NAN,
            statistics: Statistics::default(),
            errors: Errors::none(),
            reference_limited: false,
            failure: Some(why),
        }
    }
}
