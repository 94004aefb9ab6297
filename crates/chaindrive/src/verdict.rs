//! Whether a result can be trusted, and the reasons why not.
//!
//! | verdict | means |
//! |---|---|
//! | trusted | nothing speaks against its statistics; notes say up to when its waveforms can be followed |
//! | caution | some of the result is uncertain; every reason ends with what to type |
//! | distrusted | the result contradicts itself |
//!
//! [`Reason`] is the list of everything that is looked at, [`Verdict::rules`] say when each speaks, and [`Verdict::of`] looks.

mod duty;
mod reason;

use std::fmt::{self, Write as _};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::chain_verdict::{ChainVerdict, WrittenChainVerdict};
use crate::precision::{Choice, Estimate, Judgement, LEAST_LOSSES, Promise};
use crate::sheet::{NAMES, aligned};
use crate::story::Story;
use crate::summary::{Ledger, Steadiness, Summary};
use crate::{Channel, RunInReport, Simulation};

pub use reason::{Reason, Rule};

/// How far a result can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trust {
    /// Nothing speaks against it.
    Trusted,
    /// Some of it is uncertain, or was not examined.
    Caution,
    /// It contradicts itself.
    Distrusted,
}

impl Trust {
    /// Word in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trusted => "trusted",
            Self::Caution => "caution",
            Self::Distrusted => "distrusted",
        }
    }
}

/// Verdict on a result: how far it can be trusted, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The worst of the reasons.
    pub trust: Trust,
    /// Reasons against the result, the worst first.
    pub reasons: Vec<Reason>,
    /// Remarks for the reader that do not speak against the result.
    pub notes: Vec<Reason>,
    /// The verdict on the chains themselves, once the run has ended.
    pub chains: ChainVerdict,
}

/// A verdict in the words of results.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WrittenVerdict {
    /// The attribute `verdict`: trusted, caution or distrusted; empty where there is no result.
    pub verdict: String,
    /// The attribute `reasons`: names, with blanks between them.
    pub reasons: String,
    /// The attribute `verdict_note`: the reasons in words, the notes after them.
    pub note: String,
    /// The verdict on the chains.
    #[serde(default)]
    pub chains: WrittenChainVerdict,
}

impl WrittenVerdict {
    /// Whether the result contradicts itself.
    pub fn is_distrusted(&self) -> bool {
        self.verdict == Trust::Distrusted.name()
    }
}

/// Share of the energy moved that may be missing before the run is distrusted. *Assumed*: ten times what a coarse step leaves.
const OPEN_LEDGER: f64 = 0.1;
/// Share of the kinetic energy that may be missing of a free motion: a ring that spins in balance moves no energy.
/// *Assumed*.
const OPEN_MOTION: f64 = 0.01;
/// Share of the losses that may be missing before they, and the efficiency, are called uncertain. *Assumed*: 0.2 points of an
/// efficiency of 98 %.
const UNCERTAIN_LOSSES: f64 = 0.1;
/// The same before a drive that transmits energy is distrusted: what is missing is of the size of the losses. *Assumed*.
const WRONG_LOSSES: f64 = 0.5;
/// Efficiency above which more comes out than goes in, by more than a drive without losses may err.
const MOST_EFFICIENCY: f64 = 1.0 + WRONG_LOSSES * LEAST_LOSSES;
/// Steps below which the error of the first one is all that a ledger shows. *Assumed*.
const LEAST_STEPS: u64 = 32;
/// Share of the time without a tension above which the statistics of a span are not those of the run: most of it is missing.
const UNHELD: f64 = 0.5;
/// Share of a mean below which the start of a run does not count. *Assumed*: below what anybody reads off a tension.
const LEAST_SHIFT: f64 = 0.01;
/// Half width of the interval of a mean, over that mean, above which it is uncertain. *Assumed*.
const WIDE: f64 = 0.05;
/// Share of the tension of the tight span from which on a link that is pressed counts, and share of links and time above which that is no note any more.
/// *Assumed*: links between seated rollers are pressed for a moment when one is struck, and a strand that is pressed for longer would fold.
const PRESSED: f64 = Summary::PRESSED;
const LONG_PRESSED: f64 = 0.01;
/// Samples a tooth passing below which the mesh is seen at another frequency than its own: H. Nyquist, *Trans. AIEE* **47**, 1928,
/// 617–644.
const LEAST_SAMPLES: f64 = 2.0;
/// Share of the energy that loads exchange, above which they drive in the net. *Assumed*: those that swing, as the torque of cams does,
/// leave less in a run that is cut off at any moment.
const DRIVES: f64 = 0.25;
/// Share of the energy moved below which it does not matter who drives. *Assumed*.
const MATTERS: f64 = 0.01;

impl Verdict {
    /// The verdict on a run that ended: by its samples, how it was run in, the estimate of its error, and the choice of its
    /// method.
    pub fn of(
        summary: &Summary,
        simulation: &Simulation,
        ran_in: Option<&RunInReport>,
        choice: Option<&Choice>,
        judgement: Option<&Judgement>,
    ) -> Self {
        let mut reasons = Vec::new();
        reasons.extend(not_finite(summary));
        reasons.extend(ledger(&summary.ledger(), simulation.statistics().steps));
        reasons.extend(spans(summary));
        reasons.extend(duty::found(summary, simulation));
        let found = summary.steadiness().into_iter().zip(summary.scales());
        let spans = summary.spans.iter().zip(found);
        let known =
            spans.filter_map(|(span, (found, scale))| Some((span.name.as_str(), found?, scale)));
        let until = summary.known_from();
        let time = simulation.time();
        reasons.extend(steadiness(&known.collect::<Vec<_>>(), until, time));
        reasons.extend(ran_in.and_then(started));
        let estimate = judgement.and_then(Judgement::estimate);
        reasons.extend(choice.and_then(|it| accuracy(it, estimate, summary)));
        reasons.extend(estimate.and_then(inexact));
        reasons.extend(examination(judgement));
        Self::from_reasons(reasons)
    }

    /// The verdict that some reasons make.
    pub fn from_reasons(found: Vec<Reason>) -> Self {
        let is_note = |reason: &Reason| reason.trust() == Trust::Trusted;
        let (notes, mut reasons): (Vec<_>, Vec<_>) = found.into_iter().partition(is_note);
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.trust()));
        let trust = reasons.first().map_or(Trust::Trusted, Reason::trust);
        Self {
            trust,
            reasons,
            notes,
            chains: ChainVerdict::default(),
        }
    }

    /// Whether the result contradicts itself.
    pub fn is_distrusted(&self) -> bool {
        self.trust == Trust::Distrusted
    }

    /// The verdict as results have it.
    pub fn written(&self) -> WrittenVerdict {
        let names: Vec<&str> = self.reasons.iter().map(Reason::name).collect();
        WrittenVerdict {
            verdict: self.trust.name().to_owned(),
            reasons: names.join(" "),
            note: self.note(),
            chains: self.chains.written(),
        }
    }

    /// Attributes of a result.
    pub fn attributes(&self) -> Map<String, Value> {
        let written = self.written();
        let mut story = Story::default();
        story.text("verdict", &written.verdict);
        story.text("reasons", &written.reasons);
        story.text("verdict_note", &written.note);
        story.0.extend(self.chains.attributes());
        story.0
    }

    /// The reasons in words, and the notes after them, with semicolons between them.
    pub fn note(&self) -> String {
        let all = self.reasons.iter().chain(&self.notes);
        all.map(Reason::to_string).collect::<Vec<_>>().join("; ")
    }

    /// The verdict in at most three sentences, each with what to type where that helps.
    pub fn sentences(&self) -> Vec<String> {
        let first = match self.trust {
            Trust::Trusted => "The statistics can be used.",
            Trust::Caution => "Use the result with care.",
            Trust::Distrusted => "Do not use the result.",
        };
        let told = if self.reasons.is_empty() {
            &self.notes
        } else {
            &self.reasons
        };
        let mut sentences = vec![first.to_owned()];
        match told.as_slice() {
            [] => {}
            [one] => sentences.push(sentence(one)),
            [one, other] => sentences.extend([sentence(one), sentence(other)]),
            [one, rest @ ..] => sentences.extend([
                sentence(one),
                format!("{} more remarks: --numerics.", rest.len()),
            ]),
        }
        sentences
    }

    /// The reasons in a line, where they are cautions and nothing worse.
    pub fn caution(&self) -> Option<String> {
        let words: Vec<String> = self.reasons.iter().map(Reason::to_string).collect();
        (self.trust == Trust::Caution)
            .then(|| format!("be careful with this run: {}", words.join("; ")))
    }

    /// One line for whoever asked to hear of errors only; none unless the result is distrusted.
    pub fn warning(&self) -> Option<String> {
        let worst = self.reasons.iter().filter(|r| r.trust() == self.trust);
        let words: Vec<String> = worst.map(Reason::to_string).collect();
        self.is_distrusted()
            .then(|| format!("do not trust this run: {}", words.join("; ")))
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = format!("verdict\t{}", self.trust.name());
        for reason in &self.reasons {
            write!(text, "\n  {}\t{reason}", reason.trust().name())?;
        }
        for note in &self.notes {
            write!(text, "\n  note\t{note}")?;
        }
        f.write_str(&aligned(&text, NAMES))
    }
}

/// A reason as a sentence.
fn sentence(reason: &Reason) -> String {
    let text = reason.to_string();
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).chain(['.']).collect()
}

fn not_finite(summary: &Summary) -> Option<Reason> {
    let samples = summary.not_finite;
    (samples > 0).then_some(Reason::NotFinite { samples })
}

/// Reasons against the energy ledger of a run of some steps.
///
/// ```text
/// |R| / max(D, 1e-4 M)    R: residual, D: losses, M: energy moved
/// η = 1 − (D − R) / E     E: energy supplied; and 1 − D/E, which is printed
/// ```
///
/// A free motion has no efficiency: its residual is judged by the energy that swings, and by that of its motion.
fn ledger(ledger: &Ledger, steps: u64) -> Vec<Reason> {
    let missing = ledger.residual.abs();
    // What is printed, or what it would be with the residual.
    let printed = ledger.efficiency().map(|[efficiency, _]| efficiency);
    let with_residual = 1.0 - (ledger.losses - ledger.residual) / ledger.supplied;
    let greatest = |of: f64| {
        printed
            .map(|it| it.max(of))
            .filter(|it| *it > MOST_EFFICIENCY)
    };
    let above_one = |efficiency: f64| Reason::EfficiencyAboveOne { efficiency };
    if missing <= ledger.rounding {
        return greatest(f64::NEG_INFINITY)
            .map(above_one)
            .into_iter()
            .collect();
    }
    if steps < LEAST_STEPS {
        return vec![Reason::TooShort { steps }];
    }
    let mut reasons = Vec::new();
    let transmits = ledger.exchanged > 0.0;
    if !transmits && missing <= OPEN_MOTION * ledger.kinetic {
        return reasons;
    }
    // What is not a number is as bad as can be.
    let share = |of: f64| Some(missing / of).filter(|it| !it.is_nan());
    let of_moved = share(ledger.moved).unwrap_or(f64::INFINITY);
    let losses = ledger.losses.max(LEAST_LOSSES * ledger.moved);
    let of_losses = share(losses).unwrap_or(f64::INFINITY);
    if of_moved > OPEN_LEDGER {
        reasons.push(Reason::EnergyMissing { of_moved });
    } else if transmits && of_losses > UNCERTAIN_LOSSES {
        reasons.push(if of_losses <= WRONG_LOSSES {
            Reason::LossesUncertain { of_losses }
        } else {
            Reason::LossesWrong { of_losses }
        });
    }
    reasons.extend(greatest(with_residual).map(above_one));
    reasons
}

fn spans(summary: &Summary) -> impl Iterator<Item = Reason> {
    summary
        .spans
        .iter()
        .filter(|span| span.missing > 0)
        .map(|span| {
            let share = span.missing as f64 / span.readings as f64;
            let span = span.name.clone();
            if share > UNHELD {
                Reason::SpanRarelyHeld { span, share }
            } else {
                Reason::SpanNotHeld { span, share }
            }
        })
}

/// Reasons against statistics: names of spans, what is known of them, and what errors are measured by; `until` \[s\]: end of a record that
/// would tell how well they are known; `time` \[s\]: its present end.
fn steadiness(spans: &[(&str, Steadiness, f64)], until: Option<f64>, time: f64) -> Vec<Reason> {
    if let Some((span, ..)) = spans.iter().find(|(_, found, _)| !found.is_steady) {
        let span = (*span).to_owned();
        return vec![Reason::NotSteady { span }];
    }
    let mut reasons = Vec::new();
    let shifts = spans.iter().map(|(span, found, scale)| {
        let shift = (found.mean.value - found.settled).abs() / scale;
        (*span, found.from, shift)
    });
    if let Some((span, until, shift)) = shifts.max_by(|a, b| a.2.total_cmp(&b.2))
        && shift > LEAST_SHIFT
    {
        let span = span.to_owned();
        reasons.push(Reason::StartCounts { span, until, shift });
    }
    let unknown = spans
        .iter()
        .any(|(_, found, _)| found.mean.half_width.is_nan());
    if let Some(until) = until.or(unknown.then_some(f64::INFINITY)) {
        reasons.push(Reason::StatisticsUnknown { until });
    }
    let widths = spans
        .iter()
        .map(|(span, found, scale)| (*span, found.mean.half_width / scale));
    if let Some((span, width)) = widths.max_by(|a, b| a.1.total_cmp(&b.1))
        && width > WIDE
    {
        let span = span.to_owned();
        // Half widths fall with the root of the time.
        let until = time * (width / WIDE).powi(2);
        reasons.push(Reason::MeansUncertain { span, width, until });
    }
    reasons
}

/// Reason against a run-in that was to end by itself and did not.
fn started(ran_in: &RunInReport) -> Option<Reason> {
    let gave_up = ran_in.is_steady == Some(false);
    gave_up.then_some(Reason::NotRunIn { time: ran_in.time })
}

/// Reason from an accuracy that the choice, or the run in its own judgement, does not keep.
fn accuracy(choice: &Choice, estimate: Option<&Estimate>, summary: &Summary) -> Option<Reason> {
    let of_losses = {
        let ledger = summary.ledger();
        ledger.residual.abs() / ledger.losses.max(LEAST_LOSSES * ledger.moved)
    };
    let found = match choice.promise {
        Promise::Nothing => return None,
        _ if !choice.kept => choice.error,
        Promise::Losses => of_losses,
        promise => estimate?.of(promise)?,
    };
    (found > choice.accuracy).then_some(Reason::AccuracyMissed {
        accuracy: choice.accuracy,
        error: found,
        was_chosen: choice.kept,
    })
}

fn inexact(estimate: &Estimate) -> Option<Reason> {
    let error = estimate.statistics();
    (error > WIDE).then_some(Reason::MeansInexact { error })
}

/// Reasons from the estimate of the error, and from parts of the run that it did not look at.
fn examination(judgement: Option<&Judgement>) -> Vec<Reason> {
    let estimate = match judgement {
        Some(Judgement::Made(estimate)) => estimate,
        Some(Judgement::SwitchedOff) => return not_estimated("switched off"),
        Some(Judgement::Interrupted) => return not_estimated("interrupted"),
        Some(Judgement::Failed(why)) => return not_estimated(why),
        None => return not_estimated("the run did not end"),
    };
    let mut reasons = Vec::new();
    if let Some(gap) = &estimate.gap {
        reasons.push(Reason::SpansNotExamined { gap: gap.clone() });
    }
    let spans = estimate.horizon_of(Channel::SpanTension);
    let links = estimate.horizon_of(Channel::LinkTension);
    if spans.is_some() || links.is_some() {
        reasons.push(Reason::HorizonWithinRun { spans, links });
    }
    if !estimate.examined_throughout() {
        let (window, until) = (estimate.window, estimate.until);
        reasons.push(Reason::NotExamined { window, until });
    }
    reasons
}

fn not_estimated(why: &str) -> Vec<Reason> {
    let why = why.to_owned();
    vec![Reason::NotEstimated { why }]
}

#[cfg(test)]
mod tests;
