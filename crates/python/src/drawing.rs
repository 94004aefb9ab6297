//! The figure of a drive and its poses, for plots.

use std::collections::HashMap;

use chaindrive::{BodyKind, Figure as CoreFigure, Instant, Placement, Pose, draw};
use chaindrive_geometry::{Piece, Point, Vector};
use numpy::ndarray::ArrayView2;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::OrRaise;

/// How far chords of plates may stand off, in pitches.
const COARSE: f64 = 1e-3;

/// Chords of the arc of an arrow.
const ARROW: u32 = 24;

/// What stays the same while a drive moves: bodies with their outlines, chains with their measures.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Figure(pub(crate) CoreFigure);

#[pymethods]
impl Figure {
    /// The bodies: name, kind, measures, the arrow of a sprocket that turns (its arc and its head), and outlines (points, 2) in their own frames whose chords stand off by `tolerance`.
    fn bodies<'py>(&self, py: Python<'py>, tolerance: f64) -> PyResult<Bound<'py, PyList>> {
        let bodies = PyList::empty(py);
        for (index, body) in self.0.bodies.iter().enumerate() {
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
                    // Of a sprocket that stands still there is none.
                    let arrow = self.0.rotation_arrow(index).map(|arrow| {
                        let along = (0..=ARROW).map(|k| f64::from(k) / f64::from(ARROW));
                        let piece = Piece::Arc(arrow.arc);
                        let arc: Vec<Point> = along.map(|it| piece.point(it)).collect();
                        Ok::<_, PyErr>((points(py, &arc)?, points(py, &arrow.head)?))
                    });
                    drawn.set_item("arrow", arrow.transpose()?)?;
                }
                BodyKind::Guide { touches } => drawn.set_item("touches", touches.name())?,
                BodyKind::Carrier { .. } | BodyKind::Plunger | BodyKind::Force { .. } => {}
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
            // Halves of the outline, each seen from its own end.
            let plate = chain.plate(chain.pitch).or_raise()?;
            let mut outline = plate.polyline(COARSE * chain.pitch).or_raise()?;
            // From the middle on top: first half, then second half.
            let ahead = outline.iter().rev().take_while(|p| p.x < 0.5 * chain.pitch);
            let ahead = ahead.count();
            outline.rotate_right(ahead);
            let (first, second): (Vec<Point>, Vec<Point>) =
                outline.iter().partition(|p| p.x < 0.5 * chain.pitch);
            let end = Vector::new(chain.pitch, 0.0);
            let second: Vec<Point> = second.into_iter().map(|p| p - end).collect();
            drawn.set_item("plate", (points(py, &first)?, points(py, &second)?))?;
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

    /// Names of the channels by which everything is placed, where they were recorded.
    #[classattr]
    fn placing() -> [&'static str; 14] {
        Instant::CHANNELS
    }

    /// Gaps of chains that do not close: place x and y, length that is missing, and that in words.
    #[getter]
    fn gaps(&self) -> Vec<Mark> {
        let gaps = self.0.gaps.iter();
        gaps.map(|gap| {
            let [x, y] = [
                0.5 * (gap.end.x + gap.start.x),
                0.5 * (gap.end.y + gap.start.y),
            ];
            (x, y, gap.missing, gap.to_string())
        })
        .collect()
    }

    /// Clashes: place x and y, depth, and what clashes in words.
    #[getter]
    fn clashes(&self) -> Vec<Mark> {
        let clashes = self.0.clashes.iter();
        clashes
            .map(|clash| {
                let at = clash.place();
                (at.x, at.y, clash.depth(), clash.to_string())
            })
            .collect()
    }

    /// Why the drive cannot run as it stands, if it cannot.
    #[getter]
    fn problem(&self) -> Option<&str> {
        self.0.problem.as_deref()
    }

    /// The start as the text of an SVG file, or the pose at a time; channels are (entries,).
    #[pyo3(signature = (title, time = None, channels = None))]
    fn svg(
        &self,
        title: &str,
        time: Option<f64>,
        channels: Option<HashMap<String, PyReadonlyArray1<'_, f64>>>,
    ) -> PyResult<String> {
        let pose = match (time, &channels) {
            (Some(time), Some(channels)) => self.posed(time, channels)?,
            _ => self.0.start(),
        };
        Ok(draw::svg(&self.0, &pose, title))
    }

    /// The pose at the start: placements (bodies, 3), rollers (rollers, 2) and plates (links, 4) of every chain.
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        told(py, &self.0.start())
    }

    /// The pose at a time, as `start` has it; channels are (entries,).
    fn pose<'py>(
        &self,
        py: Python<'py>,
        time: f64,
        channels: HashMap<String, PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        told(py, &self.posed(time, &channels)?)
    }

    /// Where all bodies are at every time (times,): x, y and angle, (times, bodies, 3). Channels are (times, entries).
    fn placements<'py>(
        &self,
        py: Python<'py>,
        time: PyReadonlyArray1<'py, f64>,
        channels: HashMap<String, PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let times = time.as_array();
        let views = channels
            .iter()
            .map(|(name, it)| (name.as_str(), it.as_array()));
        let views: HashMap<&str, ArrayView2<'_, f64>> = views.collect();
        let mut flat = Vec::with_capacity(times.len() * self.0.bodies.len() * 3);
        for (index, &time) in times.iter().enumerate() {
            let row = |name: &str| {
                let values = views.get(name).filter(|it| index < it.nrows())?;
                // Rows of arrays in the order of C lie in one piece.
                values.row(index).to_slice()
            };
            let placements = self
                .0
                .placements(&Instant::recorded(time, row))
                .map_err(missing)?;
            flat.extend(placements.iter().flat_map(numbers));
        }
        PyArray1::from_vec(py, flat).reshape([times.len(), self.0.bodies.len(), 3])
    }
}

/// Place x and y, size, and words of a mark.
type Mark = (f64, f64, f64, String);

impl Figure {
    fn posed(
        &self,
        time: f64,
        channels: &HashMap<String, PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Pose> {
        let values = |name: &str| channels.get(name).and_then(|it| it.as_slice().ok());
        self.0
            .pose(&Instant::recorded(time, values))
            .map_err(missing)
    }
}

fn numbers(placement: &Placement) -> [f64; 3] {
    [placement.x, placement.y, placement.angle]
}

fn missing(error: chaindrive::MissingChannel) -> PyErr {
    PyKeyError::new_err(error.to_string())
}

fn told<'py>(py: Python<'py>, pose: &Pose) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    let count = pose.placements.len();
    let flat: Vec<f64> = pose.placements.iter().flat_map(numbers).collect();
    let placements = PyArray1::from_vec(py, flat).reshape([count, 3])?;
    answer.set_item("placements", placements)?;
    let rollers = PyList::empty(py);
    let plates = PyList::empty(py);
    for (places, ends) in pose.rollers.iter().zip(&pose.plates) {
        rollers.append(points(py, places)?)?;
        let pairs = ends.iter();
        let flat: Vec<f64> = pairs.flat_map(|[a, b]| [a.x, a.y, b.x, b.y]).collect();
        plates.append(PyArray1::from_vec(py, flat).reshape([ends.len(), 4])?)?;
    }
    answer.set_item("rollers", rollers)?;
    answer.set_item("plates", plates)?;
    Ok(answer)
}

/// Points as an array (points, 2).
pub(crate) fn points<'py>(
    py: Python<'py>,
    points: &[Point],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points.iter().flat_map(|point| [point.x, point.y]).collect();
    PyArray1::from_vec(py, flat).reshape([points.len(), 2])
}
