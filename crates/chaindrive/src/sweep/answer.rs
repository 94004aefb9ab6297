//! Answers of tasks: counts, and the outcomes where no store keeps them.

use serde::{Deserialize, Serialize};

use super::Outcome;
use crate::SealError;
use crate::seal::{SealedValue, opened, sealed};

/// Counts of variants that have ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VariantCounts {
    /// Variants that reached their end.
    pub done: usize,
    /// Variants that failed.
    pub failed: usize,
    /// Variants that contradict themselves, among those that reached their end.
    pub distrusted: usize,
}

impl VariantCounts {
    /// The counts of outcomes.
    pub fn of<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Self {
        let mut counts = Self::default();
        for outcome in outcomes {
            match outcome {
                Outcome::Done(account) => {
                    counts.done += 1;
                    counts.distrusted += usize::from(account.verdict.is_distrusted());
                }
                Outcome::Failed(_) => counts.failed += 1,
                Outcome::Open => {}
            }
        }
        counts
    }

    /// Variants that are no longer open.
    pub fn ended(self) -> usize {
        self.done + self.failed
    }
}

impl std::ops::AddAssign for VariantCounts {
    fn add_assign(&mut self, other: Self) {
        self.done += other.done;
        self.failed += other.failed;
        self.distrusted += other.distrusted;
    }
}

/// The answer of a worker to a task. As bytes it travels between processes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Counts of the variants of the task.
    pub finished: VariantCounts,
    /// The variants and how they ended; none where a store keeps that.
    pub outcomes: Vec<(usize, Outcome)>,
}

impl SealedValue for Answer {
    const KIND: &'static str = "answer of a task";
}

impl Answer {
    /// The answer as bytes, every number to its last bit.
    pub fn to_bytes(&self) -> Vec<u8> {
        sealed(self)
    }

    /// The answer that bytes were made of.
    ///
    /// # Errors
    /// [`SealError`] where they are something else, or of another build.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SealError> {
        opened(bytes)
    }
}
