//! The page of a run: what a chain engineer asks of it, in the order of a design review and the units of the trade.
//!
//! ```text
//! verdict · what the drive does · tensions · bearings and guides · impacts · tensioners · irregularity · losses · utilisation · inputs · what next
//! ```
//!
//! A [`Page`] is sections of sentences and tables, as text, or as JSON for whoever sets them otherwise. Steps, contacts and errors are
//! [numerics], on a page of their own.

mod error_by_step;
mod front;
mod losses;
mod next_steps;
mod numerics;
mod sections;

use std::fmt::{self, Write as _};

use serde::Serialize;

pub use numerics::numerics;

use crate::precision::Judgement;
use crate::sheet::aligned;
use crate::summary::Summary;
use crate::{RunInReport, Simulation, Verdict};

/// The page of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Page {
    /// Its sections, in order.
    pub sections: Vec<Section>,
    /// Numbers that are signed, for the first page of a report: not part of the text.
    pub front: Section,
}

/// A part of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Headings of the columns of its table, units in brackets; the first is that of the names. Empty without a table.
    pub columns: Vec<String>,
    /// Rows of its table.
    pub rows: Vec<Vec<String>>,
    /// Sentences, after the table.
    pub sentences: Vec<String>,
}

impl Section {
    /// A part without content; the columns have tabs between them.
    fn new(title: &str, columns: &str) -> Self {
        let columns = columns.split('\t').filter(|it| !it.is_empty());
        Self {
            title: title.to_owned(),
            columns: columns.map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.sentences.is_empty()
    }
}

impl Page {
    /// The page of a run: its verdict, its samples, how it was run in, the estimate of its error, and the inputs that were assumed.
    pub fn of(
        verdict: &Verdict,
        summary: &Summary,
        simulation: &Simulation,
        ran_in: Option<&RunInReport>,
        judgement: Option<&Judgement>,
        assumed: &[String],
    ) -> Self {
        let run = sections::PageContent {
            verdict,
            summary,
            bodies: summary.bodies(),
            simulation,
            ran_in,
            judgement,
            assumed,
        };
        let mut sections = run.sections();
        sections.retain(|section| !section.is_empty());
        let front = run.front();
        Self { sections, front }
    }
}

impl fmt::Display for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, section) in self.sections.iter().enumerate() {
            if index > 0 {
                write!(f, "\n\n")?;
            }
            section.fmt(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = self.title.clone();
        if !self.rows.is_empty() {
            for line in [&self.columns].into_iter().chain(&self.rows) {
                write!(text, "\n  {}", line.join("\t"))?;
            }
        }
        for sentence in &self.sentences {
            write!(text, "\n  {sentence}")?;
        }
        f.write_str(&aligned(&text, 0))
    }
}
