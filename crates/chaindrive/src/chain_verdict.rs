//! The verdict on the chains of a drive, beside the one on the numbers: strength under their loads, and layout.
//!
//! | outcome | means |
//! |---|---|
//! | pass | the value keeps its limit |
//! | not judged | the value or the limit is not known; never taken for a pass |
//! | warning | it is against good practice, or against a limit that belongs to another chain |
//! | fail | the chain is too weak, or its maker forbids it |
//!
//! [`Limit`] is the list of what is looked at. *Fail* is for strength alone; layouts are warned of at most, and those of guided, derailleur and
//! conveyor drives are left in peace.

mod layout;
mod strength;

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::Simulation;
use crate::figure::figure;
use crate::story::Story;
use crate::summary::Summary;

pub use layout::{against_practice, layout_checks, remarks};
pub(crate) use strength::{ALIGNED, ALIGNED_FAST};

/// Outcome of a check, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckOutcome {
    /// The limit is kept.
    Pass,
    /// Value or limit are not known.
    NotJudged,
    /// Against good practice.
    Warning,
    /// Too weak.
    Fail,
}

impl CheckOutcome {
    /// Word in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::NotJudged => "not judged",
            Self::Warning => "warning",
            Self::Fail => "fail",
        }
    }
}

/// Safe side of the bounds of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At the bound or above.
    AtLeast,
    /// At the bound or below.
    AtMost,
    /// Between two bounds.
    Between,
}

macro_rules! limits {
    ($($variant:ident, $name:literal, $label:literal, $unit:literal, $side:ident, warn $warn:expr, fail $fail:expr, $source:literal;)*) => {
        /// A limit that chains are held against.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Limit {
            $(#[doc = $label] $variant,)*
        }

        impl Limit {
            /// All limits.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Name in results.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// Words for readers.
            pub fn label(self) -> &'static str {
                match self { $(Self::$variant => $label),* }
            }

            /// Unit of value and bounds, as they are printed.
            pub fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit),* }
            }

            /// Safe side of the bounds.
            pub fn side(self) -> Side {
                match self { $(Self::$variant => Side::$side),* }
            }

            /// Bounds beyond which there is a warning, two for what is to lie between; none where each chain has its own.
            pub fn warning(self) -> &'static [f64] {
                match self { $(Self::$variant => $warn),* }
            }

            /// Bound beyond which the chain fails, if it can.
            pub fn failure(self) -> Option<f64> {
                match self { $(Self::$variant => $fail),* }
            }

            /// Source of the bounds.
            pub fn source(self) -> &'static str {
                match self { $(Self::$variant => $source),* }
            }
        }
    };
}

limits! {
    StaticSafety, "static-safety", "static safety factor: breaking load over the maximum link tension", "", AtLeast, warn &[7.0], fail Some(3.0), "7: iwis, Bruchkraft; 3: the proof load that chains of ISO 606 have borne before they are sold";
    DynamicSafety, "dynamic-safety", "dynamic safety factor: breaking load over the mean pull of the tightest span", "", AtLeast, warn &[7.0], fail Some(5.0), "endurance is 15 to 20 % of the breaking load: iwis, Dauerfestigkeit; Renold takes 8";
    BearingPressure, "bearing-pressure", "bearing pressure of pins on bushes under the mean pull of the tightest span", "N/mm²", AtMost, warn &[30.0], fail Some(60.0), "assumed: what makers publish at moderate speeds, and twice that";
    RatedPower, "rated-power", "power carried times service factor over the rated power", "%", AtMost, warn &[100.0], fail Some(100.0), "the rating of the chain, see docs/rating.md";
    TwinPower, "twin-power", "power carried times service factor over the rated power of the ASME B29.1 chain of its pitch", "%", AtMost, warn &[100.0], fail None, "ASME B29.1 rates another chain: its twin";
    Speed, "speed", "chain speed over the greatest of its type", "%", AtMost, warn &[100.0], fail Some(100.0), "none could be read in a public source";
    OutOfLine, "out-of-line", "distance of the planes of sprockets over their centre distance", "%", AtMost, warn &[100.0 * ALIGNED], fail None, "SEDIS, Transmission chains; in fast drives 0.1 %";
    Wear, "wear-used", "elongation by wear over the limit of its use", "%", AtMost, warn &[80.0], fail Some(100.0), "3 %, 200/z %, 1.5 % on fixed centres: Diamond Chain, How can the wear in a roller chain be measured; 1 % beside guides: manual of a marine engine";
    Wrap, "wrap", "wrap of the smallest sprocket that carries power", "deg", AtLeast, warn &[120.0], fail None, "HKK, Installation; Renold";
    Teeth, "teeth", "teeth of the smallest sprocket that carries power", "", AtLeast, warn &[17.0], fail None, "assumed: Renold asks for 19, Tsubaki for 15";
    Ratio, "ratio", "teeth of the largest over those of the smallest sprocket that carries power", "", AtMost, warn &[7.0], fail None, "American Chain Association: 7 to 1 in a single reduction";
    Centres, "centres", "distance of the two sprockets that carry power", "pitches", Between, warn &[30.0, 50.0], fail None, "HKK, Installation";
}

/// A value held against a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Which limit.
    pub limit: Limit,
    /// Chain or sprocket, if there are several.
    pub of: String,
    /// The value, in the unit of the limit; none where it is not known.
    pub value: Option<f64>,
    /// Its outcome.
    pub outcome: CheckOutcome,
    /// A remark: the reason for no judgement, or the origin of the value; empty without one.
    pub note: String,
}

impl Check {
    /// Holds a value against the bounds of a limit.
    pub(crate) fn of(limit: Limit, of: &str, value: f64) -> Self {
        let beyond = |bound: f64| match limit.side() {
            Side::AtLeast => value < bound,
            Side::AtMost | Side::Between => value > bound,
        };
        let below = limit.side() == Side::Between && value < limit.warning()[0];
        let warned = limit.warning().last().copied().is_some_and(beyond) || below;
        let outcome = if !value.is_finite() {
            CheckOutcome::NotJudged
        } else if limit.failure().is_some_and(beyond) {
            CheckOutcome::Fail
        } else if warned {
            CheckOutcome::Warning
        } else {
            CheckOutcome::Pass
        };
        Self {
            limit,
            of: of.to_owned(),
            value: value.is_finite().then_some(value),
            outcome,
            note: String::new(),
        }
    }

    /// A value that nobody can hold against anything.
    pub(crate) fn not_judged(limit: Limit, of: &str, why: &str) -> Self {
        Self {
            limit,
            of: of.to_owned(),
            value: None,
            outcome: CheckOutcome::NotJudged,
            note: why.to_owned(),
        }
    }

    pub(crate) fn with(mut self, note: &str) -> Self {
        note.clone_into(&mut self.note);
        self
    }

    /// Value with its unit; a dash where it is not known.
    pub fn told_value(&self) -> String {
        self.value.map_or("–".to_owned(), figure)
    }

    /// Bounds in words.
    pub fn told_bounds(&self) -> String {
        let bounds: Vec<String> = self.limit.warning().iter().map(|it| figure(*it)).collect();
        let at = match (self.limit.side(), &bounds[..]) {
            (Side::AtLeast, [bound]) => format!("at least {bound}"),
            (Side::AtMost, [bound]) => format!("at most {bound}"),
            (_, [low, high]) => format!("{low} to {high}"),
            _ => "–".to_owned(),
        };
        match self.limit.failure() {
            Some(bound) if self.limit.warning().last() != Some(&bound) => {
                format!("{at}, fails at {}", figure(bound))
            }
            _ => at,
        }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = if self.of.is_empty() {
            String::new()
        } else {
            format!(" of {}", self.of)
        };
        let unit = self.limit.unit();
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        };
        write!(f, "{}{of}", self.limit.label())?;
        match self.value {
            Some(_) => write!(f, ": {}{unit}, {}", self.told_value(), self.told_bounds())?,
            None => write!(f, ": not judged")?,
        }
        if !self.note.is_empty() {
            write!(f, " ({})", self.note)?;
        }
        Ok(())
    }
}

/// The verdict on the chains of a drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChainVerdict {
    /// All that was looked at, the worst first.
    pub checks: Vec<Check>,
}

impl ChainVerdict {
    /// The verdict on the chains under the loads of a run that has ended; `wraps` of every sprocket \[rad\], where it is known.
    pub fn of(summary: &Summary, simulation: &Simulation, wraps: &[Option<f64>]) -> Self {
        let drive = &simulation.assembled().drive;
        let mut checks = strength::strength_checks(&summary.ratings(), drive);
        checks.extend(layout_checks(drive, wraps));
        Self::of_checks(checks)
    }

    /// The verdict that some checks make.
    pub fn of_checks(mut checks: Vec<Check>) -> Self {
        checks.sort_by_key(|check| std::cmp::Reverse(check.outcome));
        Self { checks }
    }

    /// The worst outcome; *not judged* where nothing of the strength could be.
    pub fn outcome(&self) -> CheckOutcome {
        let worst = self.checks.iter().map(|check| check.outcome);
        let worst = worst.max().unwrap_or(CheckOutcome::NotJudged);
        // A new chain is not worn, whatever pulls at it.
        let of_strength =
            |check: &&Check| check.limit.failure().is_some() && check.limit != Limit::Wear;
        let mut strength = self.checks.iter().filter(of_strength);
        let judged = strength.any(|check| check.outcome != CheckOutcome::NotJudged);
        match worst {
            CheckOutcome::Pass | CheckOutcome::NotJudged if judged => CheckOutcome::Pass,
            CheckOutcome::Pass => CheckOutcome::NotJudged,
            worst => worst,
        }
    }

    /// Checks that speak against the chain, the worst first.
    pub fn reasons(&self) -> impl Iterator<Item = &Check> {
        let speaks = |check: &&Check| check.outcome >= CheckOutcome::Warning;
        self.checks.iter().filter(speaks)
    }

    /// The verdict as results have it.
    pub fn written(&self) -> WrittenChainVerdict {
        let names: Vec<&str> = self.reasons().map(|check| check.limit.name()).collect();
        let words: Vec<String> = self.reasons().map(Check::to_string).collect();
        WrittenChainVerdict {
            verdict: self.outcome().name().to_owned(),
            reasons: names.join(" "),
            note: words.join("; "),
        }
    }

    /// Attributes of a result.
    pub fn attributes(&self) -> Map<String, Value> {
        let written = self.written();
        let mut story = Story::default();
        story.text("chain_verdict", &written.verdict);
        story.text("chain_reasons", &written.reasons);
        story.text("chain_verdict_note", &written.note);
        story.0
    }
}

/// A verdict on the chains in the words of results.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WrittenChainVerdict {
    /// The attribute `chain_verdict`: pass, not judged, warning or fail; empty where there is no result.
    pub verdict: String,
    /// The attribute `chain_reasons`: names of limits that are not kept, with blanks between them.
    pub reasons: String,
    /// The attribute `chain_verdict_note`: the same in words.
    pub note: String,
}

#[cfg(test)]
mod tests;
