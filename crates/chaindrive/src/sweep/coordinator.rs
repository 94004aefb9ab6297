//! The coordinator of a sweep: it hands out tasks and takes back results, in the one loop of all sweeps on threads.

use std::sync::atomic::AtomicBool;

use super::layout::Layout;
use super::threads::on_threads;
use super::{Answer, Go, Outcome, Progress, Sweep, SweepError, Tally, VariantCounts, Worker};
use crate::record::WriteError;

/// Observer of the progress of a sweep; its answer says whether to go on.
pub type Watch<'a> = dyn FnMut(Progress<'_>) -> Go + 'a;

/// Hands out the tasks of a sweep, to threads of this process or to workers elsewhere, and takes their answers.
pub trait Coordinator {
    /// The sweep.
    fn sweep(&self) -> &Sweep;

    /// A worker in this process.
    fn worker(&self) -> Worker;

    /// Numbers of the tasks that are still to be carried out.
    ///
    /// # Errors
    /// [`WriteError`] when the store cannot be read.
    fn open_tasks(&self) -> Result<Vec<usize>, WriteError>;

    /// Takes the answer of a task.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    fn take(&mut self, answer: Answer) -> Result<(), WriteError>;

    /// Hears that a task was lost. In memory its variants have failed; in a store it stays open.
    fn lose(&mut self, task: usize, reason: &str);

    /// Progress of the sweep.
    fn progress(&self) -> Progress<'_>;

    /// Ends the sweep, and returns the tally of all variants and the short account of them.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    fn finish(&mut self) -> Result<(Tally, String), WriteError>;

    /// Whether workers and readers find this result; until then an earlier one may still be in its place.
    fn is_public(&self) -> bool {
        true
    }

    /// Makes ready for workers elsewhere; [`Go::NoFurther`] where the watch stopped it.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn start(&mut self, _watch: &mut Watch<'_>) -> Result<Go, SweepError> {
        Ok(Go::On)
    }

    /// Carries out all open tasks on `jobs` threads of this process, as many as there are cores if absent; [`Go::NoFurther`]
    /// where the watch stopped it.
    ///
    /// The watch is called on the calling thread whenever a task has ended, and every 50 ms.
    ///
    /// # Errors
    /// [`SweepError::Write`] when the store refuses, [`SweepError::Threads`] when the system does.
    fn run(&mut self, jobs: Option<usize>, watch: &mut Watch<'_>) -> Result<Go, SweepError> {
        if self.start(watch)? == Go::NoFurther {
            return Ok(Go::NoFurther);
        }
        let open = self.open_tasks()?;
        carry_out(self, &open, jobs, watch)
    }
}

/// The loop: tasks go to threads in their order, answers come back in any.
pub(super) fn carry_out<C: Coordinator + ?Sized>(
    coordinator: &mut C,
    tasks: &[usize],
    jobs: Option<usize>,
    watch: &mut Watch<'_>,
) -> Result<Go, SweepError> {
    let worker = coordinator.worker();
    let (mut refused, mut go) = (None, Go::On);
    let compute = |task, stop: &AtomicBool| worker.carry_out(task, stop);
    let ended = on_threads(tasks, jobs, compute, |ended| {
        let answer = ended.map_or(Ok(None), |(_, answer)| answer);
        let taken = answer.and_then(|it| it.map_or(Ok(()), |answer| coordinator.take(answer)));
        if let Err(error) = taken {
            refused.get_or_insert(error);
            go = Go::NoFurther;
        }
        if go == Go::On {
            go = watch(coordinator.progress());
        }
        go
    });
    refused.map_or(Ok(()), Err)?;
    Ok(ended?)
}

/// A sweep whose outcomes are kept in memory.
#[derive(Debug)]
pub struct SweepMemory {
    sweep: Sweep,
    layout: Layout,
    outcomes: Vec<Outcome>,
    finished: VariantCounts,
}

impl SweepMemory {
    /// Begins a sweep with tasks of about so many variants.
    pub fn new(sweep: &Sweep, variants_per_task: usize) -> Self {
        Self {
            sweep: sweep.clone(),
            layout: Layout::new(sweep, variants_per_task, None),
            outcomes: vec![Outcome::Open; sweep.len()],
            finished: VariantCounts::default(),
        }
    }

    /// Outcomes of all variants, in their order.
    pub fn into_outcomes(self) -> Vec<Outcome> {
        self.outcomes
    }
}

impl Coordinator for SweepMemory {
    fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    fn worker(&self) -> Worker {
        Worker::of(&self.sweep, self.layout.clone())
    }

    fn open_tasks(&self) -> Result<Vec<usize>, WriteError> {
        let is_open = |task: &usize| {
            let region = self.layout.region(*task);
            let is_open = |variant: usize| self.outcomes[variant] == Outcome::Open;
            region.variants().any(is_open)
        };
        Ok((0..self.layout.tasks()).filter(is_open).collect())
    }

    fn take(&mut self, answer: Answer) -> Result<(), WriteError> {
        self.finished += answer.finished;
        for (variant, outcome) in answer.outcomes {
            self.outcomes[variant] = outcome;
        }
        Ok(())
    }

    fn lose(&mut self, task: usize, reason: &str) {
        for variant in self.layout.region(task).variants() {
            self.outcomes[variant] = Outcome::Failed(reason.to_owned());
            self.finished.failed += 1;
        }
    }

    fn progress(&self) -> Progress<'_> {
        Progress {
            outcomes: &self.outcomes,
            finished: self.finished.ended(),
            variants: self.outcomes.len(),
        }
    }

    fn finish(&mut self) -> Result<(Tally, String), WriteError> {
        let report = self.sweep.report(&self.outcomes).to_string();
        Ok((Tally::of(&self.outcomes), report))
    }
}
