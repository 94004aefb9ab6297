//! The list of reasons not to trust a result without a second look, and of what its reader is to know.

use std::f64::consts::TAU;
use std::fmt;

use chaindrive_mechanics::Fight;

use super::{LONG_PRESSED, PRESSED, Trust};
use crate::figure::Measure;
use crate::figure::{duration, percent, with_digits};
use crate::precision::{ChannelHorizon, Gap};
use crate::rating::LimitedBy;

/// A reason that speaks against a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// Tensions or forces are not numbers.
    NotFinite {
        /// Samples in which that is so.
        samples: u64,
    },
    /// The energy does not add up.
    EnergyMissing {
        /// Energy unaccounted for, over the energy moved \[–\].
        of_moved: f64,
    },
    /// The energy unaccounted for is of the size of the losses.
    LossesWrong {
        /// Energy unaccounted for, over the losses or 1e-4 of the energy moved, whichever is more \[–\].
        of_losses: f64,
    },
    /// The energy unaccounted for is a noticeable share of the losses.
    LossesUncertain {
        /// See [`Reason::LossesWrong`].
        of_losses: f64,
    },
    /// More energy comes out than goes in.
    EfficiencyAboveOne {
        /// Energy that comes out or is stored, over that supplied \[–\].
        efficiency: f64,
    },
    /// The run has too few steps for its energy to be judged.
    TooShort {
        /// Steps taken.
        steps: u64,
    },
    /// A span has no tension in most samples, because no roller holds it.
    SpanRarelyHeld {
        /// Name of the span.
        span: String,
        /// Share of the samples without a tension \[–\].
        share: f64,
    },
    /// A span has no tension in some samples.
    SpanNotHeld {
        /// Name of the span.
        span: String,
        /// Share of the samples without a tension \[–\].
        share: f64,
    },
    /// The motion has not become steady: means are those of a transient.
    NotSteady {
        /// Name of a span where that is so.
        span: String,
    },
    /// The mean over the run is not that of the steady state, because its start counts.
    StartCounts {
        /// Name of the span where that matters most.
        span: String,
        /// Time at which the steady state begins \[s\].
        until: f64,
        /// Mean over the run less that of the steady state, over the latter \[–\].
        shift: f64,
    },
    /// The run-in came to its end before the motion was steady.
    NotRunIn {
        /// How long it was \[s\].
        time: f64,
    },
    /// The interval of a mean is wide.
    MeansUncertain {
        /// Name of the span where it is widest.
        span: String,
        /// Half width over the mean \[–\].
        width: f64,
        /// End of a record that would make it narrow enough \[s\].
        until: f64,
    },
    /// The step moves means and root mean squares of tensions.
    MeansInexact {
        /// By how much, beyond chance \[–\].
        error: f64,
    },
    /// Links are pressed.
    LinksPressed {
        /// Name of the chain; empty where there is one only.
        chain: String,
        /// Greatest compression of a link \[N\].
        force: f64,
        /// Share of links and samples in which it counts \[–\].
        share: f64,
    },
    /// The record is too short for intervals.
    StatisticsUnknown {
        /// End of a record that would have them \[s\]; infinite where nothing repeats.
        until: f64,
    },
    /// The span tensions could not be compared with those of a sharper run.
    SpansNotExamined {
        /// The span without a tension, and when.
        gap: Gap,
    },
    /// The accuracy asked for is not kept.
    AccuracyMissed {
        /// Asked for \[–\].
        accuracy: f64,
        /// Found \[–\]; infinite if nothing could be compared.
        error: f64,
        /// Whether a step was found that seemed to keep it.
        was_chosen: bool,
    },
    /// Waveforms differ from the exact motion before the run ends.
    HorizonWithinRun {
        /// When those of the span tensions do.
        spans: Option<ChannelHorizon>,
        /// When those of the link tensions do.
        links: Option<ChannelHorizon>,
    },
    /// A link bears more than breaks the chain.
    AboveBreakingLoad {
        /// Name of the chain; empty where there is one only.
        chain: String,
        /// Greatest tension of a link \[N\].
        tension: f64,
        /// Least breaking load \[N\].
        breaking: f64,
    },
    /// A chain carries more power than it is rated for.
    AboveRating {
        /// The smallest sprocket that takes part.
        sprocket: String,
        /// Its mean speed \[rad/s\].
        speed: f64,
        /// Mean power \[W\].
        power: f64,
        /// By how much it counts more \[–\].
        service_factor: f64,
        /// Power that the chain is rated for at this speed \[W\].
        rated: f64,
        /// What limits it.
        limited_by: LimitedBy,
    },
    /// A chain carries power, and there is no rating of its type.
    NotRated {
        /// Name of the chain; empty where there is one only.
        chain: String,
        /// Mean power \[W\].
        power: f64,
        /// What the chain of ASME B29.1 with its pitch is rated for there \[W\].
        twin: Option<f64>,
    },
    /// A contact is deeper than its law reaches.
    DeepContact {
        /// The two that touch.
        place: String,
        /// Deepest indentation \[m\].
        depth: f64,
        /// Depth to which the law reaches \[m\].
        reach: f64,
    },
    /// An impact is faster than a restitution stands for.
    FastImpact {
        /// The two that strike.
        place: String,
        /// Closing speed \[m/s\].
        speed: f64,
        /// Greatest for which the restitution is meant \[m/s\].
        limit: f64,
    },
    /// Sprockets are out of line by more than makers allow.
    OutOfLine {
        /// The span between them.
        span: String,
        /// One of them.
        sprocket: String,
        /// Distance of their planes over that of their shafts \[–\].
        of_centres: f64,
    },
    /// Loads put energy in.
    LoadDrives {
        /// How much \[J\].
        work: f64,
    },
    /// The samples that are kept are too rare for the mesh frequency.
    SamplesRare {
        /// Samples a tooth passing \[–\].
        samples: f64,
        /// Time between them \[s\].
        every: f64,
        /// Time between them at most, for the mesh to be seen \[s\].
        needed: f64,
    },
    /// Motions that are given cannot both be on one chain.
    MotionsFight(Fight),
    /// The error of the end of the run is not known.
    NotExamined {
        /// Time over which the run was examined \[s\].
        window: f64,
        /// Its end \[s\].
        until: f64,
    },
    /// There is no estimate of the error.
    NotEstimated {
        /// The reason.
        why: String,
    },
}

impl Reason {
    /// How far a result can be trusted that this speaks against: trusted where it is a note.
    pub fn trust(&self) -> Trust {
        match self {
            Self::NotFinite { .. }
            | Self::EnergyMissing { .. }
            | Self::LossesWrong { .. }
            | Self::EfficiencyAboveOne { .. }
            | Self::SpanRarelyHeld { .. }
            | Self::AboveBreakingLoad { .. }
            | Self::MotionsFight(_) => Trust::Distrusted,
            Self::LossesUncertain { .. }
            | Self::TooShort { .. }
            | Self::SpanNotHeld { .. }
            | Self::NotSteady { .. }
            | Self::StartCounts { .. }
            | Self::NotRunIn { .. }
            | Self::MeansUncertain { .. }
            | Self::MeansInexact { .. }
            | Self::StatisticsUnknown { .. }
            | Self::AccuracyMissed { .. }
            | Self::AboveRating { .. }
            | Self::DeepContact { .. }
            | Self::FastImpact { .. }
            | Self::OutOfLine { .. }
            | Self::LoadDrives { .. }
            | Self::SamplesRare { .. }
            | Self::NotEstimated { .. } => Trust::Caution,
            Self::LinksPressed { share, .. } if *share > LONG_PRESSED => Trust::Caution,
            Self::LinksPressed { .. }
            | Self::SpansNotExamined { .. }
            | Self::HorizonWithinRun { .. }
            | Self::NotRated { .. }
            | Self::NotExamined { .. } => Trust::Trusted,
        }
    }

    /// Name in results.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "not-finite",
            Self::EnergyMissing { .. } => "energy-missing",
            Self::LossesWrong { .. } => "losses-wrong",
            Self::LossesUncertain { .. } => "losses-uncertain",
            Self::EfficiencyAboveOne { .. } => "efficiency-above-one",
            Self::TooShort { .. } => "too-short",
            Self::SpanRarelyHeld { .. } => "span-rarely-held",
            Self::SpanNotHeld { .. } => "span-not-held",
            Self::NotSteady { .. } => "not-steady",
            Self::StartCounts { .. } => "start-counts",
            Self::NotRunIn { .. } => "not-run-in",
            Self::MeansUncertain { .. } => "means-uncertain",
            Self::MeansInexact { .. } => "means-inexact",
            Self::LinksPressed { .. } => "links-pressed",
            Self::StatisticsUnknown { .. } => "statistics-unknown",
            Self::SpansNotExamined { .. } => "spans-not-examined",
            Self::AccuracyMissed { .. } => "accuracy-missed",
            Self::HorizonWithinRun { .. } => "horizon-within-run",
            Self::AboveBreakingLoad { .. } => "above-breaking-load",
            Self::AboveRating { .. } => "above-rating",
            Self::NotRated { .. } => "not-rated",
            Self::DeepContact { .. } => "deep-contact",
            Self::FastImpact { .. } => "fast-impact",
            Self::OutOfLine { .. } => "out-of-line",
            Self::LoadDrives { .. } => "load-drives",
            Self::SamplesRare { .. } => "samples-rare",
            Self::MotionsFight(_) => "motions-fight",
            Self::NotExamined { .. } => "not-examined",
            Self::NotEstimated { .. } => "not-estimated",
        }
    }
}

/// Advice about energy that is missing.
const SHARPER: &str =
    "take --accuracy-of losses, a smaller --step, or for rigid links --method generalized-alpha";

/// In words, the chain of a name, where there are several.
fn of(chain: &str) -> String {
    match chain {
        "" => String::new(),
        name => format!(" of {name}"),
    }
}

impl fmt::Display for Reason {
    #[expect(
        clippy::too_many_lines,
        reason = "a list: every reason in its own words"
    )]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { samples } => {
                write!(
                    f,
                    "{samples} samples hold tensions or forces that are not numbers: take a smaller --step"
                )
            }
            Self::EnergyMissing { of_moved } => write!(
                f,
                "the energy does not add up, {} of what was moved is unaccounted for: {SHARPER}",
                percent(*of_moved)
            ),
            Self::LossesWrong { of_losses } => write!(
                f,
                "losses and efficiency are wrong, the energy unaccounted for is {} of the losses: {SHARPER}",
                percent(*of_losses)
            ),
            Self::LossesUncertain { of_losses } => write!(
                f,
                "losses are uncertain by {}, the energy unaccounted for: {SHARPER}",
                percent(*of_losses)
            ),
            Self::EfficiencyAboveOne { efficiency } => write!(
                f,
                "more energy comes out than goes in, an efficiency of {:.2} %: {SHARPER}",
                100.0 * efficiency
            ),
            Self::TooShort { steps } => {
                write!(
                    f,
                    "{steps} steps are too few to judge the energy by: take a later --until"
                )
            }
            Self::SpanRarelyHeld { span, share } | Self::SpanNotHeld { span, share } => write!(
                f,
                "span {span} has no tension in {} of the samples, because no roller holds it: raise --set \"route.pretension=…\", or lower the speed",
                percent(*share)
            ),
            Self::NotSteady { span } => write!(
                f,
                "the tension of span {span} is not steady yet: take --run-in auto, or where it was taken a later --until"
            ),
            Self::StartCounts { span, until, shift } => write!(
                f,
                "the start moves the mean tension of span {span} by {}: take --run-in \"{}\"",
                percent(*shift),
                duration(*until)
            ),
            Self::NotRunIn { time } => write!(
                f,
                "the motion was not steady after a run-in of {}, the longest that ends by itself: give --run-in a time",
                duration(*time)
            ),
            Self::MeansUncertain { span, width, until } => write!(
                f,
                "the mean tension of span {span} is known to {} only: take --until \"{}\"",
                percent(*width),
                duration(*until)
            ),
            Self::MeansInexact { error } => write!(
                f,
                "the step moves means or swings of tensions by {}: take --accuracy \"1 %\", or half the --step",
                percent(*error)
            ),
            Self::LinksPressed {
                chain,
                force,
                share,
            } => write!(
                f,
                "links{} are pressed, in {} of links and time by more than {} of the tight span, at most with {force:.0} N, where real links may fold{}",
                of(chain),
                percent(*share),
                percent(PRESSED),
                if *share > LONG_PRESSED {
                    ": raise --set \"route.pretension=…\""
                } else {
                    ""
                }
            ),
            Self::StatisticsUnknown { until } if until.is_finite() => write!(
                f,
                "the record has fewer than three periods of the slowest forcing, so statistics have no intervals: take --until \"{}\"",
                duration(*until)
            ),
            Self::StatisticsUnknown { .. } => write!(
                f,
                "the motion has no period that is known, so means and percentiles are those of this record and have no intervals: take --run-in auto where it comes to run steadily"
            ),
            Self::SpansNotExamined { gap } => write!(
                f,
                "span tensions are not examined, link tensions are instead: {gap}"
            ),
            Self::AccuracyMissed {
                accuracy,
                error,
                was_chosen,
            } => {
                // As many digits as tell the two apart.
                let told = |share: f64| {
                    if share.is_finite() {
                        format!("{} %", with_digits(100.0 * share, 3))
                    } else {
                        percent(share)
                    }
                };
                write!(
                    f,
                    "the error found is {}, and {} was asked for",
                    told(*error),
                    told(*accuracy)
                )?;
                if *was_chosen {
                    let needed = 0.9 * accuracy * accuracy / error;
                    write!(f, ": take --accuracy \"{}\"", told(needed))
                } else {
                    write!(f, ", the best of all steps tried: give a shorter --step")
                }
            }
            Self::HorizonWithinRun { spans, links } => {
                let of = |horizon: &ChannelHorizon, name| {
                    if horizon.at > 0.0 {
                        format!("to {} for {name}", duration(horizon.at))
                    } else {
                        format!("at no time for {name}")
                    }
                };
                let spans = spans.as_ref().map(|horizon| of(horizon, "span tensions"));
                let links = links.as_ref().map(|horizon| of(horizon, "link tensions"));
                let ends: Vec<String> = spans.into_iter().chain(links).collect();
                write!(
                    f,
                    "waveforms are right {}: use statistics beyond",
                    ends.join(", ")
                )
            }
            Self::AboveBreakingLoad {
                chain,
                tension,
                breaking,
            } => {
                write!(
                    f,
                    "a link{} bears {:.1} kN, and the chain breaks at {:.1} kN, though nothing yields in the model: take a stronger chain, --set \"chain.type=…\"",
                    of(chain),
                    tension * 1e-3,
                    breaking * 1e-3
                )
            }
            Self::AboveRating {
                sprocket,
                speed,
                power,
                service_factor,
                rated,
                limited_by,
            } => {
                let (carried, turns) = (power * 1e-3, speed * 60.0 / TAU);
                write!(
                    f,
                    "the chain carries {carried:.1} kW at {turns:.0} rpm of {sprocket}"
                )?;
                if (service_factor - 1.0).abs() > f64::EPSILON {
                    let counted = service_factor * carried;
                    write!(
                        f,
                        ", {counted:.1} kW with the service factor {service_factor}"
                    )?;
                }
                let life = match limited_by {
                    LimitedBy::Maker => "by its maker",
                    _ => "for 15 000 hours",
                };
                let rated = rated * 1e-3;
                write!(
                    f,
                    ", and is rated for {rated:.1} kW there, {life}: take a stronger chain, see chaindrive design"
                )
            }
            Self::NotRated { chain, power, twin } => {
                let told = |power: f64| Measure::Power.told(power);
                write!(
                    f,
                    "nobody rates this type in a source that could be read, so whether the chain{} may carry {} is not checked",
                    of(chain),
                    told(*power)
                )?;
                if let Some(twin) = twin {
                    let (share, twin) = (100.0 * power / twin, told(*twin));
                    write!(
                        f,
                        " ({share:.0} % of the {twin} that ASME B29.1 rates its chain of this pitch for)"
                    )?;
                }
                write!(f, ": give what the maker says as chain.rated_power")
            }
            Self::DeepContact {
                place,
                depth,
                reach,
            } => write!(
                f,
                "{place}: indented by {:.1} µm, and the law reaches to {:.1} µm, beyond which its forces are no prediction: take another law, --set \"contact.….law=…\"",
                depth * 1e6,
                reach * 1e6
            ),
            Self::FastImpact {
                place,
                speed,
                limit,
            } => write!(
                f,
                "{place}: struck at {speed:.1} m/s, and one restitution stands for impacts up to {limit} m/s: give that of such impacts, --set \"contact.….restitution=…\""
            ),
            Self::OutOfLine {
                span,
                sprocket,
                of_centres,
            } => write!(
                f,
                "the sprockets of span {span} are out of line by {} of the distance of their shafts: where that is not meant so, align them with --set \"sprockets.{sprocket}.lateral=…\"",
                percent(*of_centres)
            ),
            Self::LoadDrives { work } => write!(
                f,
                "loads put {} in, and a load should take energy out: turn its sign, or name a motor under `drive`",
                Measure::Energy.told(*work)
            ),
            Self::SamplesRare {
                samples,
                every,
                needed,
            } => write!(
                f,
                "{samples:.1} samples a tooth passing, one in {}: spectra show the mesh at another frequency: take --every \"{}\"",
                duration(*every),
                duration(*needed)
            ),
            Self::MotionsFight(fight) => fight.fmt(f),
            Self::NotExamined { window, until } => write!(
                f,
                "the error was estimated on the first {} of {}, and stands for the rest",
                duration(*window),
                duration(*until)
            ),
            Self::NotEstimated { why } => {
                write!(
                    f,
                    "the error is not estimated, {why}: run it without --no-error, to its end"
                )
            }
        }
    }
}
