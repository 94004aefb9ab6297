//! The estimate of a run, or why there is none.

use std::fmt;

use super::Watch;
use super::attribute::Attribute;
use super::estimate::{ChannelHorizon, Estimate, estimate_with};
use super::short_runs::ShortRuns;
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
