//! The numerical error of a run, by a shadow run with half the step.

use std::fmt;

use chaindrive_integrate::Method;
use chaindrive_mechanics::Assembled;

use super::Watch;
use super::attribute::Attribute;
use super::compare::{Account, Compared, distances, rms};
use super::horizon::{APART, Horizon, LIMIT, Reach};
use super::trace::Trace;
use super::window::Window;
use crate::{Run, SimulationError};

/// How exact a run is.
///
/// ```text
/// run      the beginning of the run, over the window
/// twin     the same, started 1e-12 m apart                    → chaos horizon, spread of the statistics
/// shadow   half the step, over the first half of the window   → error
/// ```
///
/// The error is the difference from the shadow itself, not extrapolated: contacts that open and close take
/// a method's order away. Where the error falls with the square of the step it is a third larger, where it
/// falls with the step it is twice the difference. A difference of statistics that does not exceed the spread
/// of equal runs says only that the error is no larger than that.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Time over which run and shadow were compared \[s\].
    pub window: f64,
    /// What makes the shadow better than the run.
    pub shadow: &'static str,
    /// Error of the span tensions within window and horizon, root mean square over spans and time,
    /// over the mean tension \[–\]; of the links' where there are no spans.
    pub tension: f64,
    /// The same of the tightest span alone.
    pub tight_tension: f64,
    /// Mean tension, that of the span that differs most.
    pub mean: Compared,
    /// Root mean square of the tension, that of the span that differs most.
    pub rms: Compared,
    /// 50th, 90th and 99th percentile of the contact forces.
    pub force: [Compared; 3],
    /// How long twins stay together.
    pub horizon: Horizon,
    /// Time from which on the waveform of this run differs from the exact one by 1 % \[s\]: when
    /// the difference from the shadow does, or the chaos horizon, whichever comes first.
    pub waveform: Option<f64>,
    /// Evaluations of the accelerations that the estimate took.
    pub evaluations: u64,
    /// End of the run \[s\].
    until: f64,
}

/// Estimates the error of a run from its beginning.
///
/// Costs some 24 000 evaluations for a run with its default step, and the more the shorter the step, whatever the
/// length of the run: see [`Window`].
///
/// # Errors
/// [`SimulationError`] when one of the short runs fails, [`SimulationError::Interrupted`] when `watch`
/// says so.
pub fn estimate(
    start: &Assembled,
    run: &Run,
    watch: Watch<'_>,
) -> Result<Estimate, SimulationError> {
    let run = pinned(start, run);
    let window = Window::of(start, &run);
    let base = Trace::take(start, &run, &window, watch)?;
    let twin = Trace::take(&start.nudged(APART), &run, &window, watch)?;
    let (better, shadow) = sharper(start, &run);
    let shadow_trace = Trace::take(start, &better, &window.first_half(), watch)?;
    let horizon = Horizon::of(&base, &twin);

    let samples = shadow_trace.len();
    let distances = distances(&shadow_trace, &base);
    let within = horizon.all.time().unwrap_or(f64::INFINITY);
    let inside = || {
        let pairs = distances.iter().zip(&base.time);
        pairs.filter(|(_, time)| **time <= within).map(|(d, _)| d)
    };
    let of = |trace| Account::of(trace, samples);
    let (run_account, twin_account, better_account) = (of(&base), of(&twin), of(&shadow_trace));
    let compared = |apart: &dyn Fn(&Account) -> f64| Compared {
        difference: apart(&better_account),
        spread: apart(&twin_account),
    };
    Ok(Estimate {
        window: window.first_half().until,
        shadow,
        tension: rms(inside().map(|distance| distance.all)),
        tight_tension: rms(inside().map(|distance| distance.tight)),
        mean: compared(&|other| other.mean_apart(&run_account)),
        rms: compared(&|other| other.rms_apart(&run_account)),
        force: [0, 1, 2].map(|k| compared(&|other| other.force_apart(&run_account)[k])),
        horizon,
        waveform: waveform(&base.time, distances.iter().map(|d| d.all), &horizon),
        evaluations: [&base, &twin, &shadow_trace]
            .iter()
            .map(|trace| trace.statistics.evaluations)
            .sum(),
        until: run.until,
    })
}

/// The run with the step that it would choose for itself, so that other samples do not change it.
pub(super) fn pinned(start: &Assembled, run: &Run) -> Run {
    let step = match run.method(&start.system) {
        Method::Verlet { step }
        | Method::Rk4 { step }
        | Method::ImplicitDamping { step }
        | Method::GeneralizedAlpha { step, .. } => step,
        Method::DormandPrince { max_step, .. } => max_step,
    };
    Run {
        step: Some(step),
        ..run.clone()
    }
}

/// The same run, sharper, and in what.
fn sharper(start: &Assembled, run: &Run) -> (Run, &'static str) {
    let onset_depth = run.onset_depth.map(|depth| 0.1 * depth);
    let adaptive = matches!(run.method(&start.system), Method::DormandPrince { .. });
    if adaptive {
        let better = Run {
            tolerance: 0.1 * run.tolerance,
            onset_depth,
            ..run.clone()
        };
        return (better, "a tenth of the tolerance");
    }
    let better = Run {
        step: run.step.map(|step| 0.5 * step),
        onset_depth,
        ..run.clone()
    };
    match onset_depth {
        Some(_) => (better, "half the step and a tenth of the onset depth"),
        None => (better, "half the step"),
    }
}

/// When the difference from the shadow becomes 1 %, or the twins part.
fn waveform(time: &[f64], distances: impl Iterator<Item = f64>, horizon: &Horizon) -> Option<f64> {
    let distances: Vec<f64> = distances.collect();
    let measured = distances.iter().position(|d| *d >= LIMIT);
    let of_error = match (measured, horizon.all) {
        (Some(first), _) => Some(time[first]),
        // E grows as the distance of twins does: E = E_end exp((t − t_end)/t_L)
        (None, Reach::Extrapolated { lyapunov, .. }) => {
            let late = &distances[distances.len() / 2..];
            let last = late.iter().copied().fold(0.0, f64::max);
            let end = time[distances.len() - 1];
            (last > 0.0).then(|| end + lyapunov * (LIMIT / last).ln())
        }
        (None, _) => None,
    };
    match (of_error, horizon.all.time()) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

impl Estimate {
    /// Whether samples of the run lie beyond the time to which its waveform is meaningful.
    pub fn waveform_ends_within(&self) -> Option<f64> {
        self.waveform.filter(|time| *time < self.until)
    }

    /// Everything, as attributes of a result: names, and texts or numbers.
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let mut list = Vec::new();
        let mut text =
            |name: &str, text: String| list.push((name.to_owned(), Attribute::Text(text)));
        text("error_shadow", self.shadow.to_owned());
        text("chaos_note", self.horizon.all.to_string());
        text("chaos_note_tight_span", self.horizon.tight.to_string());
        text("waveform_note", self.waveform_note());
        let mut number = |name: &str, value: f64| {
            if value.is_finite() {
                list.push((name.to_owned(), Attribute::Number(value)));
            }
        };
        number("error_window", self.window);
        number("error_span_tension", self.tension);
        number("error_tight_span_tension", self.tight_tension);
        let force = |of: fn(&Compared) -> f64| self.force.iter().map(of).fold(f64::NAN, f64::max);
        number("error_contact_force", force(|compared| compared.difference));
        let [p50, p90, p99] = self.force;
        for (name, compared) in [
            ("span_tension_mean", self.mean),
            ("span_tension_rms", self.rms),
            ("contact_force_p50", p50),
            ("contact_force_p90", p90),
            ("contact_force_p99", p99),
        ] {
            number(&format!("error_{name}"), compared.difference);
            number(&format!("spread_{name}"), compared.spread);
        }
        number("chaos_window", self.horizon.window);
        for (name, reach) in [("", self.horizon.all), ("_tight_span", self.horizon.tight)] {
            number(
                &format!("chaos_horizon{name}"),
                reach.time().unwrap_or(f64::NAN),
            );
            if let Reach::Extrapolated { lyapunov, .. } = reach {
                number(&format!("lyapunov_time{name}"), lyapunov);
            }
        }
        number("waveform_horizon", self.waveform.unwrap_or(f64::NAN));
        number("error_evaluations", self.evaluations as f64);
        list
    }

    fn waveform_note(&self) -> String {
        match (self.waveform, self.waveform_ends_within()) {
            (_, Some(at)) => format!(
                "follow them to t = {at:.2e} s; beyond, differences from the exact motion exceed 1 %: use statistics"
            ),
            (Some(at), None) => {
                format!("meaningful throughout the run: 1 % is reached at {at:.2e} s")
            }
            (None, None) => "no time found at which they would be wrong by 1 %".to_owned(),
        }
    }
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Measured { at } => write!(f, "1e-12 m become 1 % at {at:.2e} s, measured"),
            Self::Extrapolated { at, lyapunov } => write!(
                f,
                "1e-12 m become 1 % at {at:.2e} s, extrapolated with a Lyapunov time of {lyapunov:.1e} s"
            ),
            Self::Saturated { level } => write!(
                f,
                "1e-12 m grow and stay at {level:.1e}: no horizon for 1 %"
            ),
            Self::None { largest } => write!(
                f,
                "no growth of 1e-12 m found; the tension differs by {largest:.0e} at most"
            ),
        }
    }
}

/// Per cent, with the digits that mean something.
pub(super) fn percent(value: f64) -> String {
    let value = 100.0 * value;
    if value.is_nan() {
        "none".to_owned()
    } else if value >= 0.1 {
        format!("{value:.1} %")
    } else if value >= 1e-3 {
        format!("{value:.3} %")
    } else {
        format!("{value:.0e} %")
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", percent(self.difference))?;
        if self.within_spread() && self.spread > 0.0 {
            write!(f, " (within the spread of {})", percent(self.spread))?;
        }
        Ok(())
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "numerical error          against {} over the first {:.2e} s",
            self.shadow, self.window
        )?;
        if self.tension.is_nan() {
            return write!(
                f,
                "  nothing to compare     the chain carries no tension there"
            );
        }
        writeln!(
            f,
            "  tension, waveform      {} of the mean tension; tight span {}",
            percent(self.tension),
            percent(self.tight_tension)
        )?;
        writeln!(
            f,
            "  tension, statistics    mean {}, rms {}",
            self.mean, self.rms
        )?;
        let [p50, p90, p99] = &self.force;
        if p50.difference.is_finite() {
            writeln!(
                f,
                "  contact force          p50 {p50}, p90 {p90}, p99 {p99}"
            )?;
        }
        writeln!(f, "chaos                    {}", self.horizon.all)?;
        let tight = self.horizon.tight;
        if tight.time() != self.horizon.all.time() {
            writeln!(f, "  tight span             {tight}")?;
        }
        write!(f, "waveforms                {}", self.waveform_note())
    }
}
