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
        let cuts = Cuts::of(&stacked);
        let arrays = self.put(sweep, &stacked, &cuts);
        let written = arrays.map_err(|fault| self.store.fault(fault));
        let attributes = attributes(sweep, &stacked, outcomes, ending);
        let told = written.and_then(|arrays| self.store.tell(attributes, arrays, ending));
        if let Err(error) = &told {
            self.store.give_up(&error.without_path());
        }
        told
    }

    fn put(
        &self,
        sweep: &Sweep,
        stacked: &Stacked,
        cuts: &Cuts,
    ) -> Result<Map<String, Value>, Fault> {
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
            let shape = [time.len()];
            let array = self.numbers("time", &["time"], &shape, &shape, time, about("s", "time"));
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
            let about = about(&it.unit, quantity.description());
            let name = quantity.name();
            let cuts = cuts.along(&it.shape, quantity.is_sampled());
            let array = self.numbers(name, &dims, &it.shape, &cuts, &it.values, about)?;
            arrays.insert(name.into(), array);
        }
        for it in &stacked.texts {
            let mut about = Map::new();
            about.insert("long_name".into(), it.description.into());
            let shape = &stacked.shape;
            let array = self.texts(it.name, &swept, shape, &cuts.swept, &it.texts, about)?;
            arrays.insert(it.name.into(), array);
        }
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
            Coordinate::Numbers(numbers) => {
                self.numbers(name, &[name], &shape, &shape, numbers, about)
            }
            Coordinate::Texts(texts) => self.texts(name, &[name], &shape, &shape, texts, about),
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
        chunk: &[usize],
        texts: &[String],
        about: Map<String, Value>,
    ) -> Result<Value, Fault> {
        let array = self.array(name, dims, shape, chunk, &data_type::string(), "", about)?;
        if !texts.is_empty() {
            array.store_array_subset_opt(&array.subset_all(), texts.to_vec(), &every_chunk())?;
        }
        finish(&array)
    }

    fn numbers(
        &self,
        name: &str,
        dims: &[&str],
        shape: &[usize],
        chunk: &[usize],
        numbers: &[f64],
        about: Map<String, Value>,
    ) -> Result<Value, Fault> {
        let fill = f64::NAN;
        let kind = data_type::float64();
        let array = self.array(name, dims, shape, chunk, &kind, fill, about)?;
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

/// Where all arrays of a store are cut: `dask` asks that those which share a dimension are cut at the same places.
struct Cuts {
    /// Entries in a chunk along each swept dimension.
    swept: Vec<usize>,
    /// Samples in a chunk.
    samples: usize,
}

impl Cuts {
    /// As many variants in a chunk as the widest array allows; of long recordings a stretch of one variant.
    fn of(stacked: &Stacked) -> Self {
        let swept = stacked.shape.len();
        let widest = |skipped: usize, sampled: bool| {
            let quantities = stacked.quantities.iter();
            let quantities = quantities.filter(|it| !sampled || it.quantity.is_sampled());
            let sizes = quantities.map(|it| it.shape[skipped..].iter().product());
            sizes.fold(1, usize::max)
        };
        let mut left = (NUMBERS_PER_CHUNK / widest(swept, false)).max(1);
        let mut cuts = vec![1; swept];
        // The last dimension varies fastest.
        for (cut, &size) in cuts.iter_mut().zip(&stacked.shape).rev() {
            *cut = size.clamp(1, left);
            left = if *cut < size { 1 } else { left / *cut };
        }
        Self {
            swept: cuts,
            samples: NUMBERS_PER_CHUNK / widest(swept + 1, true),
        }
    }

    /// The chunk of an array with the swept dimensions first.
    fn along(&self, shape: &[usize], sampled: bool) -> Vec<usize> {
        let mut chunk = shape.to_vec();
        chunk[..self.swept.len()].copy_from_slice(&self.swept);
        if sampled {
            let time = &mut chunk[self.swept.len()];
            *time = self.samples.clamp(1, (*time).max(1));
        }
        chunk
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
    let distrusts =
        |it: &Outcome| matches!(it, Outcome::Done(done) if done.verdict.is_distrusted());
    story.count("distrusted", count(distrusts));
    story.0
}
