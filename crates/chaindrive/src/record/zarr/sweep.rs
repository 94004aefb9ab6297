//! A sweep on disk: one array a quantity, the swept dimensions first.
//!
//! Written as a whole, again and again while the sweep goes on: the arrays first, then the group document
//! that lists them. Every file appears whole. The shapes are known when the first variant has ended;
//! from then on a reader that comes in between, or after the program was killed, finds old or new values
//! in each array, unless a later variant has more samples or links than all before it.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Map, Value};
use zarrs::array::builder::ArrayBuilderFillValue;
use zarrs::array::codec::ZstdCodec;
use zarrs::array::{ArrayBuilder, CodecOptions, DataType, data_type};

use super::error::Fault;
use super::store::Store;
use super::track::{StoredArray, ZSTD_LEVEL, metadata, store_metadata};
use super::{Ending, Existing, about};
use crate::record::attributes::{FORMAT, Story};
use crate::record::error::WriteError;
use crate::sweep::{Coordinate, Outcome, Stacked, Sweep};

/// Numbers in a chunk, about 1 MiB: beyond that a chunk is a stretch of a single variant.
const NUMBERS_PER_CHUNK: usize = 1 << 17;

/// A store for a sweep.
pub struct SweepWriter {
    store: Store,
}

impl std::fmt::Debug for SweepWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SweepWriter")
            .field("path", &self.store.path())
            .finish_non_exhaustive()
    }
}

impl SweepWriter {
    /// Makes the store for a sweep that is about to begin, without results as yet.
    ///
    /// # Errors
    /// [`WriteError`] when the target is taken, or cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        sweep: &Sweep,
        existing: Existing,
    ) -> Result<Self, WriteError> {
        let mut writer = Self {
            store: Store::begin(path.as_ref(), existing)?,
        };
        let open = vec![Outcome::Open; sweep.len()];
        writer.write(sweep, &open, &Ending::None)?;
        writer.store.publish()?;
        Ok(writer)
    }

    /// Writes what is known of all variants, in place of what was written before.
    ///
    /// # Errors
    /// [`WriteError`] when the store refuses, and in every call after that; the store then says that it failed.
    pub fn write(
        &mut self,
        sweep: &Sweep,
        outcomes: &[Outcome],
        ending: &Ending,
    ) -> Result<(), WriteError> {
        let stacked = sweep.stack(outcomes);
        let arrays = self.put(sweep, &stacked);
        let written = arrays.map_err(|fault| self.store.fault(fault));
        let attributes = attributes(sweep, &stacked, outcomes, ending);
        let told = written.and_then(|arrays| self.store.tell(attributes, arrays, ending));
        if let Err(error) = &told {
            self.store.give_up(&error.without_path());
        }
        told
    }

    fn put(&self, sweep: &Sweep, stacked: &Stacked) -> Result<Map<String, Value>, Fault> {
        let mut arrays = Map::new();
        for dimension in sweep.dimensions() {
            let mut about = Map::new();
            if let Some(unit) = dimension.unit {
                about.insert("units".into(), unit.into());
            }
            about.insert("long_name".into(), dimension.path.as_str().into());
            about.insert("path".into(), dimension.path.as_str().into());
            let array = self.coordinate(&dimension.name, &dimension.values, about)?;
            arrays.insert(dimension.name.clone(), array);
        }
        if let Some(time) = &stacked.time {
            let array = self.numbers(
                "time",
                &["time"],
                &[time.len()],
                1,
                time,
                about("s", "time"),
            );
            arrays.insert("time".into(), array?);
        }
        for (name, labels) in &stacked.labels {
            let array = self.coordinate(name, labels, Map::new())?;
            arrays.insert(name.clone(), array);
        }
        let swept: Vec<&str> = sweep.dimensions().iter().map(|d| d.name.as_str()).collect();
        for it in &stacked.quantities {
            let quantity = it.quantity;
            let dims: Vec<&str> = it.dims.iter().map(String::as_str).collect();
            let about = about(quantity.unit(), quantity.description());
            let name = quantity.name();
            let array = self.numbers(name, &dims, &it.shape, swept.len(), &it.values, about)?;
            arrays.insert(name.into(), array);
        }
        let mut about = Map::new();
        let text = "what went wrong; empty where nothing did";
        about.insert("long_name".into(), text.into());
        let errors = self.texts("error", &swept, &stacked.shape, &stacked.errors, about)?;
        arrays.insert("error".into(), errors);
        Ok(arrays)
    }

    fn coordinate(
        &self,
        name: &str,
        values: &Coordinate,
        about: Map<String, Value>,
    ) -> Result<Value, Fault> {
        let shape = [values.len()];
        match values {
            Coordinate::Numbers(numbers) => self.numbers(name, &[name], &shape, 1, numbers, about),
            Coordinate::Texts(texts) => self.texts(name, &[name], &shape, texts, about),
            Coordinate::Whole(numbers) => {
                let array = self.array(
                    name,
                    &[name],
                    &shape,
                    &shape,
                    &data_type::int64(),
                    0_i64,
                    about,
                )?;
                if !numbers.is_empty() {
                    array.store_chunk_opt(&[0], numbers.as_slice(), &every_chunk())?;
                }
                finish(&array)
            }
        }
    }

    fn texts(
        &self,
        name: &str,
        dims: &[&str],
        shape: &[usize],
        texts: &[String],
        about: Map<String, Value>,
    ) -> Result<Value, Fault> {
        let array = self.array(name, dims, shape, shape, &data_type::string(), "", about)?;
        if !texts.is_empty() {
            array.store_chunk_opt(&vec![0; shape.len()], texts.to_vec(), &every_chunk())?;
        }
        finish(&array)
    }

    /// `outer` is the number of swept dimensions among `dims`.
    fn numbers(
        &self,
        name: &str,
        dims: &[&str],
        shape: &[usize],
        outer: usize,
        numbers: &[f64],
        about: Map<String, Value>,
    ) -> Result<Value, Fault> {
        let mut chunk = shape.to_vec();
        if numbers.len() > NUMBERS_PER_CHUNK {
            // One variant after the other, and long ones in stretches of time.
            chunk[..outer].fill(1);
            let sample: usize = chunk[outer..].iter().skip(1).product();
            if let Some(time) = chunk.get_mut(outer) {
                *time = (NUMBERS_PER_CHUNK / sample.max(1)).clamp(1, (*time).max(1));
            }
        }
        let fill = f64::NAN;
        let array = self.array(
            name,
            dims,
            shape,
            &chunk,
            &data_type::float64(),
            fill,
            about,
        )?;
        if !numbers.is_empty() {
            array.store_array_subset_opt(&array.subset_all(), numbers, &every_chunk())?;
        }
        finish(&array)
    }

    #[expect(clippy::too_many_arguments, reason = "all that an array is")]
    fn array(
        &self,
        name: &str,
        dims: &[&str],
        shape: &[usize],
        chunk: &[usize],
        kind: &DataType,
        fill: impl Into<ArrayBuilderFillValue>,
        about: Map<String, Value>,
    ) -> Result<StoredArray, Fault> {
        let shape: Vec<u64> = shape.iter().map(|&size| size as u64).collect();
        let chunk: Vec<u64> = chunk.iter().map(|&size| size.max(1) as u64).collect();
        let array = ArrayBuilder::new(shape, chunk, kind.clone(), fill)
            .dimension_names(Some(dims.iter().copied()))
            .attributes(about)
            .bytes_to_bytes_codecs(vec![Arc::new(ZstdCodec::new(ZSTD_LEVEL, true))])
            .build(self.store.storage().clone(), &format!("/{name}"))?;
        Ok(array)
    }
}

/// Chunks of nothing but NaN are written as well, over what was there before.
fn every_chunk() -> CodecOptions {
    CodecOptions::default().with_store_empty_chunks(true)
}

fn finish(array: &StoredArray) -> Result<Value, Fault> {
    store_metadata(array)?;
    metadata(array)
}

fn attributes(
    sweep: &Sweep,
    stacked: &Stacked,
    outcomes: &[Outcome],
    ending: &Ending,
) -> Map<String, Value> {
    let count = |of: fn(&Outcome) -> bool| outcomes.iter().filter(|it| of(it)).count() as u64;
    let scene = sweep.scene();
    let mut story = Story(Map::new());
    story.text("title", scene.title());
    story.text("format", FORMAT);
    story.text("chaindrive_version", env!("CARGO_PKG_VERSION"));
    story.text("status", ending.status());
    story.count("complete", u64::from(*ending == Ending::Complete));
    if let Ending::Failed(reason) = ending {
        story.text("failure", reason);
    }
    story.text("scene_name", scene.name());
    story.text("scene", scene.text());
    story.text("method", &stacked.methods.join(", "));
    story.list("swept", sweep.dimensions().iter().map(|d| d.path.as_str()));
    story.count("variants", sweep.len() as u64);
    story.count("finished", count(|it| matches!(it, Outcome::Done(_))));
    story.count("failed", count(|it| matches!(it, Outcome::Failed(_))));
    story.0
}
