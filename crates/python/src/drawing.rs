//! The figure of a drive and its poses, for plots.

use std::collections::HashMap;

use chaindrive::{BodyKind, Drive, Figure as CoreFigure, Instant, Placement, Run, Simulation};
use chaindrive_geometry::{ArcSpline, Point};
use numpy::ndarray::ArrayView2;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyKeyError;
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

/// What stays the same while a drive moves: bodies with their outlines, chains with their measures.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Figure(pub(crate) CoreFigure);

#[pymethods]
impl Figure {
    /// The bodies: name, kind, measures, and outlines (points, 2) in their own frames whose chords stand off by `tolerance`.
    fn bodies<'py>(&self, py: Python<'py>, tolerance: f64) -> PyResult<Bound<'py, PyList>> {
        let bodies = PyList::empty(py);
        for body in &self.0.bodies {
            let drawn = PyDict::new(py);
            drawn.set_item("name", &body.name)?;
            drawn.set_item("kind", body.kind.name())?;
            let outlines = PyList::empty(py);
            for outline in &body.outlines {
                outlines.append(points(py, &outline.polyline(tolerance).or_raise()?)?)?;
            }
            drawn.set_item("outlines", outlines)?;
            drawn.set_item("backing", points(py, &body.backing)?)?;
            match body.kind {
                BodyKind::Sprocket {
                    teeth,
                    pitch_radius,
                    tip_radius,
                } => {
                    drawn.set_item("teeth", teeth)?;
                    drawn.set_item("pitch_radius", pitch_radius)?;
                    drawn.set_item("tip_radius", tip_radius)?;
                }
                BodyKind::Guide { touches } => drawn.set_item("touches", touches.name())?,
                BodyKind::Arm | BodyKind::Slider | BodyKind::Plunger => {}
            }
            bodies.append(drawn)?;
        }
        Ok(bodies)
    }

    /// The chains: measures and names.
    #[getter]
    fn chains<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let chains = PyList::empty(py);
        for chain in &self.0.chains {
            let drawn = PyDict::new(py);
            drawn.set_item("name", &chain.name)?;
            drawn.set_item("closed", chain.closed)?;
            drawn.set_item("rollers", chain.rollers)?;
            drawn.set_item("links", chain.links)?;
            drawn.set_item("pitch", chain.pitch)?;
            drawn.set_item("roller_diameter", chain.roller_diameter)?;
            drawn.set_item("pin_diameter", chain.pin_diameter)?;
            drawn.set_item("plate_height", chain.plate_height)?;
            drawn.set_item("plates", chain.plates.name())?;
            drawn.set_item("outer_first", chain.outer_first)?;
            drawn.set_item("spans", &chain.spans)?;
            drawn.set_item("sprockets", &chain.sprockets)?;
            drawn.set_item("guides", &chain.guides)?;
            chains.append(drawn)?;
        }
        Ok(chains)
    }

    /// Channels that a record must have to be posed.
    #[getter]
    fn needs(&self) -> Vec<&'static str> {
        self.0.needs()
    }

    /// The pose at the start: placements (bodies, 3), rollers (rollers, 2) and plates (links, 4) of every chain.
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let pose = self.0.start();
        let answer = PyDict::new(py);
        let count = pose.placements.len();
        let flat: Vec<f64> = pose.placements.iter().flat_map(numbers).collect();
        let placements = PyArray1::from_vec(py, flat).reshape([count, 3])?;
        answer.set_item("placements", placements)?;
        let rollers = PyList::empty(py);
        let plates = PyList::empty(py);
        for (places, ends) in pose.rollers.iter().zip(&pose.plates) {
            rollers.append(points(py, places)?)?;
            let flat: Vec<f64> = ends
                .iter()
                .flat_map(|[from, to]| [from.x, from.y, to.x, to.y])
                .collect();
            plates.append(PyArray1::from_vec(py, flat).reshape([ends.len(), 4])?)?;
        }
        answer.set_item("rollers", rollers)?;
        answer.set_item("plates", plates)?;
        Ok(answer)
    }

    /// Where all bodies are at every time (times,): x, y and angle, (times, bodies, 3). Channels are (times, entries).
    fn placements<'py>(
        &self,
        py: Python<'py>,
        time: PyReadonlyArray1<'py, f64>,
        channels: HashMap<String, PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let channels = Channels::new(&channels);
        let times = time.as_array();
        let mut flat = Vec::with_capacity(times.len() * self.0.bodies.len() * 3);
        for (index, &time) in times.iter().enumerate() {
            let instant = channels.instant(index, time);
            let placements = self.0.placements(&instant).map_err(missing)?;
            flat.extend(placements.iter().flat_map(numbers));
        }
        PyArray1::from_vec(py, flat).reshape([times.len(), self.0.bodies.len(), 3])
    }
}

fn numbers(placement: &Placement) -> [f64; 3] {
    [placement.x, placement.y, placement.angle]
}

fn missing(error: chaindrive::MissingChannel) -> PyErr {
    PyKeyError::new_err(error.to_string())
}

/// Recorded channels by name, (times, entries) each.
struct Channels<'a>(HashMap<&'a str, ArrayView2<'a, f64>>);

impl<'a> Channels<'a> {
    fn new(given: &'a HashMap<String, PyReadonlyArray2<'_, f64>>) -> Self {
        let views = given.iter();
        Self(
            views
                .map(|(name, it)| (name.as_str(), it.as_array()))
                .collect(),
        )
    }

    /// The instant of one sample.
    fn instant(&'a self, index: usize, time: f64) -> Instant<'a> {
        let of = |name: &str| {
            let values = self.0.get(name)?;
            let rows = (index < values.nrows()).then(|| values.row(index));
            // Rows of arrays in the order of C lie in one piece.
            rows.and_then(|row| row.to_slice())
        };
        Instant {
            time,
            roller_x: of("roller_x"),
            roller_y: of("roller_y"),
            sprocket_angle: of("sprocket_angle"),
            sprocket_x: of("sprocket_x"),
            sprocket_y: of("sprocket_y"),
            tensioner_position: of("tensioner_position"),
            joint_offset_x: of("joint_offset_x"),
            joint_offset_y: of("joint_offset_y"),
            bush_offset_x: of("bush_offset_x"),
            bush_offset_y: of("bush_offset_y"),
        }
    }
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
