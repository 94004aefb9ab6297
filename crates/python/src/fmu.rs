//! Functional mock-up units.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

use chaindrive::record::Existing;
use chaindrive::{NewFile, Request};
use chaindrive_couple::{Export, LIBRARY, Model, Standard, package, read_library};
use pyo3::prelude::*;

use crate::drive::Drive;
use crate::errors::{IntoException, OrRaise, parameter};
use crate::run::{Setting, merged};
use crate::signals::Interpreter;

/// Writes a unit of a drive; Ctrl-C leaves what was there.
#[pyfunction]
#[pyo3(signature = (drive, settings, *, path, name, version, run, library, overwrite, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub(crate) fn fmu(
    py: Python<'_>,
    drive: &Drive,
    settings: Vec<(String, Setting)>,
    path: PathBuf,
    name: &str,
    version: u32,
    run: bool,
    library: PathBuf,
    overwrite: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<()> {
    let standard = Standard::of(version).ok_or_else(|| {
        let message = format!("FMI {version}: there are 2 and 3");
        parameter(message, "fmi", "2 or 3")
    })?;
    let request = Request::new(&drive.scene, &merged(settings)).or_raise()?;
    let place = NewFile::at(&path, Existing::overwriting(overwrite)).or_raise()?;
    let library = read_library(&library).or_raise()?;
    let mut export = Export::new(&request, name);
    let (written, raised) = py.detach(|| {
        let interpreter = Interpreter::new(progress.as_ref());
        let told = if run {
            export.tell_run(&request, &interpreter)
        } else {
            Ok(())
        };
        let written = told.map_err(IntoException::exception).and_then(|()| {
            let model = Model::new(export).map_err(IntoException::exception)?;
            let unit = package(&model, standard, &library);
            let unit = unit.map_err(IntoException::exception)?;
            place.write(&unit).map_err(IntoException::exception)
        });
        (written, interpreter.raised.into_inner())
    });
    match raised {
        Some(raised) => Err(raised),
        None => written,
    }
}

/// Name of the library of units, which lies in the folder of the package.
#[pyfunction]
pub(crate) fn fmu_library() -> String {
    format!("{DLL_PREFIX}{LIBRARY}{DLL_SUFFIX}")
}
