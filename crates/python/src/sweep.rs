//! Sweeps: the points, and results as arrays.

mod objects;
mod tasks;

use chaindrive::Request;
use chaindrive::channel::unit_attribute;
use chaindrive::sweep::{self, Arrangement, Coordinate, SweepArrays};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::drive::Drive;
use crate::errors::{OrRaise, parameter};
use crate::run::{Setting, merged};
pub(crate) use tasks::{SweepCoordinator, SweepWorker};

/// Variants of a scene.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Sweep(sweep::Sweep);

#[pymethods]
impl Sweep {
    /// Paths with their values as JSON, put into the scene of a drive, in every combination or as the columns of a table; `given` are
    /// settings of the runs, which go before those of the scene as they do in a run.
    #[new]
    fn new(
        py: Python<'_>,
        drive: PyRef<'_, Drive>,
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
        let names: Vec<(String, String)> = given
            .iter()
            .map(|(key, _)| (format!("run.{key}"), key.clone()))
            .collect();
        let scene = Request::new(&drive.scene, &merged(given)).or_raise()?.scene;
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

    fn __len__(&self) -> usize {
        self.0.len()
    }
}

/// Puts arrays into an answer, with what labels them.
fn fill(answer: &Bound<'_, PyDict>, sweep: &sweep::Sweep, stacked: SweepArrays) -> PyResult<()> {
    let py = answer.py();
    answer.set_item("dims", sweep.dims())?;
    answer.set_item("table", sweep.arrangement() == Arrangement::Table)?;
    let swept = PyList::empty(py);
    for dimension in sweep.dimensions() {
        let values = coordinate(py, &dimension.values)?;
        let unit = dimension.unit.map(|unit| (unit_attribute(unit), unit));
        swept.append((&dimension.name, &dimension.path, unit, values))?;
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
        let unit = (unit_attribute(&it.unit), &it.unit);
        quantities.append((quantity.name(), it.dims, values, unit, text))?;
    }
    answer.set_item("quantities", quantities)?;
    let texts = stacked.texts.into_iter();
    let texts = texts.map(|it| (it.name, it.texts, it.description));
    answer.set_item("texts", PyList::new(py, texts.collect::<Vec<_>>())?)
}

/// Numbers as an array, texts as a list.
fn coordinate<'py>(py: Python<'py>, values: &Coordinate) -> PyResult<Bound<'py, PyAny>> {
    Ok(match values {
        Coordinate::Numbers(numbers) => PyArray1::from_slice(py, numbers).into_any(),
        Coordinate::Whole(numbers) => PyArray1::from_slice(py, numbers).into_any(),
        Coordinate::Texts(texts) => PyList::new(py, texts)?.into_any(),
    })
}
