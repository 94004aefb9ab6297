//! Files that Python makes: beside their place, put there whole.

use std::path::PathBuf;

use chaindrive::record::{Existing, WriteError};
use chaindrive::{FilePart, NewFile as CoreFile};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::errors::{OrRaise, is_ours, refused};

/// A file to be made, in a place that was found fit for it. Folders that are missing are made, links are refused.
///
/// Bytes are written at once; as the context of a `with` it is a path to be written to, and the file is in place when that ends.
#[pyclass(module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct NewFile {
    path: PathBuf,
    existing: Existing,
    /// Until it is written or begun.
    place: Option<CoreFile>,
    part: Option<FilePart>,
}

#[pymethods]
impl NewFile {
    #[new]
    #[pyo3(signature = (path, overwrite = true))]
    fn new(path: PathBuf, overwrite: bool) -> PyResult<Self> {
        let existing = Existing::overwriting(overwrite);
        Ok(Self {
            place: Some(CoreFile::at(&path, existing).or_raise()?),
            path,
            existing,
            part: None,
        })
    }

    /// Writes the file and puts it in place.
    fn write(&mut self, py: Python<'_>, content: &[u8]) -> PyResult<()> {
        let place = self.place().or_raise()?;
        py.detach(|| place.write(content)).or_raise()
    }

    /// Path to write to.
    fn __enter__<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let part = self.place().and_then(CoreFile::begin).or_raise()?;
        // Ctrl-C is heard while Python makes a path: nobody would leave the context, and the part goes here.
        let path = part.path().into_pyobject(py)?.into_any();
        self.part = Some(part);
        Ok(path)
    }

    /// Puts the file in place, or removes what there is of it: a refusal of the system is then told with the path of the place.
    fn __exit__(
        &mut self,
        py: Python<'_>,
        _kind: &Bound<'_, PyAny>,
        raised: Option<Bound<'_, PyAny>>,
        _traceback: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let part = self.part.take();
        let Some(raised) = raised else {
            return part.map_or(Ok(()), |it| py.detach(|| it.put_in_place()).or_raise());
        };
        drop(part);
        let raised = PyErr::from_value(raised);
        if raised.is_instance_of::<PyOSError>(py) && !is_ours(py, &raised) {
            let refusal = refused(&self.path, &raised.value(py).to_string());
            refusal.set_cause(py, Some(raised));
            return Err(refusal);
        }
        Ok(())
    }
}

impl NewFile {
    /// The place, looked at again after the first file.
    fn place(&mut self) -> Result<CoreFile, WriteError> {
        match self.place.take() {
            Some(place) => Ok(place),
            None => CoreFile::at(&self.path, self.existing),
        }
    }
}
