//! One array of a result: filled sample by sample, written chunk by chunk.

use chaindrive_mechanics::System;
use serde_json::{Map, Value};
use zarrs::array::CodecOptions;
use zarrs::array::codec::ZstdCodec;
use zarrs::array::{Array, ArrayBuilder, ArrayMetadataOptions, data_type};

use super::fault::Fault;
use super::files::{Ground, Storage};
use crate::channel::{Axis, labels};

/// An array of the store.
pub(crate) type StoredArray = Array<Ground>;

/// Numbers in a chunk, 1 MiB of them, and samples at most.
const NUMBERS_PER_CHUNK: usize = 1 << 17;
const SAMPLES_PER_CHUNK: usize = 1 << 14;

/// Level of the compression: what is zero or constant shrinks at any level, the rest at none. Level 3 takes twice the time for stores that are
/// 0.04 % smaller.
pub(crate) const ZSTD_LEVEL: i32 = 1;

/// Samples in a chunk of every array of a run, by the width of the widest: `dask` wants the arrays of a
/// dataset to be cut at the same times.
pub(crate) fn samples_per_chunk(width: usize) -> usize {
    (NUMBERS_PER_CHUNK / width.max(1)).clamp(1, SAMPLES_PER_CHUNK)
}

/// An array that grows with time.
pub(crate) struct Track {
    pub(crate) name: &'static str,
    array: StoredArray,
    /// Entries a sample.
    width: usize,
    /// Samples a chunk.
    samples: usize,
    /// Index of the chunk in work, and its samples so far.
    chunk: u64,
    pending: Vec<f64>,
    /// Numbers of the chunk in work that are in the store.
    stored: usize,
}

impl Track {
    pub(crate) fn new(
        storage: &Storage,
        name: &'static str,
        axis: Axis,
        system: &System,
        samples: usize,
        attributes: Map<String, Value>,
    ) -> Result<Self, Fault> {
        let labels = labels(axis, system);
        let width = labels.as_ref().map_or(1, Vec::len);
        let mut shape = vec![0];
        let mut chunk = vec![samples as u64];
        if labels.is_some() {
            shape.push(width as u64);
            chunk.push(width.max(1) as u64);
        }
        let dimensions = ["time"].into_iter().chain(axis.name());
        let array = ArrayBuilder::new(shape, chunk, data_type::float64(), f64::NAN)
            .dimension_names(Some(dimensions))
            .attributes(attributes)
            .bytes_to_bytes_codecs(vec![std::sync::Arc::new(ZstdCodec::new(ZSTD_LEVEL, true))])
            .build(storage.clone(), &format!("/{name}"))?;
        Ok(Self {
            name,
            array,
            width,
            samples,
            chunk: 0,
            pending: Vec::new(),
            stored: 0,
        })
    }

    /// Goes on after the samples that are in the store; what there is more of them is forgotten.
    pub(crate) fn go_on(&mut self, samples: u64) -> Result<(), Fault> {
        self.set_length(samples)?;
        self.chunk = samples / self.samples as u64;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "less than the samples of a chunk"
        )]
        let held = (samples % self.samples as u64) as usize * self.width;
        if held > 0 {
            let stored: Vec<f64> = self.array.retrieve_chunk(&self.place())?;
            let kept = stored.get(..held).ok_or_else(|| Fault::Short {
                name: self.name.to_owned(),
            })?;
            self.pending.extend_from_slice(kept);
        }
        self.stored = held;
        Ok(())
    }

    /// The last chunk in use.
    pub(crate) fn last_chunk(&self) -> u64 {
        self.chunk
    }

    fn place(&self) -> Vec<u64> {
        let mut place = vec![self.chunk];
        if self.array.dimensionality() > 1 {
            place.push(0);
        }
        place
    }

    /// Takes one sample, written by `read`; stores the chunk when it is full.
    pub(crate) fn push(&mut self, read: impl FnOnce(&mut Vec<f64>)) -> Result<(), Fault> {
        read(&mut self.pending);
        if self.width > 0 && self.pending.len() >= self.samples * self.width {
            self.store()?;
            self.pending.clear();
            self.stored = 0;
            self.chunk += 1;
        }
        Ok(())
    }

    /// Stores the chunk in work, filled up with NaN.
    pub(crate) fn store(&mut self) -> Result<(), Fault> {
        let held = self.pending.len();
        if held == self.stored {
            return Ok(());
        }
        let place = self.place();
        self.pending.resize(self.samples * self.width, f64::NAN);
        // A chunk of nothing but NaN is stored as well: the readers need not know why it is missing.
        let options = CodecOptions::default().with_store_empty_chunks(true);
        let stored = self
            .array
            .store_chunk_opt(&place, self.pending.as_slice(), &options);
        self.pending.truncate(held);
        stored?;
        self.stored = held;
        Ok(())
    }

    /// Adds an attribute; takes effect with the metadata.
    pub(crate) fn tell(&mut self, name: &str, value: Value) {
        self.array.attributes_mut().insert(name.into(), value);
    }

    /// Makes the array as long as there are samples; takes effect with its metadata.
    pub(crate) fn set_length(&mut self, samples: u64) -> Result<(), Fault> {
        let mut shape = self.array.shape().to_vec();
        shape[0] = samples;
        self.array.set_shape(shape)?;
        Ok(())
    }

    pub(crate) fn metadata(&self) -> Result<Value, Fault> {
        metadata(&self.array)
    }

    pub(crate) fn store_metadata(&self) -> Result<(), Fault> {
        store_metadata(&self.array)
    }
}

/// Writes the labels of an axis, which do not change, and returns the array's metadata.
pub(crate) fn store_labels(
    storage: &Storage,
    name: &'static str,
    axis: Axis,
    labels: &[String],
) -> Result<Value, Fault> {
    store_along(storage, name, name, labels, axis.is_numbered())
}

/// Writes the names of the chains that the entries of an axis belong to, and returns the array's metadata.
pub(crate) fn store_chains(
    storage: &Storage,
    name: &'static str,
    along: &'static str,
    chains: &[String],
) -> Result<Value, Fault> {
    store_along(storage, name, along, chains, false)
}

fn store_along(
    storage: &Storage,
    name: &'static str,
    along: &'static str,
    labels: &[String],
    numbers: bool,
) -> Result<Value, Fault> {
    let count = labels.len() as u64;
    let (shape, chunk) = (vec![count], vec![count.max(1)]);
    let mut builder = if numbers {
        ArrayBuilder::new(shape, chunk, data_type::int64(), 0_i64)
    } else {
        ArrayBuilder::new(shape, chunk, data_type::string(), "")
    };
    let array = builder
        .dimension_names(Some([along]))
        .build(storage.clone(), &format!("/{name}"))?;
    if count > 0 {
        let options = CodecOptions::default().with_store_empty_chunks(true);
        if numbers {
            let numbers: Vec<i64> = (0..).take(labels.len()).collect();
            array.store_chunk_opt(&[0], numbers, &options)?;
        } else {
            array.store_chunk_opt(&[0], labels.to_vec(), &options)?;
        }
    }
    store_metadata(&array)?;
    metadata(&array)
}

fn plain() -> ArrayMetadataOptions {
    ArrayMetadataOptions::default().with_include_zarrs_metadata(false)
}

pub(crate) fn metadata(array: &StoredArray) -> Result<Value, Fault> {
    Ok(serde_json::to_value(array.metadata_opt(&plain()))?)
}

pub(crate) fn store_metadata(array: &StoredArray) -> Result<(), Fault> {
    Ok(array.store_metadata_opt(&plain())?)
}
