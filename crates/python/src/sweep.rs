//! Sweeps: without the interpreter's lock, stopped by Ctrl-C, with outcomes that travel between processes.

mod objects;
mod stored;

use std::time::Instant;

use chaindrive::sweep::{
    self, Account, Arrangement, Coordinate, Entry, Go, Outcome, Progress, Quantity,
};
use chaindrive::verdict::WrittenVerdict;
use chaindrive::{Request, Scene};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::{OrRaise, parameter};
use crate::run::{Setting, merged};
use crate::signals::{PATIENCE, look};
pub(crate) use stored::{SweepStore, SweepWorker};

/// Variants of a scene.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Sweep(sweep::Sweep);

/// An outcome in types that Python can pickle, bit by bit: what went wrong, or the method, sample times,
/// labels, entries with their units, and verdict.
#[derive(IntoPyObject, FromPyObject)]
struct Parts<'py>(
    Option<String>,
    String,
    Bound<'py, PyArray1<f64>>,
    Vec<(String, Vec<String>)>,
    Vec<(String, String, Bound<'py, PyArray1<f64>>)>,
    (String, String, String),
);

#[pymethods]
impl Sweep {
    /// Paths with their values as JSON, put into the scene of a text, in every combination or as the columns of a table; `given` are
    /// settings of the runs, which go before those of the scene as they do in a run.
    #[new]
    #[pyo3(signature = (text, name, vary, record, table=false, given=Vec::new()))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        vary: Vec<(String, Vec<String>)>,
        record: Vec<String>,
        table: bool,
        given: Vec<(String, Setting)>,
    ) -> PyResult<Self> {
        let mut settings = Vec::new();
        for (path, values) in vary {
            let values = values.iter().map(|json| match serde_json::from_str(json) {
                Ok(value) => Ok(sweep::Setting::Json(value)),
                Err(error) => {
                    let message = format!("{path}: {error}");
                    Err(parameter(message, &path, "a value of JSON"))
                }
            });
            let values = values.collect::<PyResult<_>>()?;
            settings.push((path, values));
        }
        let scene = Scene::from_text(text, name).or_raise()?;
        let names: Vec<(String, String)> = given
            .iter()
            .map(|(key, _)| (format!("run.{key}"), key.clone()))
            .collect();
        let scene = Request::new(&scene, &merged(given)).or_raise()?.scene;
        let sweep = py.detach(|| {
            if table {
                sweep::Sweep::of_table(&scene, &settings, &record)
            } else {
                sweep::Sweep::new(&scene, &settings, &record)
            }
        });
        let sweep = sweep.or_raise()?;
        sweep.check_given(&names).or_raise()?;
        Ok(Self(sweep))
    }

    /// Text of the scene that is varied, settings included.
    #[getter]
    fn text(&self) -> &str {
        self.0.scene().text()
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Runs all variants and stacks them. An interrupt by the user is not raised: it is the entry `stop` of the
    /// answer, and what it left undone is open.
    fn run<'py>(
        &self,
        py: Python<'py>,
        jobs: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (outcomes, raised) =
            py.detach(|| self.carry_out(0, self.0.len(), jobs, progress.as_ref()))?;
        let answer = self.stacked(py, &outcomes)?;
        match raised {
            None => answer.set_item("stop", py.None())?,
            Some(stop) if stop.is_instance_of::<PyKeyboardInterrupt>(py) => {
                answer.set_item("stop", stop)?;
            }
            Some(error) => return Err(error),
        }
        Ok(answer)
    }

    /// Runs the variants from `first` to before `end` on one thread, and returns their outcomes.
    fn part<'py>(&self, py: Python<'py>, first: usize, end: usize) -> PyResult<Vec<Parts<'py>>> {
        let (outcomes, raised) = py.detach(|| self.carry_out(first, end, Some(1), None))?;
        raised.map_or(Ok(()), Err)?;
        let parts = outcomes.into_iter().map(|outcome| parts(py, outcome));
        Ok(parts.collect())
    }

    /// Stacks the outcomes of all variants; None for those that were not carried out.
    fn stack<'py>(
        &self,
        py: Python<'py>,
        outcomes: Vec<Option<Parts<'py>>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let outcomes = outcomes
            .into_iter()
            .map(|parts| parts.map_or(Ok(Outcome::Open), whole));
        let outcomes: Vec<Outcome> = outcomes.collect::<PyResult<_>>()?;
        if outcomes.len() != self.0.len() {
            return Err(PyValueError::new_err("one outcome a variant is needed"));
        }
        self.stacked(py, &outcomes)
    }
}

impl Sweep {
    /// The outcomes so far, and what Python raised meanwhile: then some of them are open.
    fn carry_out(
        &self,
        first: usize,
        end: usize,
        jobs: Option<usize>,
        progress: Option<&Py<PyAny>>,
    ) -> PyResult<(Vec<Outcome>, Option<PyErr>)> {
        let mut raised = None;
        let mut looked = Instant::now();
        let watch = |state: Progress<'_>| {
            let all = state.outcomes.len();
            if state.finished < all && looked.elapsed() < PATIENCE {
                return Go::On;
            }
            looked = Instant::now();
            match look(progress, state.finished as f64 / all as f64) {
                Ok(()) => Go::On,
                Err(error) => {
                    raised = Some(error);
                    Go::NoFurther
                }
            }
        };
        let outcomes = self.0.run_some(first..end, jobs, watch).or_raise()?;
        Ok((outcomes, raised))
    }

    fn stacked<'py>(&self, py: Python<'py>, outcomes: &[Outcome]) -> PyResult<Bound<'py, PyDict>> {
        let stacked = py.detach(|| self.0.stack(outcomes));
        let answer = PyDict::new(py);
        answer.set_item("dims", self.0.dims())?;
        answer.set_item("table", self.0.arrangement() == Arrangement::Table)?;
        let swept = PyList::empty(py);
        for dimension in self.0.dimensions() {
            let values = coordinate(py, &dimension.values)?;
            swept.append((&dimension.name, &dimension.path, dimension.unit, values))?;
        }
        answer.set_item("swept", swept)?;
        let time = stacked.time.map(|time| PyArray1::from_vec(py, time));
        answer.set_item("time", time)?;
        let labels = PyDict::new(py);
        for (name, values) in &stacked.labels {
            labels.set_item(name, coordinate(py, values)?)?;
        }
        answer.set_item("labels", labels)?;
        let quantities = PyList::empty(py);
        for it in stacked.quantities {
            let values = PyArray1::from_vec(py, it.values).reshape(it.shape)?;
            let quantity = it.quantity;
            let text = quantity.description();
            quantities.append((quantity.name(), it.dims, values, it.unit, text))?;
        }
        answer.set_item("quantities", quantities)?;
        let texts = stacked.texts.into_iter();
        let texts = texts.map(|it| (it.name, it.texts, it.description));
        answer.set_item("texts", PyList::new(py, texts.collect::<Vec<_>>())?)?;
        let count = |of: fn(&Outcome) -> bool| outcomes.iter().filter(|it| of(it)).count();
        answer.set_item("finished", count(|it| matches!(it, Outcome::Done(_))))?;
        answer.set_item("failed", count(|it| matches!(it, Outcome::Failed(_))))?;
        let distrusts =
            |it: &Outcome| matches!(it, Outcome::Done(done) if done.verdict.is_distrusted());
        answer.set_item("distrusted", count(distrusts))?;
        answer.set_item("warning", self.0.warning(outcomes))?;
        answer.set_item("methods", stacked.methods)?;
        answer.set_item("summary", self.0.report(outcomes).to_string())?;
        Ok(answer)
    }
}

/// Numbers as an array, texts as a list.
fn coordinate<'py>(py: Python<'py>, values: &Coordinate) -> PyResult<Bound<'py, PyAny>> {
    Ok(match values {
        Coordinate::Numbers(numbers) => PyArray1::from_slice(py, numbers).into_any(),
        Coordinate::Whole(numbers) => PyArray1::from_slice(py, numbers).into_any(),
        Coordinate::Texts(texts) => PyList::new(py, texts)?.into_any(),
    })
}

fn parts(py: Python<'_>, outcome: Outcome) -> Parts<'_> {
    let (error, account) = match outcome {
        Outcome::Done(account) => (None, account),
        Outcome::Failed(message) => (Some(message), Account::default()),
        Outcome::Open => (Some("stopped".to_owned()), Account::default()),
    };
    let entries = account.entries.into_iter().map(|it| {
        let name = it.quantity.name().to_owned();
        (name, it.unit, PyArray1::from_vec(py, it.values))
    });
    let verdict = account.verdict;
    Parts(
        error,
        account.method,
        PyArray1::from_vec(py, account.time),
        account.labels,
        entries.collect(),
        (verdict.verdict, verdict.reasons, verdict.note),
    )
}

fn whole(parts: Parts<'_>) -> PyResult<Outcome> {
    let Parts(error, method, time, labels, entries, verdict) = parts;
    if let Some(message) = error {
        return Ok(Outcome::Failed(message));
    }
    let numbers = |array: &Bound<'_, PyArray1<f64>>| -> PyResult<Vec<f64>> {
        let array: PyReadonlyArray1<'_, f64> = array.try_readonly()?;
        Ok(array.as_slice()?.to_vec())
    };
    let entries = entries.into_iter().map(|(name, unit, values)| {
        let quantity = Quantity::from_name(&name);
        let quantity = quantity
            .ok_or_else(|| PyValueError::new_err(format!("no quantity is named `{name}`")))?;
        Ok(Entry {
            quantity,
            unit,
            values: numbers(&values)?,
        })
    });
    let (verdict, reasons, note) = verdict;
    Ok(Outcome::Done(Account {
        method,
        time: numbers(&time)?,
        labels,
        entries: entries.collect::<PyResult<_>>()?,
        verdict: WrittenVerdict {
            verdict,
            reasons,
            note,
        },
    }))
}
