//! The estimate of a run, or why there is none, in words and as attributes of a result.

use std::fmt;

use super::compare::Comparison;
use super::estimate::{ChannelHorizon, Estimate, estimate_with};
use super::horizon::Divergence;
use super::short_runs::ShortRuns;
use super::trace::Strands;
use super::{Attribute, Watch};
use crate::figure::{duration, percent};
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
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let word = match self {
            Self::Made(_) => "made".to_owned(),
            Self::SwitchedOff => "switched off".to_owned(),
            Self::Interrupted => "interrupted".to_owned(),
            Self::Failed(reason) => format!("failed: {reason}"),
        };
        let mut list = vec![("error_estimate".to_owned(), Attribute::Text(word))];
        list.extend(
            self.estimate()
                .map(Estimate::attributes)
                .unwrap_or_default(),
        );
        list
    }
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Made(estimate) => estimate.fmt(f),
            Self::SwitchedOff => write!(f, "numerical error          not estimated: switched off"),
            Self::Interrupted => write!(f, "numerical error          not estimated: interrupted"),
            Self::Failed(reason) => {
                write!(f, "numerical error          not estimated: {reason}")
            }
        }
    }
}

impl Estimate {
    /// Everything, as attributes of a result: names, and texts or numbers.
    pub fn attributes(&self) -> Vec<(String, Attribute)> {
        let mut list = Vec::new();
        let mut text =
            |name: &str, text: String| list.push((name.to_owned(), Attribute::Text(text)));
        text("error_shadow", self.shadow.to_owned());
        text("error_compared", self.compared_channel().name().to_owned());
        if let Some(gap) = &self.gap {
            text("error_gap", gap.to_string());
        }
        text("chaos_note", self.horizon.sentence());
        text("chaos_note_tight_span", self.horizon.tight_sentence());
        text("waveform_note", self.waveform_note());
        let mut number = |name: &str, value: f64| {
            if value.is_finite() {
                list.push((name.to_owned(), Attribute::Number(value)));
            }
        };
        number("error_window", self.window);
        number("error_factor", self.factor);
        let (all, tight) = match self.strands {
            Strands::Spans => ("error_span_tension", "error_tight_span_tension"),
            Strands::Links => ("error_link_tension", "error_tight_link_tension"),
        };
        number(all, self.tension);
        number(tight, self.tight_tension);
        let force = |of: fn(&Comparison) -> f64| self.force.iter().map(of).fold(f64::NAN, f64::max);
        number("error_contact_force", force(|compared| compared.difference));
        let [p50, p90, p99] = self.force;
        let tension = match self.strands {
            Strands::Spans => "span_tension",
            Strands::Links => "link_tension",
        };
        let of_tension = |statistic: &str| format!("{tension}_{statistic}");
        let [mean, rms, std] = ["mean", "rms", "std"].map(of_tension);
        let tails = ["p1", "p99"].map(of_tension);
        let [deviation, low, high] = self.scatter;
        for (name, compared) in [
            (mean.as_str(), self.mean),
            (rms.as_str(), self.rms),
            (std.as_str(), deviation),
            (tails[0].as_str(), low),
            (tails[1].as_str(), high),
            ("contact_force_p50", p50),
            ("contact_force_p90", p90),
            ("contact_force_p99", p99),
        ] {
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
        number("waveform_horizon", self.waveform.unwrap_or(f64::NAN));
        let links = self.link_waveform.unwrap_or(f64::NAN);
        number("waveform_horizon_link_tension", links);
        number("error_evaluations", self.evaluations as f64);
        list
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
        let (all, tight) = match (self.strands, &self.gap) {
            (Strands::Spans, _) => ("span tension", "tight span"),
            (Strands::Links, _) => ("link tension", "tightest link"),
        };
        writeln!(
            f,
            "numerical error          in the first {}, by {}",
            duration(self.window),
            self.shadow
        )?;
        if let Some(gap) = &self.gap {
            writeln!(f, "  span tension           not examined: {gap}")?;
        }
        if self.tension.is_nan() {
            return write!(
                f,
                "  nothing to compare     the chain carries no tension there"
            );
        }
        writeln!(
            f,
            "  {all}, waveform {} of the mean tension; {tight} {}",
            percent(self.tension),
            percent(self.tight_tension)
        )?;
        writeln!(f, "  {all}, average  mean {}, rms {}", self.mean, self.rms)?;
        let [deviation, low, high] = &self.scatter;
        writeln!(
            f,
            "  {all}, scatter  std {deviation}, p1 {low}, p99 {high} of the mean tension"
        )?;
        let [p50, p90, p99] = &self.force;
        if p50.difference.is_finite() {
            writeln!(
                f,
                "  contact force          p50 {p50}, p90 {p90}, p99 {p99}"
            )?;
        }
        for it in &self.impacts {
            let [p50, p99, impulse, speed] = it.columns().map(|(_, error)| percent(error));
            writeln!(
                f,
                "  {:22} force p50 {p50}, p99 {p99}, impulse {impulse}, closing speed {speed}; {} compared",
                format!("impacts on {}", it.sprocket),
                it.compared
            )?;
        }
        writeln!(f, "chaos                    {}", self.horizon.sentence())?;
        if self.horizon.tight.time() != self.horizon.all.time() {
            let sentence = self.horizon.tight_sentence();
            writeln!(f, "  {tight:22} {sentence}")?;
        }
        write!(f, "waveforms                {}", self.waveform_note())
    }
}
