//! The short account that ends a sweep.

use std::fmt;

use super::columns::{COLUMNS, short};
use super::{Dimension, Outcome, Sweep, Tally};
use crate::sheet::aligned;

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
    /// Whether its report has one line per variant.
    pub(crate) fn has_a_line_each(&self) -> bool {
        self.len() <= LINES
    }
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.sweep.has_a_line_each() {
            f.write_str(&self.variants())?;
        }
        write!(f, "{}", Tally::of(self.outcomes).summary(self.sweep))
    }
}

impl Report<'_> {
    /// A line a variant, all figures right.
    fn variants(&self) -> String {
        let dimensions = self.sweep.dimensions();
        let headings = COLUMNS.iter().map(|it| it.heading.to_owned());
        let headings: Vec<String> = dimensions.iter().map(title).chain(headings).collect();
        let mut lines = vec![headings.join("\t")];
        for (index, outcome) in self.outcomes.iter().enumerate() {
            let places = dimensions.iter().zip(self.sweep.indices(index));
            let mut cells: Vec<String> = places.map(|(it, at)| it.values.short(at)).collect();
            match outcome {
                Outcome::Done(account) => {
                    cells.extend(COLUMNS.iter().map(|it| short((it.read)(account))));
                    cells.extend(
                        account
                            .verdict
                            .is_distrusted()
                            .then(|| "distrusted".to_owned()),
                    );
                }
                Outcome::Failed(_) => cells.push("failed".to_owned()),
                Outcome::Open => cells.push("not carried out".to_owned()),
            }
            lines.push(cells.join("\t"));
        }
        // The first column is of figures too, so that of the names before it is empty.
        aligned(&format!("\t{}\n", lines.join("\n\t")), 0)
    }
}

fn title(dimension: &Dimension) -> String {
    match dimension.unit {
        Some(unit) if unit != "1" => format!("{} [{unit}]", dimension.name),
        _ => dimension.name.clone(),
    }
}
