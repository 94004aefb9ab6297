//! What to do after a run, as both verdicts ask for it.

use super::Section;
use super::sections::PageContent;
use crate::chain_verdict::{CheckOutcome, Limit};
use crate::verdict::Trust;

impl PageContent<'_> {
    /// One sentence for each thing to do, that on the chain first.
    pub(super) fn next_steps(&self) -> Section {
        let mut section = Section::new("what next", "");
        let checks = &self.verdict.chains.checks;
        let mut sentences: Vec<String> = Vec::new();
        for check in checks {
            let step = match check.outcome {
                CheckOutcome::Fail | CheckOutcome::Warning => against(check.limit).to_owned(),
                CheckOutcome::NotJudged => wanted(check.limit),
                CheckOutcome::Pass => String::new(),
            };
            // The rating of another chain is no more than a hint.
            let rating = (check.limit == Limit::TwinPower).then(|| wanted(Limit::RatedPower));
            for step in [Some(step), rating].into_iter().flatten() {
                // Limits that ask for the same are one sentence.
                if !step.is_empty() && !sentences.contains(&step) {
                    sentences.push(step);
                }
            }
        }
        if self.verdict.trust != Trust::Trusted {
            sentences.push("Simulate again as the verdict on the numbers says.".to_owned());
        }
        if sentences.is_empty() && !checks.is_empty() {
            sentences.push("Nothing speaks against the chain or the numbers.".to_owned());
        }
        section.sentences = sentences;
        section
    }
}

/// Remedy where a limit is not kept.
fn against(limit: Limit) -> &'static str {
    match limit {
        Limit::StaticSafety
        | Limit::DynamicSafety
        | Limit::BearingPressure
        | Limit::RatedPower
        | Limit::TwinPower => {
            "Take a stronger chain, more strands, larger sprockets at the same speeds, or less load."
        }
        Limit::Speed => "Take a chain of a smaller pitch, or turn slower.",
        Limit::OutOfLine => "Align the sprockets.",
        Limit::Wear => "Replace the chain.",
        Limit::Wrap => "Let an idler or a longer centre distance wrap the small sprocket further.",
        Limit::Teeth => "Take more teeth on the small sprocket, of a smaller pitch if need be.",
        Limit::Ratio => "Divide the ratio over two stages.",
        Limit::Centres => "Choose the centre distance anew, or support the long span.",
    }
}

/// Input without which a limit is not judged; empty where nobody could give one.
fn wanted(limit: Limit) -> String {
    let input = match limit {
        Limit::StaticSafety | Limit::DynamicSafety => "chain.breaking_load, of its standard,",
        Limit::BearingPressure => "chain.type, or chain.joint.length of clearance joints,",
        Limit::RatedPower => "chain.rated_power, as its maker says,",
        _ => return String::new(),
    };
    format!("Give {input} to have the {} judged.", subject(limit))
}

fn subject(limit: Limit) -> &'static str {
    match limit {
        Limit::StaticSafety | Limit::DynamicSafety => "safety factors",
        Limit::BearingPressure => "bearing pressure",
        _ => "power",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every key that is asked for is one of scenes.
    #[test]
    fn what_is_wanted_can_be_given() {
        let schema = include_str!("../../chaindrive.schema.json");
        for limit in [
            Limit::StaticSafety,
            Limit::BearingPressure,
            Limit::RatedPower,
        ] {
            let told = wanted(limit);
            let keys: Vec<&str> = told
                .split([' ', ','])
                .filter_map(|it| it.strip_prefix("chain."))
                .collect();
            assert!(!keys.is_empty(), "{told}");
            for key in keys.iter().flat_map(|it| it.split('.')) {
                assert!(schema.contains(&format!("\"{key}\": {{")), "{told}");
            }
        }
    }
}
