//! Drives that Python moves itself: read at any time, torques and forces set, states kept.

use chaindrive::{Axis, Channel, Control, Onlooker, Request, Settings, SimulationError};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::drive::Drive;
use crate::errors::{IntoException, OrRaise, parameter};
use crate::run::{Setting, merged};
use crate::signals::{Interpreter, PATIENCE};

/// A drive in motion.
#[pyclass(module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Simulation(chaindrive::Simulation);

/// A simulation as it was.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Snapshot(chaindrive::Snapshot);

#[pymethods]
impl Snapshot {
    /// The snapshot that was written down.
    #[new]
    fn new(data: &[u8]) -> PyResult<Self> {
        chaindrive::Snapshot::from_bytes(data).or_raise().map(Self)
    }

    fn __bytes__<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes())
    }

    /// For `pickle`.
    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyBytes>,) {
        (self.__bytes__(py),)
    }
}

/// What can be set, by its name in Python.
fn control(kind: &str, name: String) -> PyResult<Control> {
    Ok(match kind {
        "torque" => Control::Torque(name),
        "force" => Control::Force(name),
        "centre_x" => Control::CentreX(name),
        "centre_y" => Control::CentreY(name),
        _ => {
            let known = "torque, force, centre_x, centre_y";
            let message = format!("`{kind}` cannot be set; there are {known}");
            return Err(parameter(message, "kind", &format!("one of {known}")));
        }
    })
}

#[pymethods]
impl Simulation {
    /// Assembles a drive and starts its clock.
    #[new]
    fn new(py: Python<'_>, drive: &Drive, settings: Vec<(String, Setting)>) -> PyResult<Self> {
        let settings: Settings = merged(settings);
        let request = Request::new(&drive.scene, &settings).or_raise()?;
        let request = request.with_default_step();
        let (made, raised) = py.detach(|| {
            let interpreter = Interpreter::new(None);
            let made = chaindrive::Simulation::of(&request, &interpreter);
            (made, interpreter.raised.into_inner())
        });
        let mut simulation = match (made, raised) {
            (Err(_), Some(raised)) => return Err(raised),
            (made, _) => made.map_err(IntoException::exception)?,
        };
        simulation.advance_to(0.0).or_raise()?;
        Ok(Self(simulation))
    }

    /// Moves on to a time; Ctrl-C leaves the simulation where it is, and it can go on from there.
    fn advance_to(&mut self, py: Python<'_>, time: f64) -> PyResult<()> {
        let simulation = &mut self.0;
        let (done, raised) = py.detach(|| {
            let interpreter = Interpreter::new(None);
            let done = loop {
                match simulation.advance_towards(time, PATIENCE) {
                    Ok(true) => break Ok(()),
                    Ok(false) if interpreter.stop() => break Err(SimulationError::Interrupted),
                    Ok(false) => {}
                    Err(error) => break Err(error),
                }
            };
            (done, interpreter.raised.into_inner())
        });
        match (done, raised) {
            (Err(_), Some(raised)) => Err(raised),
            (done, _) => done.or_raise(),
        }
    }

    /// Time of the last reading.
    #[getter]
    fn time(&self) -> f64 {
        self.0.read_at()
    }

    /// A channel at the last reading.
    fn channel<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let channels = Channel::chosen(&[name], self.0.system()).or_raise()?;
        let values = channels.iter().flat_map(|it| self.0.channel(*it)).collect();
        Ok(PyArray1::from_vec(py, values))
    }

    /// Labels of the entries of a channel; none where there is one entry only.
    fn labels(&self, name: &str) -> PyResult<Option<Vec<String>>> {
        let channels = Channel::chosen(&[name], self.0.system()).or_raise()?;
        let axis = channels
            .first()
            .map_or(Axis::None, |channel| channel.axis());
        Ok(chaindrive::channel::labels(axis, self.0.system()))
    }

    /// The attribute that tells the unit of a channel, and the unit.
    fn unit(&self, name: &str) -> PyResult<(&'static str, String)> {
        let channel = Channel::from_name(name).or_raise()?;
        Ok(channel.unit_attribute(self.0.system()))
    }

    /// The chain of every entry of a channel, by name, and the coordinate that tells it; none of one chain.
    fn chains(&self, name: &str) -> PyResult<Option<(&'static str, Vec<String>)>> {
        let channels = Channel::chosen(&[name], self.0.system()).or_raise()?;
        let axis = channels
            .first()
            .map_or(Axis::None, |channel| channel.axis());
        let chains = chaindrive::channel::chains_along(axis, self.0.system());
        Ok(axis.chain_coordinate().zip(chains))
    }

    /// Sets what acts on the drive from a time on, that of the last reading where none is given.
    #[pyo3(signature = (kind, name, value, at))]
    fn set(&mut self, kind: &str, name: String, value: f64, at: Option<f64>) -> PyResult<()> {
        let control = control(kind, name)?;
        let at = at.unwrap_or_else(|| self.0.read_at());
        self.0.set_at(at, &control, value).or_raise()
    }

    /// The simulation as it is.
    fn snapshot(&self) -> Snapshot {
        Snapshot(self.0.snapshot())
    }

    /// Goes back, or on, to a snapshot.
    fn restore(&mut self, snapshot: &Snapshot) -> PyResult<()> {
        self.0.restore(&snapshot.0).or_raise()
    }

    /// Name of the method, and number of steps taken.
    fn account(&self) -> (&'static str, u64) {
        (self.0.method().name(), self.0.statistics().steps)
    }
}
