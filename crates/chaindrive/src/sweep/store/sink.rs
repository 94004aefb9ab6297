//! Regions of a store, where the outcomes of tasks go.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde_json::Map;
use zarrs::storage::{Bytes, StoreKey};

use super::{Arrays, MARK, Storage, StoreLocation, every_chunk};
use crate::chain_verdict::WrittenChainVerdict;
use crate::precision::Choice;
use crate::seal::{opened, sealed};
use crate::sweep::layout::Layout;
use crate::sweep::sink::{Sink, Task};
use crate::sweep::{
    Account, Answer, Entry, OPEN, Outcome, Recipe, ResultQuantity, Sweep, TEXTS, VariantCounts,
    chunks,
};
use crate::verdict::WrittenVerdict;
use crate::zarr::{self, CHOICES, Fault, Folder, Ground, LAYOUT, RECIPE, WriteError};

/// The files of a sweep, to put the outcomes of tasks there and to read them back.
#[derive(Clone)]
pub(crate) struct StoreSink {
    path: PathBuf,
    storage: Storage,
}

impl StoreSink {
    /// The store of a sweep that was begun.
    pub(crate) fn open(place: &StoreLocation) -> Result<Self, WriteError> {
        match place {
            StoreLocation::Disk(path) => {
                let folder = path.canonicalize().and_then(|root| Folder::shared(&root));
                let folder = folder.map_err(|source| WriteError::Io {
                    path: path.clone(),
                    source,
                })?;
                Ok(Self::on(Ground::of(Arc::new(folder)), path))
            }
            StoreLocation::Objects(objects) => {
                let path = PathBuf::from(objects.name());
                let bucket = zarr::bucket(&path, objects)?;
                Ok(Self::on(Ground::of(Arc::new(bucket)), &path))
            }
        }
    }

    pub(super) fn on(storage: Storage, path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            storage,
        }
    }

    /// The sweep of which the tasks are.
    pub(crate) fn sweep(&self) -> Result<Sweep, WriteError> {
        let path = || self.path.clone();
        let recipe = read(&self.storage, RECIPE).map_err(|fault| self.failure(fault))?;
        let recipe: Recipe = recipe.ok_or_else(|| WriteError::Foreign {
            path: path(),
            found: "this is not the store of a sweep that workers can carry out".into(),
        })?;
        if let Some(difference) = recipe.origin.refusal() {
            return Err(WriteError::OtherSweep {
                path: path(),
                difference,
            });
        }
        Sweep::of_recipe(recipe).map_err(|error| WriteError::Store {
            path: path(),
            source: Box::new(error),
        })
    }

    /// A fault with its place; that the store was taken away explains every other.
    fn failure(&self, fault: Fault) -> WriteError {
        let path = self.path.clone();
        match self.storage.missing() {
            None => WriteError::Store {
                path,
                source: Box::new(fault),
            },
            Some(what) => WriteError::Vanished { path, what },
        }
    }

    /// Refuses to write where another store has taken the place.
    fn check_place(&self) -> Result<(), Fault> {
        match self.storage.missing() {
            None => Ok(()),
            Some(_) => Err(std::io::Error::from(std::io::ErrorKind::NotFound).into()),
        }
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

    fn put_region(&self, layout: &Layout, task: usize, outcomes: &[Outcome]) -> Result<(), Fault> {
        let region = layout.region(task);
        let arrays = self.arrays(layout);
        self.storage.on_each(&layout.quantities, |(name, _)| {
            let Some(quantity) = ResultQuantity::from_name(name) else {
                return Ok(());
            };
            let array = arrays.quantity(quantity, Map::new())?;
            let chunks = chunks::numbers(layout, &region, quantity, outcomes);
            let mut chunks = chunks.into_iter();
            chunks.try_for_each(|(place, chunk)| {
                Ok(array.store_chunk_opt(&place, chunk, &every_chunk())?)
            })
        })?;
        let put = |name: &&str| {
            let chunk = chunks::texts(layout, &region, name, outcomes);
            let array = arrays.text(name, Map::new())?;
            Ok(array.store_chunk_opt(&region.place, chunk, &every_chunk())?)
        };
        let texts = TEXTS.iter().map(|(name, _)| *name);
        let texts: Vec<&str> = texts.filter(|name| *name != MARK).collect();
        self.storage.on_each(&texts, put)?;
        // The mark is last: who finds it finds all others.
        put(&MARK)
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
            let Some(quantity) = ResultQuantity::from_name(name).filter(|it| !it.is_sampled())
            else {
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
                        chains: WrittenChainVerdict {
                            verdict: text("chain_verdict"),
                            reasons: text("chain_reasons"),
                            note: text("chain_verdict_note"),
                        },
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

impl Sink for StoreSink {
    fn task(&self, task: usize) -> Result<Task, WriteError> {
        let found = self.layout().and_then(|layout| {
            if !self.holds(&layout, task)? {
                return Ok(Task::Open(layout.region(task).variants().collect()));
            }
            let stored = self.read_back(&layout, task)?;
            let outcomes = stored.iter().map(|(_, outcome)| outcome);
            Ok(Task::Ended(VariantCounts::of(outcomes)))
        });
        found.map_err(|fault| self.failure(fault))
    }

    fn put(&self, task: usize, outcomes: Vec<Outcome>) -> Result<Answer, WriteError> {
        // Another sweep may have taken the place while this task was computed.
        let stored = self.check_place().and_then(|()| {
            let layout = self.with_room(self.layout()?, &outcomes)?;
            self.put_region(&layout, task, &outcomes)
        });
        stored.map_err(|fault| self.failure(fault))?;
        Ok(Answer {
            finished: VariantCounts::of(&outcomes),
            outcomes: Vec::new(),
        })
    }

    fn choice(&self, block: usize) -> Result<Option<Choice>, WriteError> {
        let read = || match self.storage.read(&key_of(block)?)? {
            Some(bytes) => Ok(Some(opened(&bytes)?)),
            None => Ok(None),
        };
        read().map_err(|fault| self.failure(fault))
    }

    fn keep(&self, block: usize, choice: &Choice) -> Result<(), WriteError> {
        let put = || {
            self.check_place()?;
            Ok(self.storage.put(&key_of(block)?, &sealed(choice))?)
        };
        put().map_err(|fault| self.failure(fault))
    }
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
