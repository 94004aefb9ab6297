//! Load cycles of many signals.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Range, mean and count of cycles, (cycles, 3), and how many are of each signal.
type Cycles<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<usize>>);

/// Cycles of signals, (signals, samples), one signal after the other.
#[pyfunction]
pub(crate) fn rainflow<'py>(
    py: Python<'py>,
    signals: PyReadonlyArray2<'py, f64>,
) -> PyResult<Cycles<'py>> {
    let rows = signals.as_array();
    let counted = rows
        .outer_iter()
        .map(|row| chaindrive::rainflow(&row.to_vec()));
    let counted: Vec<_> = counted.collect();
    let each = PyArray1::from_iter(py, counted.iter().map(Vec::len));
    let cycles = counted.iter().flatten();
    let flat = cycles.flat_map(|it| [it.range, it.mean, it.count]);
    let flat = PyArray1::from_vec(py, flat.collect());
    let count = flat.len()? / 3;
    Ok((flat.reshape([count, 3])?, each))
}
