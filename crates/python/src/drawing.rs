//! Polylines of a drive, for plots.

use chaindrive::{Drive, Run, Simulation};
use chaindrive_geometry::{ArcSpline, Point};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::OrRaise;

/// How far chords may stand off teeth and guides, in fractions of their size.
const COARSE: f64 = 1e-4;

/// What can be drawn of a drive, settled or as it was laid.
pub(crate) fn of<'py>(
    py: Python<'py>,
    drive: &Drive,
    settled: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (mut rollers, centres) = py.detach(|| {
        if settled {
            let mut simulation = Simulation::start(drive, &Run::default()).or_raise()?;
            simulation.next_sample().or_raise()?;
            let sample = simulation.observation();
            let pairs = |x: &[f64], y: &[f64]| -> Vec<Point> {
                x.iter().zip(y).map(|(&x, &y)| Point::new(x, y)).collect()
            };
            Ok::<_, PyErr>((
                pairs(&sample.roller_x, &sample.roller_y),
                pairs(&sample.sprocket_x, &sample.sprocket_y),
            ))
        } else {
            let laid = drive.layouts().or_raise()?;
            let rollers = laid.into_iter().flat_map(|chain| chain.positions).collect();
            Ok((
                rollers,
                drive
                    .sprockets
                    .iter()
                    .map(|sprocket| sprocket.centre)
                    .collect(),
            ))
        }
    })?;

    let sprockets = PyDict::new(py);
    for (sprocket, centre) in drive.sprockets.iter().zip(centres) {
        let gap = &sprocket.gap;
        let drawn = PyDict::new(py);
        drawn.set_item("teeth", gap.teeth)?;
        drawn.set_item("pitch_radius", gap.pitch_radius)?;
        drawn.set_item("tip_radius", gap.tip_radius)?;
        drawn.set_item("centre", points(py, &[centre])?.reshape([2])?)?;
        drawn.set_item(
            "outline",
            points(py, &polyline(&gap.outline().or_raise()?)?)?,
        )?;
        sprockets.set_item(&sprocket.name, drawn)?;
    }
    let guides = PyDict::new(py);
    for guide in &drive.guides {
        guides.set_item(&guide.name, points(py, &polyline(&guide.face)?)?)?;
    }
    let chains = PyList::empty(py);
    for placed in &drive.chains {
        let behind = rollers.split_off(placed.chain.rollers());
        let drawn = PyDict::new(py);
        drawn.set_item("rollers", points(py, &rollers)?)?;
        drawn.set_item("closed", placed.chain.is_closed())?;
        drawn.set_item("pitch", placed.chain.pitch)?;
        drawn.set_item("roller_diameter", placed.chain.roller_diameter)?;
        let touched = placed.sprockets.iter();
        let touched: Vec<&str> = touched.map(|&i| drive.sprockets[i].name.as_str()).collect();
        drawn.set_item("sprockets", touched)?;
        chains.append(drawn)?;
        rollers = behind;
    }
    let answer = PyDict::new(py);
    answer.set_item("chains", chains)?;
    answer.set_item("sprockets", sprockets)?;
    answer.set_item("guides", guides)?;
    Ok(answer)
}

fn polyline(curve: &ArcSpline) -> PyResult<Vec<Point>> {
    curve.polyline(COARSE * curve.aabb().diagonal()).or_raise()
}

/// Points as an array (points, 2).
pub(crate) fn points<'py>(
    py: Python<'py>,
    points: &[Point],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points.iter().flat_map(|point| [point.x, point.y]).collect();
    PyArray1::from_vec(py, flat).reshape([points.len(), 2])
}
