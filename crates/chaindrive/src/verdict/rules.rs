//! The rules of the verdict: when each reason speaks, and on whose authority.

use super::{
    LEAST_SHIFT, LEAST_STEPS, LONG_PRESSED, MOST_EFFICIENCY, OPEN_LEDGER, OPEN_MOTION, PRESSED,
    UNCERTAIN_LOSSES, UNHELD, Verdict, WIDE, WRONG_LOSSES, duty,
};
use crate::figure::percent;
use crate::precision::LEAST_LOSSES;
use crate::summary::DRIFT;
use crate::{MOST_CIRCUITS, Trust};

/// When a reason speaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// Its [name](super::Reason::name) in results.
    pub name: &'static str,
    /// What it makes of a result.
    pub trust: Trust,
    /// When it speaks.
    pub when: String,
    /// Where the threshold comes from.
    pub source: &'static str,
}

const ASSUMED: &str = "assumed";
const COUNTED: &str = "nothing to choose";

impl Verdict {
    /// When each [`Reason`](super::Reason) speaks, the worst first.
    #[expect(clippy::too_many_lines, reason = "a list: every reason with its rule")]
    pub fn rules() -> Vec<Rule> {
        let row = |name, trust, when: String, source| Rule {
            name,
            trust,
            when,
            source,
        };
        let distrusted = |name, when, source| row(name, Trust::Distrusted, when, source);
        let caution = |name, when, source| row(name, Trust::Caution, when, source);
        let note = |name, when, source| row(name, Trust::Trusted, when, source);
        let p = percent;
        vec![
        distrusted("not-finite", "a tension or a contact force of a sample is not a number".into(), COUNTED),
        distrusted(
            "energy-missing",
            format!(
                "energy unaccounted for: more than {} of what was moved, of a free motion {} of the kinetic energy",
                p(OPEN_LEDGER),
                p(OPEN_MOTION)
            ),
            "assumed: ten times what a coarse step leaves",
        ),
        distrusted(
            "losses-wrong",
            format!(
                "energy unaccounted for: more than {} of the losses, or of {LEAST_LOSSES} of the energy moved where that is more",
                p(WRONG_LOSSES)
            ),
            ASSUMED,
        ),
        distrusted(
            "efficiency-above-one",
            format!("what comes out and is stored, over what goes in, exceeds {MOST_EFFICIENCY}"),
            "the floor of losses-wrong",
        ),
        distrusted(
            "span-rarely-held",
            format!("no roller holds a span in more than {} of the samples", p(UNHELD)),
            "most of its record is missing",
        ),
        distrusted(
            "above-breaking-load",
            "a link bears more than the least breaking load of its chain".into(),
            "ISO 606, ASME B29.1",
        ),
        distrusted(
            "motions-fight",
            "motions that are given move a chain more than a tooth apart".into(),
            "springs and slack take up less",
        ),
        caution(
            "losses-uncertain",
            format!("as losses-wrong, more than {}", p(UNCERTAIN_LOSSES)),
            "assumed: 0.2 points of an efficiency of 98 %",
        ),
        caution("too-short", format!("fewer than {LEAST_STEPS} steps"), ASSUMED),
        caution("span-not-held", "no roller holds a span in some samples".into(), COUNTED),
        caution(
            "not-steady",
            format!("mean or standard deviation of a span drifts by more than chance and {} of its scale, for all of the record", p(DRIFT)),
            ASSUMED,
        ),
        caution(
            "start-counts",
            format!("the mean of a span is off the steady one by more than {} of its scale", p(LEAST_SHIFT)),
            "assumed: below what anybody reads off a tension",
        ),
        caution(
            "not-run-in",
            format!("no run-in of up to {MOST_CIRCUITS} circuits ends in a steady motion"),
            ASSUMED,
        ),
        caution(
            "means-uncertain",
            format!("half of the 95 % interval of a mean is more than {} of its scale", p(WIDE)),
            ASSUMED,
        ),
        caution(
            "means-inexact",
            format!(
                "half the step moves mean or root mean square of a span by more than {}, less what twins differ by",
                p(WIDE)
            ),
            ASSUMED,
        ),
        caution(
            "statistics-unknown",
            "the record has fewer than three periods of the slowest forcing, or none is known".into(),
            "two periods do not tell how much they differ",
        ),
        caution(
            "accuracy-missed",
            "the choice, or the run's own estimate, finds a larger error than was asked for".into(),
            COUNTED,
        ),
        caution(
            "above-rating",
            "mean power times service factor above the rating of the chain at its smallest sprocket".into(),
            "ASME B29.1, 15 000 hours; or what the scene says of the maker",
        ),
        caution("deep-contact", "a contact is deeper than its law reaches".into(), "the source of the law"),
        caution(
            "fast-impact",
            format!("an impact closes faster than {} m/s", chaindrive_contact::dissipation::FASTEST_IMPACT),
            "that of the restitution",
        ),
        caution(
            "out-of-line",
            format!(
                "the planes of two sprockets are apart by more than {} of the distance of their shafts; in fast drives {} are allowed",
                p(duty::ALIGNED),
                p(duty::ALIGNED_FAST)
            ),
            "SEDIS, Transmission chains",
        ),
        caution(
            "load-drives",
            format!(
                "loads put in more than {} of the energy that they exchange, and more than {} of what is moved",
                p(duty::DRIVES),
                p(duty::MATTERS)
            ),
            ASSUMED,
        ),
        caution(
            "samples-rare",
            format!("fewer than {} samples that are kept while a tooth passes", duty::LEAST_SAMPLES),
            "Nyquist 1928",
        ),
        caution("not-estimated", "nobody estimated the error".into(), COUNTED),
        caution(
            "links-pressed",
            format!(
                "links are pressed by more than {} of the greatest span tension, in more than {} of links and samples; a note where it is less",
                p(PRESSED),
                p(LONG_PRESSED)
            ),
            "assumed: links that stay pressed would fold",
        ),
        note(
            "spans-not-examined",
            "no roller held a span in a short run, and links were compared".into(),
            COUNTED,
        ),
        note(
            "horizon-within-run",
            "waveforms differ from the exact ones by 1 % before the run ends, as those of all chaotic motions do".into(),
            ASSUMED,
        ),
        note(
            "not-rated",
            "a chain of the catalogue carries power, and no formula with a source rates its type".into(),
            COUNTED,
        ),
        note(
            "not-examined",
            "the error was estimated on the beginning of the record".into(),
            COUNTED,
        ),
    ]
    }
}
