//! Choices of method and step for an accuracy: one a block of variants, made by trials on the first variant of it that can be run.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Sweep, account};
use crate::execute::choice;
use crate::precision::Choice;
use crate::seal::SealedValue;
use crate::{RunError, caught};

/// The choice of a block; none where every variant is on its own: no accuracy is asked for, or none of them can be run.
pub(super) type SharedChoice = Option<Arc<Choice>>;

/// The choices of a sweep that this process knows.
#[derive(Debug, Default)]
pub(super) struct Choices(Mutex<HashMap<usize, Arc<Cell>>>);

type Cell = Mutex<Option<SharedChoice>>;

impl SealedValue for Choice {
    const KIND: &'static str = "choice of method and step";
}

impl Choices {
    /// The choice of a block, made by the first who asks for it while others wait; none if that is stopped.
    pub(super) fn get<E>(
        &self,
        block: usize,
        make: impl FnOnce() -> Result<Option<SharedChoice>, E>,
    ) -> Result<Option<SharedChoice>, E> {
        let cell = Arc::clone(locked(&self.0).entry(block).or_default());
        let mut known = locked(&cell);
        if known.is_none() {
            *known = make()?;
        }
        Ok(known.clone())
    }

    /// Those that were made, with their blocks.
    pub(super) fn made(&self) -> Vec<(usize, Arc<Choice>)> {
        let cells = locked(&self.0);
        let made = cells.iter().filter_map(|(&block, cell)| {
            let choice = locked(cell).clone().flatten()?;
            Some((block, choice))
        });
        made.collect()
    }
}

/// Locks also after a panic: a choice is stored only when it is complete.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Sweep {
    /// Makes the choice of a block; none if it is stopped.
    pub(super) fn choose(&self, block: usize, stop: &AtomicBool) -> Option<SharedChoice> {
        let stopped = || stop.load(Ordering::Relaxed);
        for variant in self.blocks().members(block) {
            let attempt = || {
                let request = account::request(&self.variant(variant).ok()?, &[]).ok()?;
                match choice(&request, &stopped) {
                    Ok(choice) => Some(Some(choice.map(Arc::new))),
                    Err(RunError::Interrupted) => Some(None),
                    Err(_) => None,
                }
            };
            // What is wrong with this variant is told when it is run; the next one serves as well.
            if let Ok(Some(made)) = caught(attempt) {
                return made;
            }
        }
        Some(None)
    }
}
