//! A sweep in a store that many write: every task puts its own chunk of every array in place.
//!
//! ```text
//! sweep.zarr/
//!   zarr.json          group: attributes, and the metadata of all arrays
//!   sweep.json         recipe: the scene, the values varied, the channels; never changes
//!   layout.json        layout: how the arrays are cut into tasks, and what they have beside the variants; it only grows
//!   layout.lock        held while the layout grows
//!   speed/, …          coordinates of the variants
//!   span_tension_mean/ zarr.json, and a chunk a task
//!   error/             the last chunk that a task writes: who finds it finds all others
//! ```
//!
//! In an object store there are the same files, without the lock and with an identity (`bucket.rs`).
//!
//! Recipe and layout are all that a worker needs: it gets the place of the store and the number of a task, and returns three
//! counts. What is done is read from the store itself, so it survives whoever dies. Every file is put in place whole (on a disk by
//! renaming it), so a chunk is there or not. A task whose worker died is carried out again and gives the same bits.

mod coordinator;
mod location;
mod sink;

use std::sync::Arc;

use serde_json::{Map, Value};
use zarrs::array::builder::ArrayBuilderFillValue;
use zarrs::array::codec::ZstdCodec;
use zarrs::array::{ArrayBuilder, CodecOptions, DataType, data_type};

use super::ResultQuantity;
use super::layout::Layout;
use super::texts::{MARK, blank};
use crate::zarr::{Fault, Storage, StoredArray, ZSTD_LEVEL};
pub use coordinator::SweepStore;
pub use location::StoreLocation;
pub(super) use sink::StoreSink;

/// Arrays of the store by a layout.
struct Arrays<'a> {
    storage: &'a Storage,
    layout: &'a Layout,
    /// Names of the dimensions of the sweep; none where no metadata is written.
    dims: Option<&'a [String]>,
}

impl Arrays<'_> {
    fn quantity(
        &self,
        quantity: ResultQuantity,
        about: Map<String, Value>,
    ) -> Result<StoredArray, Fault> {
        let layout = self.layout;
        let mut dims: Vec<&str> = self.swept();
        let (mut shape, mut chunk) = (layout.shape.clone(), layout.cuts.clone());
        for beside in layout.beside(quantity) {
            dims.push(beside.name);
            shape.push(beside.len);
            chunk.push(beside.cut);
        }
        let kind = data_type::float64();
        self.array(
            quantity.name(),
            &dims,
            &shape,
            &chunk,
            &kind,
            f64::NAN,
            about,
        )
    }

    fn text(&self, name: &str, about: Map<String, Value>) -> Result<StoredArray, Fault> {
        let (shape, chunk) = (&self.layout.shape, &self.layout.cuts);
        let kind = data_type::string();
        self.array(name, &self.swept(), shape, chunk, &kind, blank(name), about)
    }

    fn swept(&self) -> Vec<&str> {
        let dims = self.dims.unwrap_or_default();
        dims.iter().map(String::as_str).collect()
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
        let mut builder = ArrayBuilder::new(shape, chunk, kind.clone(), fill);
        if self.dims.is_some() {
            builder.dimension_names(Some(dims.iter().copied()));
        }
        let array = builder
            .attributes(about)
            .bytes_to_bytes_codecs(vec![Arc::new(ZstdCodec::new(ZSTD_LEVEL, true))])
            .build(self.storage.clone(), &format!("/{name}"))?;
        Ok(array)
    }
}

/// Chunks of nothing but NaN are written as well: what is there was computed.
fn every_chunk() -> CodecOptions {
    CodecOptions::default().with_store_empty_chunks(true)
}
