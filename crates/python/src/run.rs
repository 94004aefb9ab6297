//! Runs: without the interpreter's lock, stopped by Ctrl-C, results handed over without a copy.

use std::borrow::Cow;
use std::path::PathBuf;

use chaindrive::channel;
use chaindrive::record::{self, EventColumn, EventTable, Existing, StoppedRun, ZarrSink};
use chaindrive::{
    Axis, Channel, EventKinds, Memory, Report, Request, SettingValue, Settings, Simulation,
    Stepping, Stop, execute,
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::drive::Drive;
use crate::errors::{IntoException, OrRaise, parameter};
use crate::signals::Interpreter;

/// Runs a drive and returns its recording: time, columns, labels and attributes.
///
/// Ctrl-C under way is not raised: it is the entry `stop` of the answer, beside what there is.
#[pyfunction]
#[pyo3(signature = (drive, settings, *, output, overwrite, checkpoint_every, error, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    drive: &Drive,
    settings: Vec<(String, Setting)>,
    output: Option<PathBuf>,
    overwrite: bool,
    checkpoint_every: Option<Setting>,
    error: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut request = Request::new(&drive.scene, &merged(settings)).or_raise()?;
    if let Some(every) = checkpoint_every {
        request = request.with_checkpoints(&every.into()).or_raise()?;
    }
    if !error {
        request = request.without_estimate();
    }
    let mut memory = Memory::default();
    let (report, raised) = py.detach(|| {
        let interpreter = Interpreter::new(progress.as_ref());
        let report = match output {
            None => execute(&request, &mut memory, &interpreter).map_err(IntoException::exception),
            Some(path) => {
                let existing = Existing::overwriting(overwrite);
                let mut store = ZarrSink::new(path, existing);
                execute(&request, &mut store, &interpreter).map_err(IntoException::exception)
            }
        };
        (report, interpreter.raised.into_inner())
    });
    answer(py, report, raised, memory)
}

/// Carries on the run of a result that was stopped or killed; the answer is that of `simulate` into a store.
#[pyfunction]
#[pyo3(signature = (path, *, until, progress))]
pub(crate) fn resume(
    py: Python<'_>,
    path: PathBuf,
    until: Option<Setting>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'_, PyDict>> {
    let until = until.map(SettingValue::from);
    let stopped = StoppedRun::open(&path, until.as_ref()).or_raise()?;
    let (report, raised) = py.detach(|| {
        let interpreter = Interpreter::new(progress.as_ref());
        let report = stopped.resume(&interpreter);
        let report = report.map_err(IntoException::exception);
        (report, interpreter.raised.into_inner())
    });
    answer(py, report, raised, Memory::default())
}

/// Outcome of a run.
fn answer(
    py: Python<'_>,
    report: PyResult<Report>,
    raised: Option<PyErr>,
    memory: Memory,
) -> PyResult<Bound<'_, PyDict>> {
    // Stopped before it began.
    let report = match (report, &raised) {
        (Err(_), Some(raised)) => return Err(raised.clone_ref(py)),
        (report, _) => report?,
    };
    if let Stop::Failed(error) = report.stop {
        return Err(error.exception());
    }
    let answer = told(py, &report, memory)?;
    answer.set_item("stop", raised)?;
    Ok(answer)
}

/// A setting as Python gives it: a text with a unit or a quantity of pint, a number in SI units, or names.
#[derive(FromPyObject)]
pub(crate) enum Setting {
    Text(#[pyo3(from_py_with = with_unit)] String),
    Number(f64),
    Names(Vec<String>),
}

fn with_unit(given: &Bound<'_, PyAny>) -> PyResult<String> {
    let quantity = given.py().import("chaindrive.quantity")?;
    quantity.call_method1("with_unit", (given,))?.extract()
}

impl From<Setting> for SettingValue {
    fn from(setting: Setting) -> Self {
        match setting {
            Setting::Text(text) => Self::Text(text),
            Setting::Number(number) => Self::Number(number),
            Setting::Names(names) => Self::Names(names),
        }
    }
}

/// Settings of Python as settings of a run.
pub(crate) fn merged(settings: Vec<(String, Setting)>) -> Settings {
    let settings = settings.into_iter();
    settings.fold(Settings::default(), |all, (key, value)| {
        all.with(&key, value.into())
    })
}

/// Outcome of a run, as Python takes it.
fn told<'py>(py: Python<'py>, report: &Report, memory: Memory) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    let recording = memory.recording;
    let recorded = recording.columns.iter().map(|column| column.channel);
    let recorded: Vec<Channel> = recorded.collect();
    answer.set_item("labels", labels(py, &recorded, &report.simulation)?)?;
    let attributes = serde_json::Value::Object(report.attributes.clone());
    answer.set_item("attributes", attributes.to_string())?;
    answer.set_item("chains", chains(py, &recorded, &report.simulation)?)?;
    let units = PyDict::new(py);
    for &channel in &recorded {
        let unit = channel.unit_attribute(report.simulation.system());
        units.set_item(channel.name(), unit)?;
    }
    answer.set_item("units", units)?;
    let horizons = PyDict::new(py);
    for &channel in &recorded {
        let judgement = report.judgement.as_ref();
        if let Some(horizon) = judgement.and_then(|judgement| judgement.horizon_of(channel)) {
            horizons.set_item(channel.name(), (horizon.at, horizon.found_on.name()))?;
        }
    }
    answer.set_item("waveform_horizons", horizons)?;
    answer.set_item("warning", report.verdict.warning())?;
    answer.set_item("caution", report.verdict.caution())?;
    let clashes = report.simulation.assembled().warnings.iter();
    let clashes: Vec<String> = clashes.map(ToString::to_string).collect();
    answer.set_item("clashes", clashes)?;
    let samples = recording.len();
    answer.set_item("time", PyArray1::from_vec(py, recording.time))?;
    let columns = PyDict::new(py);
    for column in recording.columns {
        let values = PyArray1::from_vec(py, column.values);
        let values = match column.channel.axis() {
            Axis::None => values.into_any(),
            _ => values.reshape([samples, column.width])?.into_any(),
        };
        columns.set_item(column.channel.name(), values)?;
    }
    answer.set_item("columns", columns)?;
    if report.run.events != EventKinds::default() {
        answer.set_item("events", event_columns(py, memory.events)?)?;
    }
    Ok(answer)
}

/// Name, values, unit and description of every column of the table of contacts.
fn event_columns(py: Python<'_>, contacts: EventTable) -> PyResult<Bound<'_, PyList>> {
    let columns = PyList::empty(py);
    for column in EventColumn::ALL {
        let values = match column {
            EventColumn::Kind => PyList::new(py, &contacts.kind)?.into_any(),
            EventColumn::Body => PyList::new(py, &contacts.body)?.into_any(),
            EventColumn::Roller => PyArray1::from_slice(py, &contacts.roller).into_any(),
            _ => PyArray1::from_slice(py, contacts.numbers(column).unwrap_or_default()).into_any(),
        };
        columns.append((column.name(), values, column.unit(), column.description()))?;
    }
    Ok(columns)
}

/// The method of a name.
pub(crate) fn stepping(name: &str) -> PyResult<Stepping> {
    Stepping::from_name(name).ok_or_else(|| {
        let known = Stepping::ALL.map(Stepping::name).join(", ");
        let message = format!("no method is named `{name}`; there are {known}");
        parameter(message, "method", &format!("one of {known}"))
    })
}

/// Labels of every axis that a channel uses.
fn labels<'py>(
    py: Python<'py>,
    channels: &[Channel],
    simulation: &Simulation,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    for axis in channels.iter().map(|channel| channel.axis()) {
        if let (Some(name), Some(labels)) =
            (axis.name(), channel::labels(axis, simulation.system()))
        {
            if axis.is_numbered() {
                answer.set_item(name, labels.len())?;
            } else {
                answer.set_item(name, labels)?;
            }
        }
    }
    Ok(answer)
}

/// The chain of every entry, by name, along the axes that run over several chains: coordinate, axis and names.
fn chains<'py>(
    py: Python<'py>,
    channels: &[Channel],
    simulation: &Simulation,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    for axis in channels.iter().map(|channel| channel.axis()) {
        let chains = channel::chains_along(axis, simulation.system());
        if let (Some(name), Some(along), Some(chains)) =
            (axis.chain_coordinate(), axis.name(), chains)
        {
            answer.set_item(name, (along, chains))?;
        }
    }
    Ok(answer)
}

/// Name, unit, dimension, description and whether a run records it by default, of every channel.
#[pyfunction]
pub(crate) fn channels(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    PyList::new(
        py,
        Channel::ALL.iter().map(|channel| {
            (
                channel.name(),
                channel.unit(),
                channel.axis().name(),
                channel.description(),
                Channel::DEFAULT.contains(channel),
            )
        }),
    )
}

/// Whether a running process is writing a result at `path`.
#[pyfunction]
pub(crate) fn is_being_written(path: PathBuf) -> PyResult<bool> {
    record::is_being_written(path).or_raise()
}

/// A text with its control characters spelled.
#[pyfunction]
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    chaindrive::plain(text)
}

/// The same on one line, such as a name.
#[pyfunction]
pub(crate) fn one_line(text: &str) -> Cow<'_, str> {
    chaindrive::one_line(text)
}

/// JSON with such characters as JSON spells them.
#[pyfunction]
pub(crate) fn plain_json(text: &str) -> String {
    chaindrive::plain_json(text)
}

/// A text as a cell of CSV.
#[pyfunction]
pub(crate) fn cell(text: &str) -> Cow<'_, str> {
    chaindrive::cell(text)
}

/// Removes the folder of a writer that another user left beside a result.
#[pyfunction]
pub(crate) fn take_over(path: PathBuf) -> PyResult<()> {
    record::take_over(path).or_raise()
}

/// Refuses stores of another form than this program writes.
#[pyfunction]
pub(crate) fn inspect(path: PathBuf) -> PyResult<()> {
    record::inspect(&path).or_raise()
}

/// Names of the methods of time stepping.
#[pyfunction]
pub(crate) fn methods() -> Vec<&'static str> {
    Stepping::ALL.map(Stepping::name).to_vec()
}

/// Names of those whose step follows the estimated error.
#[pyfunction]
pub(crate) fn adaptive_methods() -> Vec<&'static str> {
    let adaptive = Stepping::ALL
        .into_iter()
        .filter(|stepping| stepping.is_adaptive());
    adaptive.map(Stepping::name).collect()
}
