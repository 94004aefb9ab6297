//! Work-precision studies.

use chaindrive::precision::{Study, Table, Variant};
use chaindrive::{Run, precision};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::drive::Drive;
use crate::errors::OrRaise;
use crate::run::stepping;
use crate::signals::watched;

/// Method, step, tolerance and onset depth of a variant.
type VariantArguments = (String, Option<f64>, Option<f64>, Option<f64>);

/// Measures methods and steps on a drive: columns, and what belongs to all rows.
#[pyfunction]
#[pyo3(signature = (drive, variants, *, until, repeats, replicates))]
pub(crate) fn work_precision<'py>(
    py: Python<'py>,
    drive: &Drive,
    variants: Vec<VariantArguments>,
    until: Option<f64>,
    repeats: usize,
    replicates: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let variant = |(method, step, tolerance, onset_depth): VariantArguments| {
        Ok(Variant {
            stepping: stepping(&method)?,
            step,
            tolerance,
            onset_depth,
        })
    };
    let study = Study {
        variants: variants.into_iter().map(variant).collect::<PyResult<_>>()?,
        until,
        repeats,
        replicates,
    };
    let table = py.detach(|| {
        let run = Run {
            until: until.unwrap_or(Run::default().until),
            ..Run::suggested(&drive.scene.run_defaults())
        };
        let start = drive.drive.assemble().or_raise()?;
        let (table, raised) =
            watched(|watch| precision::work_precision(&start, &run, &study, watch));
        raised?;
        table.or_raise()
    })?;
    let answer = PyDict::new(py);
    answer.set_item("columns", columns(py, &table)?)?;
    let names = table.rows.iter().map(|row| row.variant.stepping.name());
    answer.set_item("method", names.collect::<Vec<_>>())?;
    let remarks = table.rows.iter().map(precision::Row::remark);
    answer.set_item("remark", remarks.collect::<Vec<_>>())?;
    answer.set_item("attributes", attributes(py, &table)?)?;
    Ok(answer)
}

/// Name, values, unit and description of every column.
fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyList>> {
    let rows: Vec<_> = table.rows.iter().map(precision::Row::numbers).collect();
    let columns = PyList::empty(py);
    for (place, column) in rows.iter().take(1).flatten().enumerate() {
        let values = rows.iter().map(|row| row[place].value).collect();
        let values = PyArray1::from_vec(py, values);
        columns.append((column.name, values, column.unit, column.description))?;
    }
    Ok(columns)
}

fn attributes<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    if let Some(ran_in) = &table.ran_in {
        answer.set_item("run_in", ran_in.time)?;
    }
    answer.set_item("window", table.window)?;
    answer.set_item("reference", table.reference.describe())?;
    answer.set_item("check", table.check.describe())?;
    answer.set_item("mean_tension", table.mean_tension)?;
    if let Some(gap) = &table.gap {
        answer.set_item("gap", gap.to_string())?;
    }
    answer.set_item("repeats", table.repeats)?;
    answer.set_item("replicates", table.replicates)?;
    let horizon = &table.horizon;
    answer.set_item("chaos_note", horizon.sentence())?;
    answer.set_item("chaos_note_tight_span", horizon.tight_sentence())?;
    for (name, reach) in [("", horizon.all), ("_tight_span", horizon.tight)] {
        if let Some(at) = reach.time() {
            answer.set_item(format!("chaos_horizon{name}"), at)?;
        }
    }
    for (kind, errors) in [("agreement", &table.agreement), ("spread", &table.spread)] {
        for (name, value) in errors.columns() {
            if value.is_finite() {
                answer.set_item(format!("{kind}_{name}"), value)?;
            }
        }
    }
    answer.set_item("summary", table.to_string())?;
    Ok(answer)
}
