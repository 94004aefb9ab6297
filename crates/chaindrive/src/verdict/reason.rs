//! The list of reasons not to trust a result without a second look, and of what its reader is to know: a row has its name, what it makes of a
//! result, its words, when it speaks, and on whose authority.

use std::fmt;

use chaindrive_contact::dissipation::FASTEST_IMPACT;
use chaindrive_mechanics::MotionConflict;

use super::{
    DRIVES, LEAST_SAMPLES, LEAST_SHIFT, LEAST_STEPS, LONG_PRESSED, MATTERS, MOST_EFFICIENCY,
    OPEN_LEDGER, OPEN_MOTION, PRESSED, Trust, UNCERTAIN_LOSSES, UNHELD, Verdict, WIDE,
    WRONG_LOSSES,
};
use crate::MOST_CIRCUITS;
use crate::figure::{Measure, duration, percent, with_digits};
use crate::precision::{ChannelHorizon, Gap, LEAST_LOSSES};
use crate::summary::DRIFT;

/// When a reason speaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// Its [name](Reason::name) in results.
    pub name: &'static str,
    /// What it makes of a result.
    pub trust: Trust,
    /// When it speaks.
    pub when: String,
    /// Where the threshold comes from.
    pub source: &'static str,
}

macro_rules! reasons {
    ($(
        $(#[$doc:meta])*
        $variant:ident, $name:literal, $trust:ident {
            $($(#[$of:meta])* $field:ident: $type:ty,)*
        }
        says ($($text:tt)*)
        when ($($when:tt)*)
        by $source:expr;
    )*) => {
        /// A reason that speaks against a result.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Reason {
            $($(#[$doc])* $variant { $($(#[$of])* $field: $type,)* },)*
        }

        impl Reason {
            /// Name in results.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant { .. } => $name,)* }
            }

            /// The trust of its rule.
            fn ruled(&self) -> Trust {
                match self { $(Self::$variant { .. } => Trust::$trust,)* }
            }
        }

        impl fmt::Display for Reason {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self { $(Self::$variant { $($field),* } => write!(f, $($text)*),)* }
            }
        }

        impl Verdict {
            /// When each [`Reason`] speaks, the worst first.
            pub fn rules() -> Vec<Rule> {
                vec![$(Rule {
                    name: $name,
                    trust: Trust::$trust,
                    when: format!($($when)*),
                    source: $source,
                },)*]
            }
        }
    };
}

const ASSUMED: &str = "assumed";
const COUNTED: &str = "nothing to choose";

/// Advice about energy that is missing.
const SHARPER: &str =
    "take --accuracy-of losses, a smaller --step, or for rigid links --method generalized-alpha";

reasons! {
    /// Tensions or forces are not numbers.
    NotFinite, "not-finite", Distrusted {
        /// Samples in which that is so.
        samples: u64,
    }
    says ("{samples} samples hold tensions or forces that are not numbers: take a smaller --step")
    when ("a tension or a contact force of a sample is not a number") by COUNTED;

    /// The energy does not add up.
    EnergyMissing, "energy-missing", Distrusted {
        /// Energy unaccounted for, over the energy moved \[–\].
        of_moved: f64,
    }
    says ("the energy does not add up, {} of what was moved is unaccounted for: {SHARPER}", percent(*of_moved))
    when ("energy unaccounted for: more than {} of what was moved, of a free motion {} of the kinetic energy",
        percent(OPEN_LEDGER), percent(OPEN_MOTION)) by "assumed: ten times what a coarse step leaves";

    /// The energy unaccounted for is of the size of the losses.
    LossesWrong, "losses-wrong", Distrusted {
        /// Energy unaccounted for, over the losses or 1e-4 of the energy moved, whichever is more \[–\].
        of_losses: f64,
    }
    says ("losses and efficiency are wrong, the energy unaccounted for is {} of the losses: {SHARPER}", percent(*of_losses))
    when ("energy unaccounted for: more than {} of the losses, or of {LEAST_LOSSES} of the energy moved where that is more",
        percent(WRONG_LOSSES)) by ASSUMED;

    /// More energy comes out than goes in.
    EfficiencyAboveOne, "efficiency-above-one", Distrusted {
        /// Energy that comes out or is stored, over that supplied \[–\].
        efficiency: f64,
    }
    says ("more energy comes out than goes in, an efficiency of {:.2} %: {SHARPER}", 100.0 * efficiency)
    when ("what comes out and is stored, over what goes in, exceeds {MOST_EFFICIENCY}") by "the floor of losses-wrong";

    /// A span has no tension in most samples, because no roller holds it.
    SpanRarelyHeld, "span-rarely-held", Distrusted {
        /// Name of the span.
        span: String,
        /// Share of the time without a tension \[–\].
        share: f64,
    }
    says ("{}", unheld(span, *share))
    when ("no roller holds a span in more than {} of the time", percent(UNHELD)) by "most of its record is missing";

    /// A link bears more than breaks the chain.
    AboveBreakingLoad, "above-breaking-load", Distrusted {
        /// Name of the chain; empty where there is one only.
        chain: String,
        /// Greatest tension of a link \[N\].
        tension: f64,
        /// Least breaking load \[N\].
        breaking: f64,
    }
    says ("a link{} bears {:.1} kN, and the chain breaks at {:.1} kN, though nothing yields in the model: take a stronger chain, --set \"chain.type=…\"",
        of(chain), tension * 1e-3, breaking * 1e-3)
    when ("a link bears more than the least breaking load of its chain") by "ISO 606, ASME B29.1";

    /// Motions that are given cannot both be on one chain.
    MotionsFight, "motions-fight", Distrusted {
        /// The two motions.
        fight: MotionConflict,
    }
    says ("{fight}")
    when ("motions that are given move a chain more than a tooth apart") by "springs and slack take up less";

    /// The energy unaccounted for is a noticeable share of the losses.
    LossesUncertain, "losses-uncertain", Caution {
        /// See [`Reason::LossesWrong`].
        of_losses: f64,
    }
    says ("losses are uncertain by {}, the energy unaccounted for: {SHARPER}", percent(*of_losses))
    when ("as losses-wrong, more than {}", percent(UNCERTAIN_LOSSES)) by "assumed: 0.2 points of an efficiency of 98 %";

    /// The run has too few steps for its energy to be judged.
    TooShort, "too-short", Caution {
        /// Steps taken.
        steps: u64,
    }
    says ("{steps} steps are too few to judge the energy by: take a later --until")
    when ("fewer than {LEAST_STEPS} steps") by ASSUMED;

    /// A span has no tension in some samples.
    SpanNotHeld, "span-not-held", Caution {
        /// Name of the span.
        span: String,
        /// Share of the time without a tension \[–\].
        share: f64,
    }
    says ("{}", unheld(span, *share))
    when ("no roller holds a span at some time") by COUNTED;

    /// The motion has not become steady: means are those of a transient.
    NotSteady, "not-steady", Caution {
        /// Name of a span where that is so.
        span: String,
    }
    says ("the tension of span {span} is not steady yet: take --run-in auto, or where it was taken a later --until")
    when ("mean or standard deviation of a span drifts by more than chance and {} of its scale, for all of the record", percent(DRIFT))
    by ASSUMED;

    /// The mean over the run is not that of the steady state, because its start counts.
    StartCounts, "start-counts", Caution {
        /// Name of the span where that matters most.
        span: String,
        /// Time at which the steady state begins \[s\].
        until: f64,
        /// Mean over the run less that of the steady state, over the latter \[–\].
        shift: f64,
    }
    says ("the start moves the mean tension of span {span} by {}: take --run-in \"{}\"", percent(*shift), duration(*until))
    when ("the mean of a span is off the steady one by more than {} of its scale", percent(LEAST_SHIFT))
    by "assumed: below what anybody reads off a tension";

    /// The run-in came to its end before the motion was steady.
    NotRunIn, "not-run-in", Caution {
        /// How long it was \[s\].
        time: f64,
    }
    says ("the motion was not steady after a run-in of {}, the longest that ends by itself: give --run-in a time", duration(*time))
    when ("no run-in of up to {MOST_CIRCUITS} circuits ends in a steady motion") by ASSUMED;

    /// The interval of a mean is wide.
    MeansUncertain, "means-uncertain", Caution {
        /// Name of the span where it is widest.
        span: String,
        /// Half width over the mean \[–\].
        width: f64,
        /// End of a record that would make it narrow enough \[s\].
        until: f64,
    }
    says ("the mean tension of span {span} is known to {} only: take --until \"{}\"", percent(*width), duration(*until))
    when ("half of the 95 % interval of a mean is more than {} of its scale", percent(WIDE)) by ASSUMED;

    /// The step moves means and root mean squares of tensions.
    MeansInexact, "means-inexact", Caution {
        /// By how much, beyond chance \[–\].
        error: f64,
    }
    says ("the step moves means or swings of tensions by {}: take --accuracy \"1 %\", or half the --step", percent(*error))
    when ("half the step moves mean or root mean square of a span by more than {}, less what twins differ by", percent(WIDE)) by ASSUMED;

    /// The record is too short for intervals.
    StatisticsUnknown, "statistics-unknown", Caution {
        /// End of a record that would have them \[s\]; infinite where nothing repeats.
        until: f64,
    }
    says ("{}", without_intervals(*until))
    when ("the record has fewer than three periods of the slowest forcing, or none is known")
    by "two periods do not tell how much they differ";

    /// The accuracy asked for is not kept.
    AccuracyMissed, "accuracy-missed", Caution {
        /// Asked for \[–\].
        accuracy: f64,
        /// Found \[–\]; infinite if nothing could be compared.
        error: f64,
        /// Whether a step was found that seemed to keep it.
        was_chosen: bool,
    }
    says ("{}", missed(*accuracy, *error, *was_chosen))
    when ("the choice, or the run's own estimate, finds a larger error than was asked for") by COUNTED;

    /// A contact is deeper than its law reaches.
    DeepContact, "deep-contact", Caution {
        /// The two that touch.
        place: String,
        /// Deepest indentation \[m\].
        depth: f64,
        /// Depth to which the law reaches \[m\].
        reach: f64,
    }
    says ("{place}: indented by {:.1} µm, and the law reaches to {:.1} µm, beyond which its forces are no prediction: take another law, --set \"contact.….law=…\"",
        depth * 1e6, reach * 1e6)
    when ("a contact is deeper than its law reaches") by "the source of the law";

    /// An impact is faster than a restitution stands for.
    FastImpact, "fast-impact", Caution {
        /// The two that strike.
        place: String,
        /// Closing speed \[m/s\].
        speed: f64,
        /// Greatest for which the restitution is meant \[m/s\].
        limit: f64,
    }
    says ("{place}: struck at {speed:.1} m/s, and one restitution stands for impacts up to {limit} m/s: give that of such impacts, --set \"contact.….restitution=…\"")
    when ("an impact closes faster than {FASTEST_IMPACT} m/s") by "that of the restitution";

    /// Loads put energy in.
    LoadDrives, "load-drives", Caution {
        /// How much \[J\].
        work: f64,
    }
    says ("loads put {} in, and a load should take energy out: turn its sign, or name a motor under `drive`", Measure::Energy.told(*work))
    when ("loads put in more than {} of the energy that they exchange, and more than {} of what is moved",
        percent(DRIVES), percent(MATTERS)) by ASSUMED;

    /// The samples that are kept are too rare for the mesh frequency.
    SamplesRare, "samples-rare", Caution {
        /// Samples a tooth passing \[–\].
        samples: f64,
        /// Time between them \[s\].
        every: f64,
        /// Time between them at most, for the mesh to be seen \[s\].
        needed: f64,
    }
    says ("{samples:.1} samples a tooth passing, one in {}: spectra show the mesh at another frequency: take --every \"{}\"",
        duration(*every), duration(*needed))
    when ("fewer than {LEAST_SAMPLES} samples that are kept while a tooth passes") by "Nyquist 1928";

    /// There is no estimate of the error.
    NotEstimated, "not-estimated", Caution {
        /// The reason.
        why: String,
    }
    says ("the error is not estimated, {why}: run it without --no-error, to its end")
    when ("nobody estimated the error") by COUNTED;

    /// Links are pressed.
    LinksPressed, "links-pressed", Caution {
        /// Name of the chain; empty where there is one only.
        chain: String,
        /// Greatest compression of a link \[N\].
        force: f64,
        /// Share of links and samples in which it counts \[–\].
        share: f64,
    }
    says ("links{} are pressed, in {} of links and time by more than {} of the tight span, at most with {force:.0} N, where real links may fold{}",
        of(chain), percent(*share), percent(PRESSED), if *share > LONG_PRESSED { ": raise --set \"route.pretension=…\"" } else { "" })
    when ("links are pressed by more than {} of the greatest span tension, in more than {} of links and samples; a note where it is less",
        percent(PRESSED), percent(LONG_PRESSED)) by "assumed: links that stay pressed would fold";

    /// The span tensions could not be compared with those of a sharper run.
    SpansNotExamined, "spans-not-examined", Trusted {
        /// The span without a tension, and when.
        gap: Gap,
    }
    says ("span tensions are not examined, link tensions are instead: {gap}")
    when ("no roller held a span in a short run, and links were compared") by COUNTED;

    /// Waveforms differ from the exact motion before the run ends.
    HorizonWithinRun, "horizon-within-run", Trusted {
        /// When those of the span tensions do.
        spans: Option<ChannelHorizon>,
        /// When those of the link tensions do.
        links: Option<ChannelHorizon>,
    }
    says ("waveforms are right {}: use statistics beyond", reach(spans.as_ref(), links.as_ref()))
    when ("waveforms differ from the exact ones by 1 % before the run ends, as those of all chaotic motions do") by ASSUMED;

    /// The error of the end of the run is not known.
    NotExamined, "not-examined", Trusted {
        /// Time over which the run was examined \[s\].
        window: f64,
        /// Its end \[s\].
        until: f64,
    }
    says ("the error was estimated on the first {} of {}, and stands for the rest", duration(*window), duration(*until))
    when ("the error was estimated on the beginning of the record") by COUNTED;
}

impl Reason {
    /// How far a result can be trusted that this speaks against: trusted where it is a note.
    pub fn trust(&self) -> Trust {
        match self {
            Self::LinksPressed { share, .. } if *share <= LONG_PRESSED => Trust::Trusted,
            _ => self.ruled(),
        }
    }
}

/// In words, the chain of a name, where there are several.
fn of(chain: &str) -> String {
    match chain {
        "" => String::new(),
        name => format!(" of {name}"),
    }
}

fn unheld(span: &str, share: f64) -> String {
    format!(
        "span {span} has no tension in {} of the time, because no roller holds it: raise --set \"route.pretension=…\", or lower the speed",
        percent(share)
    )
}

fn without_intervals(until: f64) -> String {
    if !until.is_finite() {
        return "the motion has no period that is known, so means and percentiles are those of this record and have no intervals: take --run-in auto where it comes to run steadily".to_owned();
    }
    format!(
        "the record has fewer than three periods of the slowest forcing, so statistics have no intervals: take --until \"{}\"",
        duration(until)
    )
}

fn missed(accuracy: f64, error: f64, was_chosen: bool) -> String {
    // As many digits as tell the two apart.
    let told = |share: f64| {
        if share.is_finite() {
            format!("{} %", with_digits(100.0 * share, 3))
        } else {
            percent(share)
        }
    };
    let remedy = if was_chosen {
        let needed = 0.9 * accuracy * accuracy / error;
        format!(": take --accuracy \"{}\"", told(needed))
    } else {
        ", the best of all steps tried: give a shorter --step".to_owned()
    };
    let (error, accuracy) = (told(error), told(accuracy));
    format!("the error found is {error}, and {accuracy} was asked for{remedy}")
}

fn reach(spans: Option<&ChannelHorizon>, links: Option<&ChannelHorizon>) -> String {
    let of = |horizon: Option<&ChannelHorizon>, name| {
        let at = horizon?.at;
        Some(if at > 0.0 {
            format!("to {} for {name}", duration(at))
        } else {
            format!("at no time for {name}")
        })
    };
    let ends = [of(spans, "span tensions"), of(links, "link tensions")];
    ends.into_iter().flatten().collect::<Vec<_>>().join(", ")
}
