//! Errors of the library as exceptions of `chaindrive.errors`.

use std::path::Path;

use chaindrive::record::{ReadError, ResumeError, WriteError};
use chaindrive::scene::SceneError;
use chaindrive::sweep::SweepError;
use chaindrive::{ProgramError, RequestError, RunError, SealError, SimulationError, SnapshotError};
use chaindrive_contact::ParameterError;
use chaindrive_couple::{ModelError, PackageError};
use chaindrive_geometry::GeometryError;
use chaindrive_integrate::IntegrationError;
use chaindrive_mechanics::AssemblyError;
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::panic::PanicException;
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyTuple};

/// The exception classes; their rust names would clash with those of the errors.
mod python {
    pyo3::import_exception!(chaindrive.errors, AssemblyError);
    pyo3::import_exception!(chaindrive.errors, ChaindriveError);
    pyo3::import_exception!(chaindrive.errors, IntegrationError);
    pyo3::import_exception!(chaindrive.errors, ParameterError);
    pyo3::import_exception!(chaindrive.errors, ProgramError);
    pyo3::import_exception!(chaindrive.errors, ResumeError);
    pyo3::import_exception!(chaindrive.errors, SceneError);
    pyo3::import_exception!(chaindrive.errors, SimulationError);
    pyo3::import_exception!(chaindrive.errors, WriteError);
}

/// Errors that become Python exceptions.
pub(crate) trait IntoException {
    /// The exception, with the place and the hint where they are known.
    fn exception(self) -> PyErr;
}

/// `result.or_raise()?` in functions called by Python.
pub(crate) trait OrRaise<T> {
    /// The value, or the error as an exception.
    fn or_raise(self) -> Result<T, PyErr>;
}

impl<T, E: IntoException> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> Result<T, PyErr> {
        self.map_err(IntoException::exception)
    }
}

impl IntoException for SceneError {
    fn exception(self) -> PyErr {
        let message = format!("{self:#}");
        let problems: Vec<_> = self
            .problems
            .into_iter()
            .map(|problem| {
                let line = problem.place.map(|place| place.line);
                let column = problem.place.and_then(|place| place.columns);
                let column = column.map(|[first, _]| first);
                (problem.path, line, problem.message, problem.hint, column)
            })
            .collect();
        python::SceneError::new_err((message, problems, self.source_name))
    }
}

/// Has every panic reach Python as an error of the package. PyO3 makes an exception of its own of it, which ends the interpreter; here
/// the class of that exception makes ours instead, so that no call can be forgotten.
pub(crate) fn net_panics(py: Python<'_>) -> PyResult<()> {
    chaindrive::catch_everywhere();
    let make = |given: &Bound<'_, PyTuple>, _: Option<&Bound<'_, PyDict>>| -> PyResult<Py<PyAny>> {
        let (py, said) = (given.py(), given.get_item(1)?);
        // Python 3.11 asks again with what it was given.
        if said.is_instance_of::<python::ProgramError>() {
            return Ok(said.unbind());
        }
        let fault = ProgramError::last(&said.to_string());
        let error = python::ProgramError::new_err((fault.to_string(),));
        Ok(error.into_value(py).into_any())
    };
    let make = PyCFunction::new_closure(py, None, None, make)?;
    py.get_type::<PanicException>().setattr("__new__", make)
}

/// A simulation that is asked for something while another thread moves it.
pub(crate) fn in_another_thread() -> PyErr {
    python::SimulationError::new_err((
        "the simulation is moving in another thread, or stands in a list twice",
        "simulation",
        "give every thread a simulation of its own, or wait for the other one",
    ))
}

/// A simulation in which a step came to a fault of the program.
pub(crate) fn broken() -> PyErr {
    python::SimulationError::new_err((
        "a fault of the program stopped the simulation in the middle of a step",
        "simulation",
        "begin it anew, or restore a snapshot into a new one",
    ))
}

/// Mistakes in an argument that is read as scenes are.
pub(crate) fn in_an_argument(error: SceneError) -> PyErr {
    let told: Vec<String> = error.problems.iter().map(ToString::to_string).collect();
    let first = error.problems.into_iter().next();
    let (path, hint) = first.map_or_else(Default::default, |it| (it.path, it.hint));
    python::ParameterError::new_err((told.join("\n"), path, hint))
}

impl IntoException for std::convert::Infallible {
    fn exception(self) -> PyErr {
        match self {}
    }
}

impl IntoException for ParameterError {
    fn exception(self) -> PyErr {
        parameter(self.to_string(), &self.parameter, &self.allowed)
    }
}

impl IntoException for GeometryError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::NotFinite { what, .. } => parameter(message, what, "finite"),
            Self::OutOfRange { what, allowed, .. } => parameter(message, what, allowed),
            _ => python::ParameterError::new_err((message,)),
        }
    }
}

impl IntoException for AssemblyError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Guide { guide, .. } => {
                python::AssemblyError::new_err((message, format!("guides.{guide}")))
            }
            Self::UnknownBody { known, .. } => {
                python::ParameterError::new_err((message, "name", known))
            }
            _ => python::AssemblyError::new_err((message,)),
        }
    }
}

impl IntoException for IntegrationError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Parameter {
                parameter: name,
                allowed,
                ..
            } => parameter(message, name, allowed),
            Self::StepTooLarge { limit, .. } => python::IntegrationError::new_err((
                message,
                "step",
                format!("at most {limit:.3e} s"),
            )),
            _ => python::IntegrationError::new_err((message,)),
        }
    }
}

impl IntoException for SimulationError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Assembly(error) => error.exception(),
            Self::Integration(error) => error.exception(),
            Self::Setting { name, allowed, .. } => parameter(message, name, allowed),
            Self::TooLarge { .. } => python::ParameterError::new_err((
                message,
                "every",
                "record fewer channels, or give `output`",
            )),
            Self::Implicit { works, .. } => {
                parameter(message, "method", &format!("one of {works}"))
            }
            Self::UnknownName { setting, known, .. } => {
                parameter(message, setting, &format!("one of {known}"))
            }
            Self::RunIn { .. } => parameter(
                message,
                "run_in",
                "a time, turns of a sprocket that turns, or \"auto\"",
            ),
            Self::Conflict { given } => python::ParameterError::new_err((
                message,
                "accuracy",
                format!("leave out `accuracy` or `{given}`"),
            )),
            Self::Ended { reached, .. } => {
                parameter(message, "until", &format!("{reached} s or later"))
            }
            Self::Past { read, .. } => parameter(message, "time", &format!("{read} s or later")),
            Self::Control { name, .. } => python::ParameterError::new_err((message, name)),
            Self::AbsentChannel { .. } => python::ParameterError::new_err((
                message,
                "record",
                "take a chain of rigid links, or leave the channel out",
            )),
            Self::UnknownChannel { suggestion, .. } => python::ParameterError::new_err((
                message,
                "record",
                suggestion.map(|name| format!("did you mean `{name}`?")),
            )),
            _ => python::SimulationError::new_err((message,)),
        }
    }
}

impl IntoException for RequestError {
    fn exception(self) -> PyErr {
        match self {
            Self::Scene(error) => error.exception(),
            Self::Setting(error) => error.exception(),
            other => python::ParameterError::new_err((other.to_string(),)),
        }
    }
}

impl<E: IntoException + std::error::Error> IntoException for RunError<E> {
    fn exception(self) -> PyErr {
        match self {
            Self::Scene(error) => error.exception(),
            Self::Start(error) => error.exception(),
            Self::Sink(error) => error.exception(),
            Self::Snapshot(error) => error.exception(),
            Self::Interrupted => SimulationError::Interrupted.exception(),
        }
    }
}

impl IntoException for SealError {
    fn exception(self) -> PyErr {
        python::ParameterError::new_err((self.to_string(), "data"))
    }
}

impl IntoException for SnapshotError {
    fn exception(self) -> PyErr {
        python::ParameterError::new_err((
            self.to_string(),
            "snapshot",
            "one of the same drive, method, step and interval",
        ))
    }
}

impl IntoException for ResumeError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Store(error) => error.exception(),
            Self::Until { source, .. } => source.exception(),
            Self::Complete { path, .. } => {
                python::ResumeError::new_err((message, path, "a later `until`"))
            }
            Self::NoCheckpoint { path, .. }
            | Self::Checkpoint { path, .. }
            | Self::OtherScene { path } => python::ResumeError::new_err((message, path)),
            _ => python::ResumeError::new_err((message,)),
        }
    }
}

impl IntoException for SweepError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Scene(error) => error.exception(),
            Self::Channel(error) => error.exception(),
            Self::Write(error) => error.exception(),
            Self::Origin { .. } => python::SimulationError::new_err((message, "executor")),
            Self::Nothing | Self::TooMany { .. } => {
                python::ParameterError::new_err((message, "vary"))
            }
            Self::Empty { path }
            | Self::Twice { path }
            | Self::Repeated { path, .. }
            | Self::Covered { path, .. }
            | Self::Chosen { path }
            | Self::Intervals { path }
            | Self::Range { path, .. } => python::ParameterError::new_err((message, path)),
            Self::Given { given, .. } => {
                python::ParameterError::new_err((message, given, "give one of them"))
            }
            Self::Threads { .. } => python::ParameterError::new_err((message, "jobs")),
            _ => python::ParameterError::new_err((message,)),
        }
    }
}

impl IntoException for ReadError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Missing { .. } => PyFileNotFoundError::new_err(message),
            Self::Claim(error) => error.exception(),
            _ => PyValueError::new_err(message),
        }
    }
}

impl IntoException for WriteError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Exists { path } | Self::FileExists { path } => python::WriteError::new_err((
                message,
                path,
                "give `overwrite=True`, or another name",
            )),
            Self::Name { path } => {
                python::WriteError::new_err((message, path, "a name that ends in .zarr"))
            }
            Self::Busy { path, .. } => python::WriteError::new_err((
                message,
                path,
                "stop that process or wait for its end, or give another name",
            )),
            Self::Strange { path, .. } => python::WriteError::new_err((
                message,
                path,
                "`chaindrive.take_over(path)`, or give another name",
            )),
            Self::Dangling { path, .. } => python::WriteError::new_err((
                message,
                path,
                "remove the link, or give another name",
            )),
            Self::Foreign { path, .. }
            | Self::Vanished { path, .. }
            | Self::GivenUp { path }
            | Self::Io { path, .. }
            | Self::Store { path, .. } => python::WriteError::new_err((message, path)),
            _ => python::WriteError::new_err((message,)),
        }
    }
}

impl IntoException for ModelError {
    fn exception(self) -> PyErr {
        match self {
            Self::Scene(error) => error.exception(),
            Self::Request(error) => error.exception(),
            Self::Output(error) => error.exception(),
            other => python::SimulationError::new_err((other.to_string(),)),
        }
    }
}

impl IntoException for PackageError {
    fn exception(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Library { .. } => python::ParameterError::new_err((
                message,
                "library",
                "must be the library of units of this build",
            )),
            _ => python::WriteError::new_err((message,)),
        }
    }
}

/// Whether an exception is one of `chaindrive.errors`.
pub(crate) fn is_ours(py: Python<'_>, raised: &PyErr) -> bool {
    raised.is_instance_of::<python::ChaindriveError>(py)
}

/// A `WriteError` of a place, for what a library of others said.
pub(crate) fn refused(path: &Path, reason: &str) -> PyErr {
    python::WriteError::new_err((format!("{}: {reason}", path.display()), path.to_owned()))
}

/// A `ParameterError` that names the parameter and what it may be.
pub(crate) fn parameter(message: String, name: &str, allowed: &str) -> PyErr {
    python::ParameterError::new_err((message, name.to_owned(), format!("must be {allowed}")))
}
