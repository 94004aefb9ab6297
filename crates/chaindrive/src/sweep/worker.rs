//! Workers: they compute the variants of a task, on any thread, process or machine, and give the outcomes to a sink.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::choices::SharedChoice;
use super::layout::Layout;
use super::sink::{Sink, Task};
use super::store::{StoreLocation, StoreSink};
use super::threads::on_threads;
use super::{Answer, Go, Outcome, Recipe, Sweep, SweepError};
use crate::record::WriteError;

/// A sweep and a sink, opened to carry out tasks.
#[derive(Clone)]
pub struct Worker {
    sweep: Sweep,
    sink: Arc<dyn Sink>,
}

impl std::fmt::Debug for Worker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Worker")
            .field("variants", &self.sweep.len())
            .finish_non_exhaustive()
    }
}

impl Worker {
    pub(super) fn of(sweep: &Sweep, sink: impl Sink + 'static) -> Self {
        Self {
            sweep: sweep.clone(),
            sink: Arc::new(sink),
        }
    }

    /// A worker with a task a variant.
    pub(super) fn alone(sweep: &Sweep) -> Self {
        Self::of(sweep, Layout::new(sweep, 1, None))
    }

    /// Opens the store of a sweep that was begun.
    ///
    /// # Errors
    /// [`WriteError`] where there is none, or one of another build of the program or another instruction set.
    pub fn open(place: impl Into<StoreLocation>) -> Result<Self, WriteError> {
        let sink = StoreSink::open(&place.into())?;
        Ok(Self::of(&sink.sweep()?, sink))
    }

    /// A worker of a sweep in memory, see [`SweepMemory::new`](super::SweepMemory::new): all outcomes come back with the answers.
    ///
    /// # Errors
    /// [`SweepError::Origin`] where the recipe is of another build of the program or another instruction set.
    pub fn in_memory(recipe: Recipe, variants_per_task: usize) -> Result<Self, SweepError> {
        if let Some(refusal) = recipe.origin.refusal() {
            return Err(SweepError::Origin { refusal });
        }
        let sweep = Sweep::of_recipe(recipe)?;
        Ok(Self::of(
            &sweep,
            Layout::new(&sweep, variants_per_task, None),
        ))
    }

    /// Computes the variants of a task on the calling thread and gives them to the sink; none if it is stopped before all of
    /// them have ended. A task that is stored already is counted and left as it is.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    pub fn carry_out(&self, task: usize, stop: &AtomicBool) -> Result<Option<Answer>, WriteError> {
        let variants = match self.sink.task(task)? {
            Task::Open(variants) => variants,
            Task::Ended(finished) => {
                let outcomes = Vec::new();
                return Ok(Some(Answer { finished, outcomes }));
            }
        };
        let mut outcomes = Vec::new();
        for variant in variants {
            let Some(shared) = self.choice(variant, stop)? else {
                return Ok(None);
            };
            match self.sweep.carry_out_by(&shared, variant, stop) {
                Outcome::Open => return Ok(None),
                outcome => outcomes.push(outcome),
            }
        }
        self.put(task, outcomes).map(Some)
    }

    /// Carries out a task on another thread, while `go` is asked every 50 ms whether to go on.
    ///
    /// # Errors
    /// [`SweepError::Write`] when the store refuses, [`SweepError::Threads`] when the system does.
    pub fn carry_out_watched(
        &self,
        task: usize,
        mut go: impl FnMut() -> Go,
    ) -> Result<Option<Answer>, SweepError> {
        let mut answer = Ok(None);
        let compute = |task, stop: &AtomicBool| self.carry_out(task, stop);
        on_threads(&[task], Some(1), compute, |ended| {
            if let Some((_, ended)) = ended {
                answer = ended;
            }
            go()
        })?;
        Ok(answer?)
    }

    /// Gives the outcomes of all variants of a task to the sink, in their order.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    pub fn put(&self, task: usize, outcomes: Vec<Outcome>) -> Result<Answer, WriteError> {
        self.sink.put(task, outcomes)
    }

    /// The choice of a variant's block, from the sink or by trials whose result goes there; none if they are stopped. Workers
    /// that make the same choice at the same time keep the same bytes.
    pub(super) fn choice(
        &self,
        variant: usize,
        stop: &AtomicBool,
    ) -> Result<Option<SharedChoice>, WriteError> {
        let block = self.sweep.blocks().block(variant);
        self.sweep.choices.get(block, || {
            if let Some(choice) = self.sink.choice(block)? {
                return Ok(Some(Some(Arc::new(choice))));
            }
            let made = self.sweep.choose(block, stop);
            if let Some(Some(choice)) = &made {
                self.sink.keep(block, choice)?;
            }
            Ok(made)
        })
    }
}
