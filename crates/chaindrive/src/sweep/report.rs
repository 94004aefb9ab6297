//! The short account that ends a sweep.

use std::fmt::{self, Write};

use super::columns::{COLUMNS, short};
use super::{Dimension, Outcome, Sweep, Tally};

/// Variants of which each has its line; of more, only the extremes are told.
const LINES: usize = 40;

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
        Tally::of(outcomes).warning(self)
    }

    /// A line a variant that failed, with the reason; all but the first ones are only counted.
    pub fn failures(&self, outcomes: &[Outcome]) -> Vec<String> {
        Tally::of(outcomes).failures(self)
    }
}

impl Sweep {
    /// Whether the account of it has a line a variant.
    pub(crate) fn has_a_line_each(&self) -> bool {
        self.len() <= LINES
    }
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.sweep.has_a_line_each() {
            self.variants(f)?;
        }
        write!(f, "{}", Tally::of(self.outcomes).summary(self.sweep))
    }
}

impl Report<'_> {
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
