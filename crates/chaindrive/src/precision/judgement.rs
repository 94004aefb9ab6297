//! The estimate of a run, or why there is none, in words and as attributes of a result.

use std::fmt::{self, Write as _};

use serde_json::{Map, Value};

use super::Watch;
use super::compare::Comparison;
use super::estimate::{ChannelHorizon, Estimate, estimate_with};
use super::horizon::Divergence;
use super::short_runs::ShortRuns;
use super::trace::Strands;
use crate::figure::{duration, percent};
use crate::sheet::{NAMES, aligned, lines};
use crate::story::Story;
use crate::{Channel, Run, Simulation, SimulationError};

/// Statement about the error of a run, made at its end.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// An estimate.
    Made(Box<Estimate>),
    /// None, because nobody wanted it.
    SwitchedOff,
    /// None, because somebody stopped the run or the estimate.
    Interrupted,
    /// None, because a run with half the step or its twin failed; with the reason.
    Failed(String),
}

impl Judgement {
    /// Judges a run, whatever becomes of the attempt.
    pub fn of(simulation: &Simulation, run: &Run, watch: Watch<'_>) -> Self {
        Self::with(&mut ShortRuns::default(), simulation, run, watch)
    }

    /// The same, going on with short runs from the start of the simulation.
    pub(crate) fn with(
        short_runs: &mut ShortRuns,
        simulation: &Simulation,
        run: &Run,
        watch: Watch<'_>,
    ) -> Self {
        match estimate_with(short_runs, simulation.assembled(), run, watch) {
            Ok(made) => Self::Made(Box::new(made)),
            Err(SimulationError::Interrupted) => Self::Interrupted,
            Err(error) => Self::Failed(error.to_string()),
        }
    }

    /// The estimate, if there is one.
    pub fn estimate(&self) -> Option<&Estimate> {
        match self {
            Self::Made(estimate) => Some(estimate),
            Self::SwitchedOff | Self::Interrupted | Self::Failed(_) => None,
        }
    }

    /// When the waveform of a channel ceases to mean anything, if that is within the run.
    pub fn horizon_of(&self, channel: Channel) -> Option<ChannelHorizon> {
        self.estimate()
            .and_then(|estimate| estimate.horizon_of(channel))
    }

    /// Attributes of a result: `error_estimate`, and the findings.
    pub fn attributes(&self) -> Map<String, Value> {
        let mut story = Story::default();
        let word = match self {
            Self::Made(_) => "made",
            Self::SwitchedOff => "switched off",
            Self::Interrupted => "interrupted",
            Self::Failed(reason) => &format!("failed: {reason}"),
        };
        story.text("error_estimate", word);
        if let Some(estimate) = self.estimate() {
            estimate.attributes(&mut story);
        }
        story.0
    }
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let why = match self {
            Self::Made(estimate) => return estimate.fmt(f),
            Self::SwitchedOff => "switched off",
            Self::Interrupted => "interrupted",
            Self::Failed(reason) => reason,
        };
        write!(f, "{:NAMES$} not estimated: {why}", "numerical error")
    }
}

impl Estimate {
    /// Tells everything.
    fn attributes(&self, story: &mut Story) {
        let strand = match self.strands {
            Strands::Spans => "span",
            Strands::Links => "link",
        };
        story.text("error_shadow", self.shadow);
        story.text("error_compared", self.compared_channel().name());
        if let Some(gap) = &self.gap {
            story.text("error_gap", &gap.to_string());
        }
        story.text("chaos_note", &self.horizon.sentence());
        story.text("chaos_note_tight_span", &self.horizon.tight_sentence());
        story.text("waveform_note", &self.waveform_note());
        let mut number = |name: &str, value: f64| story.number(name, value);
        number("error_window", self.window);
        number("error_factor", self.factor);
        number(&format!("error_{strand}_tension"), self.tension);
        number(&format!("error_tight_{strand}_tension"), self.tight_tension);
        let of_forces = self.force.iter().map(|it| it.difference);
        number("error_contact_force", of_forces.fold(f64::NAN, f64::max));
        let of_tensions = ["mean", "rms", "std", "p1", "p99"];
        let of_tensions = of_tensions.map(|it| format!("{strand}_tension_{it}"));
        let of_forces = ["p50", "p90", "p99"].map(|it| format!("contact_force_{it}"));
        let names = of_tensions.into_iter().chain(of_forces);
        let compared = [self.mean, self.rms].into_iter().chain(self.scatter);
        for (name, compared) in names.zip(compared.chain(self.force)) {
            number(&format!("error_{name}"), compared.difference);
            number(&format!("spread_{name}"), compared.spread);
        }
        for it in &self.impacts {
            let greatest = ("impact_force_max", it.p99);
            for (name, error) in it.columns().into_iter().chain([greatest]) {
                number(&format!("error_{name}_{}", it.sprocket), error);
            }
        }
        number("chaos_window", self.horizon.window);
        let divergences = [("", self.horizon.all), ("_tight_span", self.horizon.tight)];
        for (name, divergence) in divergences {
            let time = divergence.time().unwrap_or(f64::NAN);
            number(&format!("chaos_horizon{name}"), time);
            if let Divergence::Extrapolated { lyapunov, .. } = divergence {
                number(&format!("lyapunov_time{name}"), lyapunov);
            }
        }
        let or_nan = |time: Option<f64>| time.unwrap_or(f64::NAN);
        number("waveform_horizon", or_nan(self.waveform));
        number("waveform_horizon_link_tension", or_nan(self.link_waveform));
        number("error_evaluations", self.evaluations as f64);
    }

    /// Reach of the waveforms, and of the examination.
    fn waveform_note(&self) -> String {
        let ends = |at: f64| {
            let at = duration(at);
            format!("to {at}: beyond, they differ from the exact motion by more than 1 %")
        };
        let name = self.compared_channel().name();
        let own = match (self.waveform, self.waveform_ends_within()) {
            (_, Some(at)) => format!("follow {name} {}", ends(at)),
            (Some(at), None) if !self.examined_throughout() => format!(
                "{name} is expected to stay within 1 % until {}, not examined beyond {}",
                duration(at),
                duration(self.window)
            ),
            (None, None) if !self.examined_throughout() => format!(
                "{name} stays within 1 % for {}, not examined beyond",
                duration(self.window)
            ),
            _ => format!("{name} stays within 1 % throughout the run"),
        };
        let links = self.link_waveform.filter(|at| *at < self.until);
        match (self.strands, links) {
            (Strands::Spans, Some(at)) => format!("{own}; link_tension {}", ends(at)),
            _ => own,
        }
    }
}

impl fmt::Display for Comparison {
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
        let mut sheet = String::new();
        self.tell(&mut sheet)?;
        f.write_str(&aligned(sheet.trim_end(), NAMES))
    }
}

impl Estimate {
    fn tell(&self, sheet: &mut String) -> fmt::Result {
        let (all, tight) = match self.strands {
            Strands::Spans => ("span tension", "tight span"),
            Strands::Links => ("link tension", "tightest link"),
        };
        lines! { sheet; "numerical error\tin the first {}, by {}", duration(self.window), self.shadow; }
        if let Some(gap) = &self.gap {
            lines! { sheet; "  span tension\tnot examined: {gap}"; }
        }
        if self.tension.is_nan() {
            lines! { sheet; "  nothing to compare\tthe chain carries no tension there"; }
            return Ok(());
        }
        let [tension, tightest] = [self.tension, self.tight_tension].map(percent);
        let [deviation, low, high] = &self.scatter;
        lines! { sheet;
            "  {all}, waveform\t{tension} of the mean tension; {tight} {tightest}";
            "  {all}, average\tmean {}, rms {}", self.mean, self.rms;
            "  {all}, scatter\tstd {deviation}, p1 {low}, p99 {high} of the mean tension";
        }
        let [median, p90, p99] = &self.force;
        if median.difference.is_finite() {
            lines! { sheet; "  contact force\tmedian {median}, p90 {p90}, p99 {p99}"; }
        }
        for it in &self.impacts {
            let [median, p99, impulse, speed] = it.columns().map(|(_, error)| percent(error));
            lines! { sheet;
                "  impacts on {}\tforce median {median}, p99 {p99}, impulse {impulse}, closing speed {speed}; {} compared",
                    it.sprocket, it.compared;
            }
        }
        lines! { sheet; "chaos\t{}", self.horizon.sentence(); }
        if self.horizon.tight.time() != self.horizon.all.time() {
            lines! { sheet; "  {tight}\t{}", self.horizon.tight_sentence(); }
        }
        lines! { sheet; "waveforms\t{}", self.waveform_note(); }
        Ok(())
    }
}
