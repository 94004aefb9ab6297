//! Polygon action and the smooth formulas of two wheels.

use chaindrive_geometry::{PolygonAction, TwoWheels};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::OrRaise;

/// States of a two-sprocket drive at the given driver angles, and its constants.
#[pyfunction]
pub(crate) fn polygon_action<'py>(
    py: Python<'py>,
    teeth: [u32; 2],
    pitch: f64,
    centre_distance: f64,
    driver_angle: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let drive = PolygonAction::new(teeth[0], teeth[1], pitch, centre_distance).or_raise()?;
    let angles = driver_angle.as_array();
    let states = angles.mapv(|angle| drive.driven(angle));
    let columns = PyDict::new(py);
    let column = |name: &str, read: &dyn Fn(&chaindrive_geometry::DrivenState) -> f64| {
        columns.set_item(name, states.map(read).into_pyarray(py))
    };
    column("driven_angle", &|state| state.angle)?;
    column("speed_ratio", &|state| state.ratio)?;
    column("speed_ratio_rate", &|state| state.ratio_rate)?;
    column("span_angle", &|state| state.span_angle)?;
    column("span_rate", &|state| state.span_rate)?;
    column("span_links", &|state| f64::from(state.links))?;
    column("driver_seat", &|state| state.driver_seat)?;
    column("driven_seat", &|state| state.driven_seat)?;
    let error = angles.mapv(|angle| drive.transmission_error(angle));
    columns.set_item("transmission_error", error.into_pyarray(py))?;

    let constants = PyDict::new(py);
    let [driver_radius, driven_radius] = drive.radii();
    let (least, greatest) = drive.ratio_extremes();
    for (name, value) in [
        ("mean_ratio", drive.mean_ratio()),
        ("least_ratio", least),
        ("greatest_ratio", greatest),
        ("transmission_error_range", drive.transmission_error_range()),
        ("lift_off", drive.lift_off()),
        ("driver_pitch_radius", driver_radius),
        ("driven_pitch_radius", driven_radius),
        ("relative_seating_speed", drive.seating_velocity().relative),
    ] {
        constants.set_item(name, value)?;
    }
    Ok((columns, constants))
}

/// Links of the taut route around two wheels.
#[pyfunction]
pub(crate) fn links_for(teeth: [u32; 2], pitch: f64, centre_distance: f64) -> PyResult<f64> {
    TwoWheels { teeth, pitch }.links(centre_distance).or_raise()
}

/// Centre distance at which the taut route takes a number of links.
#[pyfunction]
pub(crate) fn centre_distance_for(teeth: [u32; 2], pitch: f64, links: f64) -> PyResult<f64> {
    TwoWheels { teeth, pitch }.centre_distance(links).or_raise()
}
