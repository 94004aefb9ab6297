//! Stores read back: the attributes, and every n-th sample of some channels.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Map, Value};
use zarrs::array::{ArrayMetadata, FromArrayBytes};

use crate::event::EventColumn;
use crate::one_line;
use crate::record::{LoggedContact, RecordedChannel, RecordedRun};
use crate::zarr::{
    self, Fault, Folder, Ground, Storage, StoredArray, WriteError, is_being_written,
};

/// Why a store cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum ReadError {
    /// Nothing is there.
    #[error("{}: there is nothing of this name; check the path", .path.display())]
    Missing { path: PathBuf },

    /// It is something else.
    #[error("{}: this is not a result of chaindrive; give the Zarr store of a run", .path.display())]
    Foreign { path: PathBuf },

    /// It holds many runs, of which no samples are kept one by one.
    #[error("{}: this is the result of a sweep; give that of a run", .path.display())]
    Sweep { path: PathBuf },

    /// It is not as this program writes it, and nobody should read it.
    #[error("{}: {why}; chaindrive writes no such result, and does not read it", .path.display())]
    Suspect { path: PathBuf, why: String },

    /// The arrays that it names cannot be read.
    #[error("{}: {source}", .path.display())]
    Store {
        path: PathBuf,
        source: Box<dyn std::error::Error + Send + Sync>,
    },

    /// It cannot be told whether somebody writes it.
    #[error(transparent)]
    Claim(#[from] WriteError),
}

/// Looks at a store of unknown origin before its arrays are read, by whatever reader: it leads nowhere else, is of Zarr format 3, is packed by codecs
/// that this program uses, and holds what it declares and no more.
///
/// # Errors
/// [`ReadError`]: nothing is there, it is no result, or it is not as this program writes results.
pub fn inspect(path: &Path) -> Result<(), ReadError> {
    if !path.exists() {
        return Err(ReadError::Missing { path: path.into() });
    }
    let group = zarr::group(path, path);
    let group = group.map_err(|_| ReadError::Foreign { path: path.into() })?;
    looked_at(path, &group)
}

fn looked_at(path: &Path, group: &Value) -> Result<(), ReadError> {
    zarr::inspect(path, group).map_err(|why| ReadError::Suspect {
        path: path.into(),
        why,
    })
}

impl RecordedRun {
    /// Reads a store: the channels whose names are `wanted`, at most `most` samples of them, and the contacts.
    ///
    /// A store that says `running`, and that nobody writes, has the status `killed`.
    ///
    /// # Errors
    /// [`ReadError`]: it is no result of a run, or it cannot be read.
    pub fn open(
        path: &Path,
        wanted: &dyn Fn(&str) -> bool,
        most: usize,
    ) -> Result<Self, ReadError> {
        if !path.exists() {
            return Err(ReadError::Missing { path: path.into() });
        }
        let foreign = |_| ReadError::Foreign { path: path.into() };
        let mut group = zarr::group(path, path).map_err(foreign)?;
        // A writer says how it ended before it gives its claim back: looked at again, a result that nobody writes has
        // ended, or its writer was killed.
        let mut killed = false;
        if group["attributes"]["status"] == "running" && !is_being_written(path)? {
            group = zarr::group(path, path).map_err(foreign)?;
            killed = group["attributes"]["status"] == "running";
        }
        if group["attributes"].get("samples").is_none() {
            return Err(ReadError::Sweep { path: path.into() });
        }
        looked_at(path, &group)?;
        let stored = Stored::new(path, &group).and_then(|it| it.read(wanted, most));
        let mut recorded = stored.map_err(|source| ReadError::Store {
            path: path.into(),
            source: Box::new(source),
        })?;
        if killed {
            let status = ("status".to_owned(), "killed".into());
            recorded.attributes.extend([status]);
        }
        Ok(recorded)
    }
}

/// A store as its group document described it at one moment.
struct Stored {
    storage: Storage,
    attributes: Map<String, Value>,
    /// Metadata of the arrays.
    arrays: Map<String, Value>,
}

impl Stored {
    fn new(path: &Path, group: &Value) -> Result<Self, Fault> {
        let entries = |value: &Value| value.as_object().cloned().unwrap_or_default();
        Ok(Self {
            storage: Ground::of(Arc::new(Folder::to_read(path)?)),
            attributes: entries(&group["attributes"]),
            arrays: entries(&group["consolidated_metadata"]["metadata"]),
        })
    }

    fn read(self, wanted: &dyn Fn(&str) -> bool, most: usize) -> Result<RecordedRun, Fault> {
        let samples = self.length("time");
        let stride = RecordedRun::stride(samples, most);
        let (mut names, mut channels) = (Vec::new(), Vec::new());
        for (name, about) in &self.arrays {
            let dimensions = about["dimension_names"].as_array();
            let dimensions = dimensions.map_or(&[][..], Vec::as_slice);
            let varies = dimensions.first().is_some_and(|it| it == "time");
            if !varies || name == "time" {
                continue;
            }
            names.push(one_line(name).into_owned());
            if !wanted(name) {
                continue;
            }
            let labels = match dimensions.get(1).and_then(Value::as_str) {
                Some(axis) => self.labels(axis)?,
                None => Vec::new(),
            };
            let said = |key: &str| about["attributes"][key].as_str().unwrap_or("");
            let said = |key: &str| one_line(said(key)).into_owned();
            channels.push(RecordedChannel {
                name: one_line(name).into_owned(),
                unit: said("units"),
                long_name: said("long_name"),
                labels,
                values: self.rows(name, stride)?,
            });
        }
        Ok(RecordedRun {
            samples,
            stride,
            time: self.rows("time", stride)?,
            names,
            channels,
            contacts: self.contacts()?,
            attributes: self.attributes,
        })
    }

    fn contacts(&self) -> Result<Option<Vec<LoggedContact>>, Fault> {
        if !self.arrays.contains_key(EventColumn::Start.name()) {
            return Ok(None);
        }
        let bodies = self.texts(EventColumn::Body.name())?;
        let rollers: Vec<i64> = self.rows(EventColumn::Roller.name(), 1)?;
        let starts: Vec<f64> = self.rows(EventColumn::Start.name(), 1)?;
        let peaks: Vec<f64> = self.rows(EventColumn::PeakForce.name(), 1)?;
        let rows = bodies.into_iter().zip(rollers).zip(starts).zip(peaks);
        let contact = |(((body, roller), start), peak_force)| LoggedContact {
            body,
            roller,
            start,
            peak_force,
        };
        Ok(Some(rows.map(contact).collect()))
    }

    /// Labels along a dimension, numbers as text.
    fn labels(&self, axis: &str) -> Result<Vec<String>, Fault> {
        if self
            .arrays
            .get(axis)
            .is_some_and(|about| about["data_type"] == "int64")
        {
            let numbers: Vec<i64> = self.rows(axis, 1)?;
            return Ok(numbers.iter().map(i64::to_string).collect());
        }
        self.texts(axis)
    }

    /// Names of whoever wrote the store, each on one line.
    fn texts(&self, name: &str) -> Result<Vec<String>, Fault> {
        let texts: Vec<String> = self.rows(name, 1)?;
        Ok(texts.iter().map(|it| one_line(it).into_owned()).collect())
    }

    fn about(&self, name: &str) -> Result<&Value, Fault> {
        self.arrays.get(name).ok_or_else(|| Fault::Short {
            name: name.to_owned(),
        })
    }

    /// Length of an array along its first dimension.
    fn length(&self, name: &str) -> usize {
        let length = self.arrays.get(name).and_then(|it| it["shape"][0].as_u64());
        length.and_then(|it| usize::try_from(it).ok()).unwrap_or(0)
    }

    /// Every n-th row of an array, read chunk by chunk: a long run need not fit the memory.
    fn rows<T>(&self, name: &str, stride: usize) -> Result<Vec<T>, Fault>
    where
        T: Clone,
        Vec<T>: FromArrayBytes,
    {
        let about = self.about(name)?;
        let metadata: ArrayMetadata = serde_json::from_value(about.clone())?;
        let array =
            StoredArray::new_with_metadata(self.storage.clone(), &format!("/{name}"), metadata)?;
        let width = array.shape().iter().skip(1).product::<u64>();
        let width = usize::try_from(width).unwrap_or(usize::MAX);
        let length = self.length(name);
        let mut kept = Vec::with_capacity(length.div_ceil(stride) * width);
        let mut first = 0;
        let mut place = vec![0; array.dimensionality()];
        while first < length && width > 0 {
            let chunk: Vec<T> = array.retrieve_chunk(&place)?;
            let rows = (chunk.len() / width).min(length - first);
            let short = || Fault::Short {
                name: name.to_owned(),
            };
            if rows == 0 {
                return Err(short());
            }
            let begin = first.next_multiple_of(stride) - first;
            for row in (begin..rows).step_by(stride) {
                kept.extend_from_slice(&chunk[row * width..(row + 1) * width]);
            }
            first += rows;
            place[0] += 1;
        }
        Ok(kept)
    }
}
