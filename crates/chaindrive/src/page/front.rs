//! The six numbers that are signed, for the first page of a report.

use super::Section;
use super::sections::{PageContent, after};
use crate::chain_verdict::{Check, Limit};
use crate::figure::{Measure, duration, figure};
use crate::rating::Rating;
use crate::summary::SprocketStatistics;

impl PageContent<'_> {
    /// Efficiency, maximum link tension, static safety factor, greatest shaft load, bearing pressure, irregularity; what a drive has not is left out.
    pub(super) fn front(&self) -> Section {
        let mut section = Section::new("six numbers", "quantity\tvalue\twhere, when, limit");
        section.rows = [
            self.efficiency_to_sign(),
            self.tension_to_sign(),
            self.checked("static safety factor", Limit::StaticSafety, |it| {
                it.static_safety.map(|it| -it)
            }),
            self.shaft_load_to_sign(),
            self.checked("bearing pressure", Limit::BearingPressure, |it| {
                it.bearing_pressure
            }),
            self.irregularity_to_sign(),
        ]
        .into_iter()
        .flatten()
        .map(Vec::from)
        .collect();
        section
    }

    fn efficiency_to_sign(&self) -> Option<[String; 3]> {
        let balance = self.summary.balance()?;
        let lost = Measure::Power.told(balance.lost() / balance.time);
        if !(balance.time > 0.0 && balance.lost() > 0.0) {
            return None;
        }
        let efficiency = self.summary.ledger().efficiency();
        Some(match efficiency {
            Some([efficiency, uncertain]) => [
                "efficiency".to_owned(),
                format!("{:.1} %", 100.0 * efficiency),
                format!("± {:.1} % numerical; lost {lost}", 100.0 * uncertain),
            ],
            None => ["power lost".to_owned(), lost, String::new()],
        })
    }

    fn tension_to_sign(&self) -> Option<[String; 3]> {
        let loads = self.summary.carried().into_iter();
        let known = loads.filter(|it| it.tension.greatest.is_finite());
        let hardest = known.max_by(|a, b| a.tension.greatest.total_cmp(&b.tension.greatest))?;
        let of = after("chain ", &hardest.chain);
        Some([
            "maximum link tension".to_owned(),
            Measure::Force.told(hardest.tension.greatest),
            with(
                &of,
                &format!("at {}", duration(hardest.tension.greatest_at)),
            ),
        ])
    }

    /// The worst of a value of the chains, the greatest of what `of` reads, with its limit.
    fn checked(
        &self,
        name: &str,
        limit: Limit,
        of: impl Fn(&Rating) -> Option<f64>,
    ) -> Option<[String; 3]> {
        let ratings = self.summary.ratings();
        let known = ratings.iter().filter_map(|it| Some((of(it)?, it)));
        let worst = known.max_by(|a, b| a.0.total_cmp(&b.0));
        let chain = worst.map_or("", |(_, it)| it.chain.as_str());
        let checks = &self.verdict.chains.checks;
        let check = checks
            .iter()
            .find(|it| it.limit == limit && it.of == chain)
            .or_else(|| checks.iter().find(|it| it.limit == limit))?;
        let unit = after(" ", limit.unit());
        let value = check.value.map_or_else(
            || check.outcome.name().to_owned(),
            |_| format!("{}{unit}", check.told_value()),
        );
        Some([
            name.to_owned(),
            value,
            with(&after("chain ", chain), &bounds(check)),
        ])
    }

    fn shaft_load_to_sign(&self) -> Option<[String; 3]> {
        let sprockets = self.bodies.sprockets.iter();
        let greatest = |it: &SprocketStatistics| it.force.extremes.greatest;
        let known = sprockets.filter(|it| greatest(it).is_finite() && greatest(it) > 0.0);
        let worst = known.max_by(|a, b| greatest(a).total_cmp(&greatest(b)))?;
        Some([
            "greatest shaft load".to_owned(),
            Measure::Force.told(greatest(worst)),
            format!(
                "at {}, after {}",
                worst.name,
                duration(worst.force.extremes.greatest_at)
            ),
        ])
    }

    fn irregularity_to_sign(&self) -> Option<[String; 3]> {
        let sprockets = self.bodies.sprockets.iter();
        let known = sprockets.filter_map(|it| Some((it.irregularity()?, it)));
        let (irregularity, worst) = known.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some([
            "speed irregularity".to_owned(),
            format!("{} %", figure(100.0 * irregularity)),
            format!("of {}, greatest less least over the mean", worst.name),
        ])
    }
}

/// Bounds of a check; why it could not be judged.
fn bounds(check: &Check) -> String {
    match check.value {
        Some(_) => check.told_bounds(),
        None => check.note.clone(),
    }
}

/// Two remarks with a comma between them; the second one alone where the first is empty.
fn with(first: &str, second: &str) -> String {
    if first.is_empty() {
        second.to_owned()
    } else {
        format!("{first}, {second}")
    }
}
