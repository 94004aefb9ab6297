//! A sweep in figures that do not grow with it: counts, extremes, and the first of what went wrong.

use std::fmt::Write;

use super::columns::{COLUMNS, short};
use super::{Account, Outcome, Sweep, VariantCounts};
use crate::story::Ending;

/// Failures that are told.
const FAILURES: usize = 20;

/// A variant with a figure of it.
type Figure = Option<(usize, f64)>;

/// Counts and extremes of the outcomes that were pushed, one by one and in any order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Variants that reached their end.
    pub finished: usize,
    /// Variants that failed.
    pub failed: usize,
    /// Variants that were not carried out.
    pub open: usize,
    /// Variants that contradict themselves, among those that reached their end.
    pub distrusted: usize,
    /// Variants without the accuracy that was asked for, among those that reached their end.
    pub missed: usize,
    /// The first distrusted variant with its note.
    first_distrusted: Option<(usize, String)>,
    /// The first failures with their messages.
    failures: Vec<(usize, String)>,
    /// Variants with the least and the greatest value of each figure.
    extremes: [[Figure; 2]; COLUMNS.len()],
}

impl Tally {
    /// The tally of all variants, in their order.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let mut tally = Self::default();
        for (index, outcome) in outcomes.iter().enumerate() {
            tally.push(index, outcome);
        }
        tally
    }

    /// The counts of variants that have ended.
    pub fn counts(&self) -> VariantCounts {
        VariantCounts {
            done: self.finished,
            failed: self.failed,
            distrusted: self.distrusted,
        }
    }

    /// Ending of a sweep that has stopped; variants that failed count as a failure of the sweep.
    pub fn ending(&self) -> Ending {
        let all = self.finished + self.failed + self.open;
        match self.failed {
            _ if self.open > 0 => Ending::Interrupted,
            0 => Ending::Complete,
            failed => Ending::Failed(format!("{failed} of {all} variants failed")),
        }
    }

    /// Takes the outcome of a variant.
    pub fn push(&mut self, index: usize, outcome: &Outcome) {
        match outcome {
            Outcome::Open => self.open += 1,
            Outcome::Failed(message) => {
                self.failed += 1;
                self.failures.push((index, message.clone()));
                self.failures.sort_unstable_by_key(|(index, _)| *index);
                self.failures.truncate(FAILURES);
            }
            Outcome::Done(account) => self.push_account(index, account),
        }
    }

    fn push_account(&mut self, index: usize, account: &Account) {
        self.finished += 1;
        self.missed += usize::from(account.misses());
        if account.verdict.is_distrusted() {
            self.distrusted += 1;
            let first = self.first_distrusted.as_ref();
            if first.is_none_or(|(first, _)| index < *first) {
                self.first_distrusted = Some((index, account.verdict.note.clone()));
            }
        }
        for (column, [least, greatest]) in COLUMNS.iter().zip(&mut self.extremes) {
            let figure = (column.read)(account);
            if figure.is_nan() {
                continue;
            }
            // Of equal figures that of the first variant, whatever the order in which they come.
            let before = |(at, _): (usize, f64)| index < at;
            if least.is_none_or(|it| figure < it.1 || (figure <= it.1 && before(it))) {
                *least = Some((index, figure));
            }
            if greatest.is_none_or(|it| figure > it.1 || (figure >= it.1 && before(it))) {
                *greatest = Some((index, figure));
            }
        }
    }

    /// The extremes of many variants, and the counts.
    pub fn summary(&self, sweep: &Sweep) -> String {
        let mut text = String::new();
        if !sweep.has_a_line_each() {
            for (column, ends) in COLUMNS.iter().zip(&self.extremes) {
                for (word, end) in ["least", "greatest"].into_iter().zip(ends) {
                    if let Some((index, figure)) = *end {
                        let (heading, figure) = (column.heading, short(figure));
                        let at = sweep.label(index);
                        let line = format!("{heading:15}  {word:8} {figure:>12}  at {at}\n");
                        text.push_str(&line);
                    }
                }
            }
        }
        let all = self.finished + self.failed + self.open;
        let counts = [
            (self.failed, "failed"),
            (self.missed, "without the accuracy asked for"),
            (self.distrusted, "distrusted"),
            (self.open, "not carried out"),
        ];
        let _ = write!(text, "variants: {} of {all} done", self.finished);
        for (count, word) in counts.into_iter().filter(|(count, _)| *count > 0) {
            let _ = write!(text, ", {count} {word}");
        }
        text
    }

    /// One line for whoever asked to hear of errors only; none unless a variant is distrusted.
    pub fn warning(&self, sweep: &Sweep) -> Option<String> {
        let (first, note) = self.first_distrusted.as_ref()?;
        Some(format!(
            "do not trust {} of {} variants, see `verdict_note`; the first is {}: {note}",
            self.distrusted,
            sweep.len(),
            sweep.label(*first),
        ))
    }

    /// A line a variant that failed, with the reason; all but the first ones are only counted.
    pub fn failures(&self, sweep: &Sweep) -> Vec<String> {
        let failures = self.failures.iter();
        let line =
            |(index, message): &(usize, String)| format!("{}: {message}", sweep.label(*index));
        let mut lines: Vec<String> = failures.map(line).collect();
        let more = self.failed - self.failures.len();
        if more > 0 {
            lines.push(format!("and {more} more"));
        }
        lines
    }
}
