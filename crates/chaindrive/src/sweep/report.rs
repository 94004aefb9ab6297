//! The short account that ends a sweep.

use std::fmt::{self, Write};

use super::{Account, Dimension, Outcome, Quantity, Statistic, Sweep};

/// Variants of which each has its line; of more, only the extremes are told.
const LINES: usize = 40;

/// Failures that are told.
const FAILURES: usize = 20;

/// A figure of a variant.
struct Column {
    heading: &'static str,
    read: fn(&Account) -> f64,
}

/// The columns of the table.
const COLUMNS: [Column; 6] = [
    Column {
        heading: "span max [N]",
        read: |account| account.largest(Statistic::SpanTensionMax),
    },
    Column {
        heading: "span std [N]",
        read: |account| account.largest(Statistic::SpanTensionStd),
    },
    Column {
        heading: "contact max [N]",
        read: |account| account.largest(Statistic::ContactForceMax),
    },
    Column {
        heading: "dissipated [J]",
        read: |account| account.largest(Statistic::EnergyDissipated),
    },
    Column {
        heading: "unaccounted [J]",
        read: |account| account.largest(Statistic::EnergyResidualMax).abs(),
    },
    Column {
        heading: "× real time",
        read: |account| account.largest(Statistic::RealTimeFactor),
    },
];

impl Account {
    /// Whether no method on the list kept the accuracy that was asked for.
    fn misses(&self) -> bool {
        self.largest(Statistic::AccuracyKept) < 1.0
    }

    /// The largest entry of a statistic; NaN when there is none.
    fn largest(&self, statistic: Statistic) -> f64 {
        let quantity = Quantity::Statistic(statistic);
        let found = self.entries.iter().find(|it| it.quantity == quantity);
        let values = found.map_or(&[] as &[f64], |entry| &entry.values);
        values.iter().copied().fold(f64::NAN, f64::max)
    }
}

/// The outcomes of a sweep as a table.
#[derive(Debug)]
pub struct Report<'a> {
    sweep: &'a Sweep,
    outcomes: &'a [Outcome],
}

impl Sweep {
    /// The largest span tension, contact force and energy of every variant; of many variants, where they are
    /// least and greatest. The span tension is that of the span where it is largest.
    pub fn report<'a>(&'a self, outcomes: &'a [Outcome]) -> Report<'a> {
        Report {
            sweep: self,
            outcomes,
        }
    }

    /// One line for whoever asked to hear of errors only; none unless a variant is distrusted.
    pub fn warning(&self, outcomes: &[Outcome]) -> Option<String> {
        let report = self.report(outcomes);
        let (first, account) = report.distrusted().next()?;
        Some(format!(
            "do not trust {} of {} variants, see `verdict_note`; the first is {}: {}",
            report.distrusted().count(),
            outcomes.len(),
            self.label(first),
            account.verdict.note
        ))
    }

    /// A line a variant that failed, with the reason; all but the first ones are only counted.
    pub fn failures(&self, outcomes: &[Outcome]) -> Vec<String> {
        let mut lines = Vec::new();
        let mut more = 0;
        for (index, outcome) in outcomes.iter().enumerate() {
            match outcome {
                Outcome::Failed(_) if lines.len() == FAILURES => more += 1,
                Outcome::Failed(message) => {
                    lines.push(format!("{}: {message}", self.label(index)));
                }
                Outcome::Open | Outcome::Done(_) => {}
            }
        }
        if more > 0 {
            lines.push(format!("and {more} more"));
        }
        lines
    }
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let finished = self.done().count();
        if self.outcomes.len() <= LINES {
            self.variants(f)?;
        } else if finished > 0 {
            self.extremes(f)?;
        }
        let failed = self.outcomes.iter();
        let failed = failed.filter(|outcome| matches!(outcome, Outcome::Failed(_)));
        let (failed, all) = (failed.count(), self.outcomes.len());
        write!(f, "variants: {finished} of {all} done")?;
        if failed > 0 {
            write!(f, ", {failed} failed")?;
        }
        let missed = self.done().filter(|(_, account)| account.misses()).count();
        if missed > 0 {
            write!(f, ", {missed} without the accuracy asked for")?;
        }
        let distrusted = self.distrusted().count();
        if distrusted > 0 {
            write!(f, ", {distrusted} distrusted")?;
        }
        if finished + failed < all {
            write!(f, ", {} not carried out", all - finished - failed)?;
        }
        Ok(())
    }
}

impl Report<'_> {
    fn done(&self) -> impl Iterator<Item = (usize, &Account)> {
        let outcomes = self.outcomes.iter().enumerate();
        outcomes.filter_map(|(index, outcome)| match outcome {
            Outcome::Done(account) => Some((index, account)),
            Outcome::Open | Outcome::Failed(_) => None,
        })
    }

    fn distrusted(&self) -> impl Iterator<Item = (usize, &Account)> {
        self.done()
            .filter(|(_, account)| account.verdict.is_distrusted())
    }

    /// A line a variant.
    fn variants(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimensions = self.sweep.dimensions();
        let widths: Vec<usize> = dimensions.iter().map(width).collect();
        let mut heading = String::new();
        for (dimension, &width) in dimensions.iter().zip(&widths) {
            write!(heading, "{:>width$}  ", title(dimension))?;
        }
        for column in &COLUMNS {
            write!(heading, "{:>15}  ", column.heading)?;
        }
        writeln!(f, "{}", heading.trim_end())?;
        for (index, outcome) in self.outcomes.iter().enumerate() {
            let mut line = String::new();
            let places = self.sweep.indices(index);
            for ((dimension, at), &width) in dimensions.iter().zip(places).zip(&widths) {
                write!(line, "{:>width$}  ", dimension.values.short(at))?;
            }
            match outcome {
                Outcome::Done(account) => {
                    for column in &COLUMNS {
                        write!(line, "{:>15}  ", short((column.read)(account)))?;
                    }
                    if account.verdict.is_distrusted() {
                        line.push_str("distrusted");
                    }
                }
                Outcome::Failed(_) => line.push_str("failed"),
                Outcome::Open => line.push_str("not carried out"),
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }

    /// Where each figure is least and greatest.
    fn extremes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for column in &COLUMNS {
            let figures = self.done().map(|(index, it)| (index, (column.read)(it)));
            let figures = figures.filter(|(_, figure)| !figure.is_nan());
            let figures: Vec<(usize, f64)> = figures.collect();
            let by_figure = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
            let ends = [
                ("least", figures.iter().min_by(by_figure)),
                ("greatest", figures.iter().max_by(by_figure)),
            ];
            for (word, end) in ends {
                if let Some(&(index, figure)) = end {
                    let at = self.sweep.label(index);
                    let heading = column.heading;
                    writeln!(f, "{heading:15}  {word:8} {:>12}  at {at}", short(figure))?;
                }
            }
        }
        Ok(())
    }
}

fn title(dimension: &Dimension) -> String {
    match dimension.unit {
        Some(unit) if unit != "1" => format!("{} [{unit}]", dimension.name),
        _ => dimension.name.clone(),
    }
}

fn width(dimension: &Dimension) -> usize {
    let values = (0..dimension.values.len()).map(|at| dimension.values.short(at));
    let widths = values.map(|text| text.chars().count());
    widths
        .max()
        .unwrap_or(0)
        .max(title(dimension).chars().count())
}

/// Five digits.
pub(super) fn short(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    let magnitude = number.abs().log10().floor();
    if !(-3.0..9.0).contains(&magnitude) {
        return format!("{number:.3e}");
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 7, whatever the number"
    )]
    let decimals = (4.0 - magnitude).max(0.0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_five_digits() {
        let pairs = [
            (0.0, "0"),
            (-8.377_580_409, "-8.3776"),
            (15e3, "15000"),
            (123_456.7, "123457"),
            (0.5, "0.5"),
            (0.001_234_567, "0.0012346"),
            (1e-9, "1.000e-9"),
            (f64::NAN, "NaN"),
        ];
        for (number, text) in pairs {
            assert_eq!(short(number), text);
        }
    }
}
