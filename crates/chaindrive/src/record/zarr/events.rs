//! The table of contacts in the store: columns that grow with the number of contacts.
//!
//! Contacts that ended are appended while the run goes on; those that last are appended when it ends, so
//! that no row ever changes.

use std::sync::Arc;

use chaindrive_mechanics::{ContactEvent, System};
use serde_json::{Map, Value};
use zarrs::array::codec::ZstdCodec;
use zarrs::array::{ArrayBuilder, CodecOptions, data_type};

use crate::event::{EventColumn, EventTable};
use crate::zarr::{Fault, Storage, StoredArray, ZSTD_LEVEL, metadata, store_metadata};

/// Contacts in a chunk.
const EVENTS_PER_CHUNK: usize = 1 << 13;

/// The columns of the table.
pub(super) struct EventTracks {
    arrays: Vec<(EventColumn, StoredArray)>,
    /// The chunk in work, its index, and how many of its contacts are in the store.
    pending: EventTable,
    chunk: u64,
    stored: usize,
}

impl EventTracks {
    pub(super) fn new(storage: &Storage, system: &System) -> Result<Self, Fault> {
        let array = |column: EventColumn| {
            let (shape, chunk) = (vec![0], vec![EVENTS_PER_CHUNK as u64]);
            let mut builder = match column {
                EventColumn::Kind | EventColumn::Body => {
                    ArrayBuilder::new(shape, chunk, data_type::string(), "")
                }
                EventColumn::Roller => ArrayBuilder::new(shape, chunk, data_type::int64(), -1_i64),
                _ => ArrayBuilder::new(shape, chunk, data_type::float64(), f64::NAN),
            };
            let array = builder
                .dimension_names(Some(["event"]))
                .attributes(about(column))
                .bytes_to_bytes_codecs(vec![Arc::new(ZstdCodec::new(ZSTD_LEVEL, true))])
                .build(storage.clone(), &format!("/{}", column.name()))?;
            Ok((column, array))
        };
        Ok(Self {
            arrays: EventColumn::ALL
                .into_iter()
                .map(array)
                .collect::<Result<_, Fault>>()?,
            pending: EventTable::new(system),
            chunk: 0,
            stored: 0,
        })
    }

    /// Goes on after the contacts that are in the store; what there is more of them is forgotten.
    pub(super) fn go_on(&mut self, contacts: u64) -> Result<(), Fault> {
        self.chunk = contacts / EVENTS_PER_CHUNK as u64;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "less than the contacts of a chunk"
        )]
        let held = (contacts % EVENTS_PER_CHUNK as u64) as usize;
        let place = [self.chunk];
        for (column, array) in &mut self.arrays {
            array.set_shape(vec![contacts])?;
            if held == 0 {
                continue;
            }
            let column = *column;
            let short = || Fault::Short {
                name: column.name().to_owned(),
            };
            let table = &mut self.pending;
            let whole = match column {
                EventColumn::Kind => {
                    let names: Vec<String> = array.retrieve_chunk(&place)?;
                    table.kind = known_kinds(&names[..held.min(names.len())]).ok_or_else(short)?;
                    table.kind.len()
                }
                EventColumn::Body => {
                    table.body = array.retrieve_chunk(&place)?;
                    table.body.truncate(held);
                    table.body.len()
                }
                EventColumn::Roller => {
                    table.roller = array.retrieve_chunk(&place)?;
                    table.roller.truncate(held);
                    table.roller.len()
                }
                numbers => {
                    let mut values: Vec<f64> = array.retrieve_chunk(&place)?;
                    values.truncate(held);
                    let count = values.len();
                    if let Some(column) = table.numbers_mut(numbers) {
                        *column = values;
                    }
                    count
                }
            };
            if whole != held {
                return Err(short());
            }
        }
        self.stored = held;
        Ok(())
    }

    /// The last chunk in use, and the names of the columns.
    pub(super) fn last_chunk(&self) -> (u64, impl Iterator<Item = &'static str>) {
        let names = self.arrays.iter().map(|(column, _)| column.name());
        (self.chunk, names)
    }

    /// Takes contacts; stores every chunk that is full.
    pub(super) fn push(&mut self, events: &[ContactEvent]) -> Result<(), Fault> {
        for event in events {
            self.pending.push(event);
            if self.pending.len() == EVENTS_PER_CHUNK {
                self.store()?;
                self.pending.clear();
                self.stored = 0;
                self.chunk += 1;
            }
        }
        Ok(())
    }

    /// Stores the chunk in work, filled up.
    pub(super) fn store(&mut self) -> Result<(), Fault> {
        let held = self.pending.len();
        if held == self.stored {
            return Ok(());
        }
        let (place, table) = ([self.chunk], &self.pending);
        // A chunk of nothing but fill is stored as well, as in the tracks.
        let options = CodecOptions::default().with_store_empty_chunks(true);
        for (column, array) in &self.arrays {
            if let Some(numbers) = table.numbers(*column) {
                let numbers = filled(numbers.to_vec(), f64::NAN);
                array.store_chunk_opt(&place, numbers, &options)?;
            } else if *column == EventColumn::Roller {
                array.store_chunk_opt(&place, filled(table.roller.clone(), -1), &options)?;
            } else {
                let names = if *column == EventColumn::Kind {
                    table.kind.iter().map(|kind| (*kind).to_owned()).collect()
                } else {
                    table.body.clone()
                };
                array.store_chunk_opt(&place, filled(names, String::new()), &options)?;
            }
        }
        self.stored = held;
        Ok(())
    }

    /// Makes the arrays as long as there are contacts; takes effect with their metadata.
    pub(super) fn set_length(&mut self) -> Result<(), Fault> {
        let count = self.chunk * EVENTS_PER_CHUNK as u64 + self.pending.len() as u64;
        for (_, array) in &mut self.arrays {
            array.set_shape(vec![count])?;
        }
        Ok(())
    }

    pub(super) fn metadata(&self) -> Result<Vec<(&'static str, Value)>, Fault> {
        let arrays = self.arrays.iter();
        arrays
            .map(|(column, array)| Ok((column.name(), metadata(array)?)))
            .collect()
    }

    pub(super) fn store_metadata(&self) -> Result<(), Fault> {
        self.arrays
            .iter()
            .try_for_each(|(_, array)| store_metadata(array))
    }
}

/// Kinds of contact by their names; none if there is another one.
fn known_kinds(names: &[String]) -> Option<Vec<&'static str>> {
    let known = |name: &String| EventTable::KINDS.into_iter().find(|kind| kind == name);
    names.iter().map(known).collect()
}

fn filled<T: Clone>(mut values: Vec<T>, with: T) -> Vec<T> {
    values.resize(EVENTS_PER_CHUNK, with);
    values
}

fn about(column: EventColumn) -> Map<String, Value> {
    let mut about = Map::new();
    if let Some(unit) = column.unit() {
        about.insert("units".into(), unit.into());
    }
    about.insert("long_name".into(), column.description().into());
    about
}
