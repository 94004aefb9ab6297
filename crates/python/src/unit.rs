//! Units of columns.

use chaindrive::scene::read_unit;
use pyo3::prelude::*;

use crate::errors::parameter;

/// Factor, zero, unit in SI and quantity of a unit: x of it are factor x + zero.
#[pyfunction]
pub(crate) fn unit(text: &str) -> PyResult<(f64, f64, &'static str, &'static str)> {
    let found = read_unit(text).map_err(|it| parameter(it.message, "unit", &it.hint))?;
    Ok((found.factor, found.zero, found.unit, found.quantity))
}
