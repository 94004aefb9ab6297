//! Who computes the variants of a task and stores them, in whatever process and on whatever machine.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde_json::Map;
use zarrs::storage::{ReadableStorageTraits, StoreKey, WritableStorageTraits};

use super::layout::{Layout, Region};
use super::{
    Arrays, LAYOUT, LOCK, MARK, RECIPE, Storage, blank, every_chunk, texts_before_the_mark,
};
use crate::record::WriteError;
use crate::record::zarr::error::Fault;
use crate::record::zarr::folder::Folder;
use crate::sweep::{Account, Entry, OPEN, Outcome, Quantity, Recipe, Sweep, TEXTS, fill, texts};
use crate::verdict::WrittenVerdict;

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
    root: PathBuf,
    folder: Arc<Folder>,
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
    /// [`WriteError`] where there is none, or one of another version of the program.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let io = |source| WriteError::Io {
            path: path.to_owned(),
            source,
        };
        let root = path.canonicalize().map_err(io)?;
        let folder = Arc::new(Folder::shared(&root).map_err(io)?);
        let recipe = read(&folder, RECIPE).map_err(|fault| failure(path, fault))?;
        let recipe: Recipe = recipe.ok_or_else(|| WriteError::Foreign {
            path: path.to_owned(),
            found: "this is not the store of a sweep that workers can carry out".into(),
        })?;
        if recipe.chaindrive_version != env!("CARGO_PKG_VERSION") {
            return Err(WriteError::OtherSweep {
                path: path.to_owned(),
                difference: format!(
                    "it was begun by chaindrive {}, and here is {}",
                    recipe.chaindrive_version,
                    env!("CARGO_PKG_VERSION")
                ),
            });
        }
        let sweep = Sweep::of_recipe(recipe).map_err(|error| WriteError::Store {
            path: path.to_owned(),
            source: Box::new(error),
        })?;
        Ok(Self {
            path: path.to_owned(),
            root,
            storage: folder.clone(),
            folder,
            sweep,
        })
    }

    /// Whether all variants of a task are stored.
    ///
    /// # Errors
    /// [`WriteError`] when the layout cannot be read.
    pub fn has(&self, task: usize) -> Result<bool, WriteError> {
        let stored = self.layout().and_then(|layout| self.holds(&layout, task));
        stored.map_err(|fault| failure(&self.path, fault))
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
        let named = |fault| failure(&self.path, fault);
        let layout = self.layout().map_err(named)?;
        if self.holds(&layout, task).map_err(named)? {
            let outcomes = self.read_back(&layout, task).map_err(named)?;
            let outcomes = outcomes.iter().map(|(_, outcome)| outcome);
            return Ok(Some(count(outcomes)));
        }
        let mut outcomes = Vec::new();
        for (variant, _) in layout.region(task).variants {
            let outcome = self.sweep.carry_out(variant, stop);
            if outcome == Outcome::Open {
                return Ok(None);
            }
            outcomes.push(outcome);
        }
        self.store(task, &outcomes)?;
        Ok(Some(count(outcomes.iter())))
    }

    /// Stores the outcomes of all variants of a task, in their order.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses.
    pub fn store(&self, task: usize, outcomes: &[Outcome]) -> Result<(), WriteError> {
        let stored = self.layout().and_then(|layout| {
            let layout = self.with_room(layout, outcomes)?;
            self.put(&layout, task, outcomes)
        });
        stored.map_err(|fault| failure(&self.path, fault))
    }

    pub(super) fn layout(&self) -> Result<Layout, Fault> {
        read(&self.folder, LAYOUT)?.ok_or_else(|| Fault::Short {
            name: LAYOUT.to_owned(),
        })
    }

    pub(super) fn holds(&self, layout: &Layout, task: usize) -> Result<bool, Fault> {
        let arrays = self.arrays(layout);
        let place = layout.region(task).place;
        let mark = arrays.text(MARK, Map::new())?;
        Ok(self.folder.holds(&mark.chunk_key(&place)))
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
        let grow = |layout: &mut Layout| {
            let mut grown = false;
            for outcome in outcomes {
                if let Outcome::Done(account) = outcome {
                    grown |= layout.make_room(account);
                }
            }
            grown
        };
        if !grow(&mut layout.clone()) {
            return Ok(layout);
        }
        // Others may have made it grow meanwhile: what counts is read under the lock. The system lets go of it when the
        // process ends, however it ends.
        let lock = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(self.root.join(LOCK))?;
        lock.lock()?;
        layout = self.layout()?;
        if grow(&mut layout) {
            let bytes = serde_json::to_vec(&layout)?;
            self.folder.set(&StoreKey::new(LAYOUT)?, bytes.into())?;
        }
        Ok(layout)
    }

    fn put(&self, layout: &Layout, task: usize, outcomes: &[Outcome]) -> Result<(), Fault> {
        let region = layout.region(task);
        for (name, _) in &layout.quantities {
            if let Some(quantity) = Quantity::from_name(name) {
                self.put_numbers(layout, &region, quantity, outcomes)?;
            }
        }
        let mark = TEXTS.iter().position(|(name, _)| *name == MARK);
        let mark = mark.map(|index| (index, MARK));
        for (index, name) in texts_before_the_mark().chain(mark) {
            let mut block = vec![blank(name).to_owned(); layout.block()];
            for ((_, local), outcome) in region.variants.iter().zip(outcomes) {
                texts(outcome)[index].clone_into(&mut block[*local]);
            }
            let array = self.arrays(layout).text(name, Map::new())?;
            array.store_chunk_opt(&region.place, block, &every_chunk())?;
        }
        Ok(())
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

/// A file of the store, if it is there.
fn read<T: serde::de::DeserializeOwned>(folder: &Folder, key: &str) -> Result<Option<T>, Fault> {
    match folder.get(&StoreKey::new(key)?)? {
        Some(bytes) => Ok(Some(serde_json::from_slice(&bytes)?)),
        None => Ok(None),
    }
}

fn failure(path: &Path, fault: Fault) -> WriteError {
    if path.exists() {
        WriteError::Store {
            path: path.to_owned(),
            source: Box::new(fault),
        }
    } else {
        WriteError::Vanished {
            path: path.to_owned(),
            what: "the result".into(),
        }
    }
}
