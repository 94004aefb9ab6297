//! Who computes the variants of a task and stores them, in whatever process and on whatever machine.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde::de::DeserializeOwned;
use serde_json::Map;
use zarrs::storage::{Bytes, StoreKey};

use super::{Arrays, MARK, Storage, blank, every_chunk, texts_before_the_mark};
use crate::precision::Choice;
use crate::seal::{opened, sealed};
use crate::sweep::choices::Shared;
use crate::sweep::layout::{Layout, Region};
use crate::sweep::{Account, Entry, OPEN, Outcome, Quantity, Recipe, Sweep, TEXTS, fill, texts};
use crate::verdict::WrittenVerdict;
use crate::zarr::{self, CHOICES, Fault, Folder, Ground, LAYOUT, Objects, RECIPE, WriteError};

/// Counts of a task that is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Finished {
    /// Variants that reached their end.
    pub done: usize,
    /// Variants that failed.
    pub failed: usize,
    /// Variants that contradict themselves, among those that reached their end.
    pub distrusted: usize,
}

/// A store of a sweep, opened to carry out tasks of it.
pub struct Worker {
    path: PathBuf,
    storage: Storage,
    sweep: Sweep,
}

impl std::fmt::Debug for Worker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Worker")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

impl Worker {
    /// Opens the store of a sweep that was begun.
    ///
    /// # Errors
    /// [`WriteError`] where there is none, or one of another build of the program or another instruction set.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        let root = path.canonicalize().map_err(io)?;
        Self::on(
            Ground::of(Arc::new(Folder::shared(&root).map_err(io)?)),
            path,
        )
    }

    /// Opens the store of a sweep that was begun in an object store.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_in(objects: &Arc<dyn Objects>) -> Result<Self, WriteError> {
        let path = PathBuf::from(objects.name());
        let bucket = zarr::bucket(&path, objects)?;
        Self::on(Ground::of(Arc::new(bucket)), &path)
    }

    pub(super) fn on(storage: Storage, path: &Path) -> Result<Self, WriteError> {
        let recipe = read(&storage, RECIPE).map_err(|fault| failure(&storage, path, fault))?;
        let recipe: Recipe = recipe.ok_or_else(|| WriteError::Foreign {
            path: path.to_owned(),
            found: "this is not the store of a sweep that workers can carry out".into(),
        })?;
        if let Some(difference) = recipe.origin.refusal() {
            return Err(WriteError::OtherSweep {
                path: path.to_owned(),
                difference,
            });
        }
        let sweep = Sweep::of_recipe(recipe).map_err(|error| WriteError::Store {
            path: path.to_owned(),
            source: Box::new(error),
        })?;
        Ok(Self {
            path: path.to_owned(),
            storage,
            sweep,
        })
    }

    /// Whether all variants of a task are stored.
    ///
    /// # Errors
    /// [`WriteError`] when the layout cannot be read.
    pub fn has(&self, task: usize) -> Result<bool, WriteError> {
        let stored = self.layout().and_then(|layout| self.holds(&layout, task));
        stored.map_err(|fault| self.failure(fault))
    }

    /// Computes the variants of a task on the calling thread and stores them; none if it is stopped before all of them have
    /// ended. A task that is stored already is counted and left as it is.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    pub fn carry_out(
        &self,
        task: usize,
        stop: &AtomicBool,
    ) -> Result<Option<Finished>, WriteError> {
        let named = |fault| self.failure(fault);
        let layout = self.layout().map_err(named)?;
        if self.holds(&layout, task).map_err(named)? {
            let outcomes = self.read_back(&layout, task).map_err(named)?;
            let outcomes = outcomes.iter().map(|(_, outcome)| outcome);
            return Ok(Some(count(outcomes)));
        }
        let mut outcomes = Vec::new();
        for (variant, _) in layout.region(task).variants {
            let Some(shared) = self.choice(variant, stop).map_err(named)? else {
                return Ok(None);
            };
            let outcome = self.sweep.carry_out_by(&shared, variant, stop);
            if outcome == Outcome::Open {
                return Ok(None);
            }
            outcomes.push(outcome);
        }
        self.store(task, &outcomes)?;
        Ok(Some(count(outcomes.iter())))
    }

    /// The choice of a variant's block, from the store or by trials whose result goes there; none if they are stopped. Workers
    /// that make the same choice at the same time put the same bytes.
    fn choice(&self, variant: usize, stop: &AtomicBool) -> Result<Option<Shared>, Fault> {
        let block = self.sweep.blocks().block(variant);
        self.sweep.choices.get(block, || {
            if let Some(bytes) = self.storage.read(&key_of(block)?)? {
                return Ok(Some(Some(Arc::new(opened(&bytes)?))));
            }
            let made = self.sweep.choose(block, stop);
            if let Some(Some(choice)) = &made {
                self.keep(block, choice)?;
            }
            Ok(made)
        })
    }

    /// Puts a choice into the store, unless another one has taken the place.
    pub(super) fn keep(&self, block: usize, choice: &Choice) -> Result<(), Fault> {
        match self.storage.missing() {
            None => Ok(self.storage.put(&key_of(block)?, &sealed(choice))?),
            Some(_) => Err(std::io::Error::from(std::io::ErrorKind::NotFound).into()),
        }
    }

    /// Stores the outcomes of all variants of a task, in their order.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    pub fn store(&self, task: usize, outcomes: &[Outcome]) -> Result<(), WriteError> {
        // Another sweep may have taken the place while this task was computed.
        if let Some(what) = self.storage.missing() {
            let path = self.path.clone();
            return Err(WriteError::Vanished { path, what });
        }
        let stored = self.layout().and_then(|layout| {
            let layout = self.with_room(layout, outcomes)?;
            self.put(&layout, task, outcomes)
        });
        stored.map_err(|fault| self.failure(fault))
    }

    fn failure(&self, fault: Fault) -> WriteError {
        failure(&self.storage, &self.path, fault)
    }

    pub(super) fn layout(&self) -> Result<Layout, Fault> {
        read(&self.storage, LAYOUT)?.ok_or_else(no_layout)
    }

    pub(super) fn holds(&self, layout: &Layout, task: usize) -> Result<bool, Fault> {
        let arrays = self.arrays(layout);
        let place = layout.region(task).place;
        let mark = arrays.text(MARK, Map::new())?;
        Ok(self.storage.size(&mark.chunk_key(&place))?.is_some())
    }

    /// The tasks that are stored.
    pub(super) fn stored(&self, layout: &Layout) -> Result<BTreeSet<usize>, Fault> {
        let arrays = self.arrays(layout);
        let mark = arrays.text(MARK, Map::new())?;
        let held = self.storage.held(&format!("{MARK}/"))?;
        let is_held = |task: &usize| held.contains(&mark.chunk_key(&layout.region(*task).place));
        Ok((0..layout.tasks()).filter(is_held).collect())
    }

    fn arrays<'a>(&'a self, layout: &'a Layout) -> Arrays<'a> {
        Arrays {
            storage: &self.storage,
            layout,
            dims: None,
        }
    }

    /// The layout with room for all outcomes; where it has to grow, it does so for all workers.
    fn with_room(&self, mut layout: Layout, outcomes: &[Outcome]) -> Result<Layout, Fault> {
        let grow = |layout: &mut Layout| layout.make_room_for(outcomes);
        if !grow(&mut layout.clone()) {
            return Ok(layout);
        }
        // Others may have made it grow meanwhile: what counts is what is there now.
        self.storage.change(&StoreKey::new(LAYOUT)?, &mut |bytes| {
            layout = parsed(bytes)?.ok_or_else(no_layout)?;
            let grown = grow(&mut layout).then(|| serde_json::to_vec(&layout));
            Ok(grown.transpose()?.map(Bytes::from))
        })?;
        Ok(layout)
    }

    fn put(&self, layout: &Layout, task: usize, outcomes: &[Outcome]) -> Result<(), Fault> {
        let region = layout.region(task);
        self.storage.on_each(&layout.quantities, |(name, _)| {
            Quantity::from_name(name).map_or(Ok(()), |quantity| {
                self.put_numbers(layout, &region, quantity, outcomes)
            })
        })?;
        let put = |(index, name): &(usize, &str)| {
            let mut block = vec![blank(name).to_owned(); layout.block()];
            for ((_, local), outcome) in region.variants.iter().zip(outcomes) {
                texts(outcome)[*index].clone_into(&mut block[*local]);
            }
            let array = self.arrays(layout).text(name, Map::new())?;
            Ok(array.store_chunk_opt(&region.place, block, &every_chunk())?)
        };
        let texts: Vec<(usize, &str)> = texts_before_the_mark().collect();
        self.storage.on_each(&texts, put)?;
        // The mark is last: who finds it finds all others.
        let mark = TEXTS.iter().position(|(name, _)| *name == MARK);
        mark.map_or(Ok(()), |index| put(&(index, MARK)))
    }

    /// Writes a quantity: a chunk, or several where it is cut along time or labels.
    fn put_numbers(
        &self,
        layout: &Layout,
        region: &Region,
        quantity: Quantity,
        outcomes: &[Outcome],
    ) -> Result<(), Fault> {
        let sampled = quantity.is_sampled();
        let axis = layout.axis(quantity);
        if quantity.along().is_some() && axis.is_none_or(|axis| axis.labels.is_empty()) {
            return Ok(());
        }
        let labels = axis.map(|axis| axis.labels.as_slice());
        let (width, wide) = axis.map_or((1, 1), |axis| (axis.labels.len(), axis.cut));
        let longest = outcomes.iter().map(|outcome| match outcome {
            Outcome::Done(account) => account.time.len(),
            Outcome::Failed(_) | Outcome::Open => 0,
        });
        // Stretches of time that no variant of the task has stay unwritten.
        let (length, long) = if sampled {
            (longest.max().unwrap_or(0), layout.samples.max(1))
        } else {
            (1, 1)
        };
        let rows = |outcome: &Outcome| {
            let mut rows = vec![f64::NAN; length * width];
            if let Outcome::Done(account) = outcome {
                fill(account, quantity, labels, &mut rows);
            }
            rows
        };
        let rows: Vec<Vec<f64>> = outcomes.iter().map(rows).collect();
        let array = self.arrays(layout).quantity(quantity, Map::new())?;
        for first in (0..length).step_by(long) {
            for left in (0..width).step_by(wide) {
                let mut block = vec![f64::NAN; layout.block() * long * wide];
                for ((_, local), rows) in region.variants.iter().zip(&rows) {
                    let kept = (first + long).min(length) - first;
                    let columns = (left + wide).min(width) - left;
                    for row in 0..kept {
                        let from = (first + row) * width + left;
                        let to = (local * long + row) * wide;
                        block[to..to + columns].copy_from_slice(&rows[from..from + columns]);
                    }
                }
                let mut place = region.place.clone();
                if sampled {
                    place.push((first / long) as u64);
                }
                if axis.is_some() {
                    place.push((left / wide) as u64);
                }
                array.store_chunk_opt(&place, block, &every_chunk())?;
            }
        }
        Ok(())
    }

    /// The variants of a task with what is stored of them, channels excepted.
    pub(super) fn read_back(
        &self,
        layout: &Layout,
        task: usize,
    ) -> Result<Vec<(usize, Outcome)>, Fault> {
        let region = layout.region(task);
        let arrays = self.arrays(layout);
        let mut told = Vec::new();
        for (name, _) in TEXTS {
            let array = arrays.text(name, Map::new())?;
            let texts: Vec<String> = array.retrieve_chunk(&region.place)?;
            told.push(texts);
        }
        let mut numbers = Vec::new();
        for (name, _) in &layout.quantities {
            let Some(quantity) = Quantity::from_name(name).filter(|it| !it.is_sampled()) else {
                continue;
            };
            let mut place = region.place.clone();
            let axis = layout.axis(quantity);
            if quantity.along().is_some() {
                place.push(0);
                if axis.is_none_or(|axis| axis.labels.is_empty()) {
                    continue;
                }
            }
            let wide = axis.map_or(1, |axis| axis.cut);
            let array = arrays.quantity(quantity, Map::new())?;
            let count = axis.map_or(1, |axis| axis.labels.len().div_ceil(axis.cut));
            let mut pieces: Vec<Vec<f64>> = Vec::new();
            for piece in 0..count {
                if axis.is_some() {
                    place[region.place.len()] = piece as u64;
                }
                pieces.push(array.retrieve_chunk(&place)?);
            }
            numbers.push((quantity, wide, pieces));
        }
        let outcome = |local: usize| {
            let text = |name: &str| {
                let index = TEXTS.iter().position(|(known, _)| *known == name);
                index.map_or_else(String::new, |index| told[index][local].clone())
            };
            match text(MARK).as_str() {
                OPEN => Outcome::Open,
                "" => Outcome::Done(Account {
                    entries: numbers
                        .iter()
                        .map(|(quantity, wide, pieces)| Entry {
                            quantity: *quantity,
                            unit: quantity.unit().to_owned(),
                            values: pieces
                                .iter()
                                .flat_map(|piece| &piece[local * wide..][..*wide])
                                .copied()
                                .collect(),
                        })
                        .collect(),
                    verdict: WrittenVerdict {
                        verdict: text("verdict"),
                        reasons: text("reasons"),
                        note: text("verdict_note"),
                    },
                    ..Account::default()
                }),
                message => Outcome::Failed(message.to_owned()),
            }
        };
        let variants = region.variants.iter();
        Ok(variants
            .map(|(variant, local)| (*variant, outcome(*local)))
            .collect())
    }
}

fn count<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Finished {
    let mut finished = Finished::default();
    for outcome in outcomes {
        match outcome {
            Outcome::Done(account) => {
                finished.done += 1;
                finished.distrusted += usize::from(account.verdict.is_distrusted());
            }
            Outcome::Failed(_) => finished.failed += 1,
            Outcome::Open => {}
        }
    }
    finished
}

/// Name of the file with the choice of a block.
fn key_of(block: usize) -> Result<StoreKey, Fault> {
    Ok(StoreKey::new(format!("{CHOICES}/{block}"))?)
}

/// A file of the store, if it is there.
fn read<T: DeserializeOwned>(storage: &Storage, key: &str) -> Result<Option<T>, Fault> {
    parsed(storage.read(&StoreKey::new(key)?)?)
}

fn parsed<T: DeserializeOwned>(bytes: Option<Bytes>) -> Result<Option<T>, Fault> {
    let parsed = bytes.map(|bytes| serde_json::from_slice(&bytes));
    Ok(parsed.transpose()?)
}

fn no_layout() -> Fault {
    Fault::Short {
        name: LAYOUT.to_owned(),
    }
}

/// A fault with its place; that the store was taken away explains every other.
fn failure(storage: &Storage, path: &Path, fault: Fault) -> WriteError {
    let path = path.to_owned();
    match storage.missing() {
        None => WriteError::Store {
            path,
            source: Box::new(fault),
        },
        Some(what) => WriteError::Vanished { path, what },
    }
}
