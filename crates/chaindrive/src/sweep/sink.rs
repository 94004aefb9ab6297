//! Destinations of the outcomes of tasks.

use super::layout::Layout;
use super::{Answer, Outcome, VariantCounts};
use crate::precision::Choice;
use crate::record::WriteError;

/// A task, as a sink has it.
pub(super) enum Task {
    /// To be carried out: its variants, in their order.
    Open(Vec<usize>),
    /// Carried out, with these counts.
    Ended(VariantCounts),
}

/// Where the outcomes of tasks go: back with the answer, or into a region of a store. It also knows how the sweep is cut into tasks.
pub(super) trait Sink: Send + Sync {
    /// Work of a task.
    fn task(&self, task: usize) -> Result<Task, WriteError>;

    /// Takes the outcomes of all variants of a task, in their order.
    fn put(&self, task: usize, outcomes: Vec<Outcome>) -> Result<Answer, WriteError>;

    /// The choice of a block that another worker has made.
    fn choice(&self, _block: usize) -> Result<Option<Choice>, WriteError> {
        Ok(None)
    }

    /// Keeps a choice for other workers.
    fn keep(&self, _block: usize, _choice: &Choice) -> Result<(), WriteError> {
        Ok(())
    }
}

/// Outcomes in memory come back with the answer: all that there is to know is how the sweep is cut.
impl Sink for Layout {
    fn task(&self, task: usize) -> Result<Task, WriteError> {
        Ok(Task::Open(self.region(task).variants().collect()))
    }

    fn put(&self, task: usize, outcomes: Vec<Outcome>) -> Result<Answer, WriteError> {
        Ok(Answer {
            finished: VariantCounts::of(&outcomes),
            outcomes: self.region(task).variants().zip(outcomes).collect(),
        })
    }
}
