//! Drives that Python moves itself: read at any time, inputs set, states kept.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use chaindrive::{Axis, Channel, Control, Course, Request, Settings, SimulationError};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PySlice};

use crate::drive::Drive;
use crate::errors::{IntoException, OrRaise, broken, in_another_thread};
use crate::run::{Setting, merged};
use crate::signals::{Interpreter, watched};

/// Steps that are taken without a look at signals, and while other threads of Python wait.
const FEW_STEPS: u64 = 100;

/// A drive in motion.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Simulation {
    moving: Mutex<chaindrive::Simulation>,
    /// Views that somebody has asked for, filled wherever it has moved.
    views: Mutex<Vec<Py<View>>>,
}

/// Arrays of some channels of a drive in motion.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct View {
    seen: Mutex<chaindrive::View>,
    /// All entries, one channel after the other: NumPy lends one array sooner than many.
    all: Py<PyArray1<f64>>,
}

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

/// The value, also after a panic elsewhere: arrays are filled anew.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[pymethods]
impl View {
    /// The arrays, in the order of the channels: parts of one.
    #[getter]
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let seen = held(&self.seen);
        let part = |channel| {
            let Range { start, end } = seen.range(channel);
            let part = PySlice::new(py, start.cast_signed(), end.cast_signed(), 1);
            self.all.bind(py).get_item(part)
        };
        (0..seen.channels().len()).map(part).collect()
    }
}

impl View {
    /// Reads the channels off a simulation into the arrays.
    fn fill(&self, py: Python<'_>, simulation: &mut chaindrive::Simulation) -> PyResult<()> {
        let mut seen = held(&self.seen);
        simulation.read_into(&mut seen);
        let mut all = self.all.bind(py).try_readwrite()?;
        all.as_slice_mut()?.copy_from_slice(seen.all());
        Ok(())
    }
}

impl Simulation {
    /// The drive, unless another thread moves it.
    fn moving(&self) -> PyResult<MutexGuard<'_, chaindrive::Simulation>> {
        match self.moving.try_lock() {
            Ok(moving) => Ok(moving),
            Err(TryLockError::WouldBlock) => Err(in_another_thread()),
            // A step that panicked left it between two states.
            Err(TryLockError::Poisoned(_)) => Err(broken()),
        }
    }

    /// Fills all views.
    fn show(&self, py: Python<'_>, simulation: &mut chaindrive::Simulation) -> PyResult<()> {
        let views = held(&self.views);
        views
            .iter()
            .try_for_each(|view| view.get().fill(py, simulation))
    }
}

/// Moves simulations on to a time on all cores; Ctrl-C leaves them where they are.
#[pyfunction]
pub(crate) fn step_many(
    py: Python<'_>,
    simulations: Vec<Py<Simulation>>,
    time: f64,
) -> PyResult<()> {
    let held: PyResult<Vec<_>> = simulations.iter().map(|it| it.get().moving()).collect();
    let mut held = held?;
    let mut moving: Vec<&mut chaindrive::Simulation> =
        held.iter_mut().map(|it| &mut **it).collect();
    let (moved, raised) =
        py.detach(|| watched(|stop| chaindrive::step_many(&mut moving, time, stop)));
    for (simulation, held) in simulations.iter().zip(&mut held) {
        simulation.get().show(py, held)?;
    }
    raised?;
    moved.into_iter().try_for_each(OrRaise::or_raise)
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
        Ok(Self {
            moving: Mutex::new(simulation),
            views: Mutex::default(),
        })
    }

    /// Moves on to a time; Ctrl-C leaves the simulation where it is, and it can go on from there.
    fn advance_to(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        let mut moving = self.moving()?;
        let simulation = &mut *moving;
        let (done, raised) = py.detach(|| watched(|stop| simulation.move_to(time, stop)));
        raised?;
        done.or_raise()?;
        self.show(py, simulation)
    }

    /// Takes a number of steps; Ctrl-C leaves the simulation where it is.
    fn advance(&self, py: Python<'_>, steps: u64) -> PyResult<()> {
        let mut moving = self.moving()?;
        let simulation = &mut *moving;
        if steps <= FEW_STEPS {
            // Others may wait so long.
            simulation.step(steps).or_raise()?;
        } else {
            let (done, raised) = py.detach(|| {
                watched(|stop| {
                    let mut left = steps;
                    while left > 0 && !stop() {
                        let some = left.min(FEW_STEPS);
                        simulation.step(some)?;
                        left -= some;
                    }
                    Ok::<(), SimulationError>(())
                })
            });
            raised?;
            done.or_raise()?;
        }
        self.show(py, simulation)
    }

    /// Arrays of some channels, filled wherever the simulation has moved; the same ones for the same channels.
    fn view(&self, py: Python<'_>, names: Vec<String>) -> PyResult<Py<View>> {
        let mut moving = self.moving()?;
        let channels = Channel::chosen(&names, moving.system()).or_raise()?;
        let mut views = held(&self.views);
        let same = |view: &&Py<View>| held(&view.get().seen).channels() == channels;
        if let Some(known) = views.iter().find(same) {
            return Ok(known.clone_ref(py));
        }
        let seen = moving.view(&channels).or_raise()?;
        let view = View {
            all: PyArray1::from_slice(py, seen.all()).unbind(),
            seen: Mutex::new(seen),
        };
        let view = Py::new(py, view)?;
        views.push(view.clone_ref(py));
        Ok(view)
    }

    /// Time of the last reading.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.moving()?.read_at())
    }

    /// A channel at the last reading.
    fn channel<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut moving = self.moving()?;
        let channels = Channel::chosen(&[name], moving.system()).or_raise()?;
        moving.refresh();
        let values = channels.iter().flat_map(|it| moving.channel(*it)).collect();
        Ok(PyArray1::from_vec(py, values))
    }

    /// Labels of the entries of a channel; none where there is one entry only.
    fn labels(&self, name: &str) -> PyResult<Option<Vec<String>>> {
        let moving = self.moving()?;
        let channels = Channel::chosen(&[name], moving.system()).or_raise()?;
        let axis = channels
            .first()
            .map_or(Axis::None, |channel| channel.axis());
        Ok(chaindrive::channel::labels(axis, moving.system()))
    }

    /// The attribute that tells the unit of a channel, and the unit.
    fn unit(&self, name: &str) -> PyResult<(&'static str, String)> {
        let channel = Channel::from_name(name).or_raise()?;
        Ok(channel.unit_attribute(self.moving()?.system()))
    }

    /// The chain of every entry of a channel, by name, and the coordinate that tells it; none of one chain.
    fn chains(&self, name: &str) -> PyResult<Option<(&'static str, Vec<String>)>> {
        let moving = self.moving()?;
        let channels = Channel::chosen(&[name], moving.system()).or_raise()?;
        let axis = channels
            .first()
            .map_or(Axis::None, |channel| channel.axis());
        let chains = chaindrive::channel::chains_along(axis, moving.system());
        Ok(axis.chain_coordinate().zip(chains))
    }

    /// Sets what acts on the drive from a time on, that of the last reading where none is given: a value, the time within which it comes
    /// there, and its rate from then on.
    #[pyo3(signature = (kind, name, course, at))]
    fn set(
        &self,
        kind: &str,
        name: &str,
        course: (f64, f64, f64),
        at: Option<f64>,
    ) -> PyResult<()> {
        let control = Control::named(kind, name).or_raise()?;
        let (to, over, rate) = course;
        let mut moving = self.moving()?;
        let at = at.unwrap_or_else(|| moving.read_at());
        let course = Course { to, over, rate };
        moving.set_at(at, &control, course).or_raise()
    }

    /// The simulation as it is.
    fn snapshot(&self) -> PyResult<Snapshot> {
        Ok(Snapshot(self.moving()?.snapshot()))
    }

    /// Goes back, or on, to a snapshot.
    fn restore(&self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        let mut moving = self.moving()?;
        moving.restore(&snapshot.0).or_raise()?;
        self.show(py, &mut moving)
    }

    /// Name of the method, and number of steps taken.
    fn account(&self) -> PyResult<(&'static str, u64)> {
        let moving = self.moving()?;
        Ok((moving.method().name(), moving.statistics().steps))
    }
}
