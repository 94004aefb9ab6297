//! Tasks of a sweep: who hands them out, and who carries them out. Without the interpreter's lock, stopped by Ctrl-C.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use chaindrive::record::Existing;
use chaindrive::sweep::{
    Answer, Coordinator, Go, Progress, StoreLocation, SweepError, SweepMemory, SweepStore, Watch,
    Worker,
};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::objects::PythonObjects;
use super::{Sweep, fill};
use crate::errors::OrRaise;
use crate::signals::{PATIENCE, look};

/// Hands out the tasks of a sweep. A store is claimed by this process until it is closed.
#[pyclass(frozen, module = "chaindrive._core")]
pub(crate) struct SweepCoordinator {
    inner: Mutex<Option<Box<dyn Coordinator + Send>>>,
    /// Ctrl-C that came while the sweep was begun: nothing is carried out, and the end is told as of any other.
    stopped: Mutex<Option<PyErr>>,
    /// Number of the open file that holds the claim, for processes that are forked; None where there is none.
    #[pyo3(get)]
    descriptor: Option<i32>,
    /// What a worker opens.
    #[pyo3(get)]
    place: Py<PyAny>,
}

/// A sweep opened to carry out tasks.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct SweepWorker(Worker);

/// A store: a path, or an object store that `chaindrive.objects` has made one of.
#[derive(FromPyObject)]
pub(crate) enum Store {
    Disk(PathBuf),
    Objects(Py<PyAny>),
}

/// What a worker opens: a store, or a recipe as JSON with the number of variants in a task.
#[derive(FromPyObject)]
pub(crate) enum Work {
    InMemory(String, usize),
    InStore(Store),
}

impl From<Store> for StoreLocation {
    fn from(store: Store) -> Self {
        match store {
            Store::Disk(path) => Self::Disk(path),
            Store::Objects(object) => Self::Objects(Arc::new(PythonObjects(object))),
        }
    }
}

#[pymethods]
impl SweepCoordinator {
    /// Begins a sweep whose outcomes come back, with tasks of about so many variants.
    #[staticmethod]
    fn in_memory(py: Python<'_>, sweep: &Sweep, variants_per_task: usize) -> PyResult<Self> {
        let recipe = serde_json::to_string(&sweep.0.recipe());
        let recipe = recipe.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self {
            inner: Mutex::new(Some(Box::new(SweepMemory::new(
                &sweep.0,
                variants_per_task,
            )))),
            stopped: Mutex::default(),
            descriptor: None,
            place: (recipe, variants_per_task)
                .into_pyobject(py)?
                .unbind()
                .into_any(),
        })
    }

    /// Begins a sweep in a store, once some variants have been timed for so many workers, or goes on with it there.
    #[staticmethod]
    fn in_store(
        py: Python<'_>,
        store: Store,
        sweep: &Sweep,
        overwrite: bool,
        workers: Option<usize>,
    ) -> PyResult<Self> {
        let existing = Existing::overwriting(overwrite);
        let objects = match &store {
            Store::Disk(_) => None,
            Store::Objects(object) => Some(object.clone_ref(py)),
        };
        let mut raised = None;
        let store = py.detach(|| {
            let go = || heard(&mut raised, None, 0.0);
            SweepStore::open(StoreLocation::from(store), &sweep.0, existing, workers, go)
        });
        raised.map_or(Ok(()), Err)?;
        let store = store
            .or_raise()?
            .ok_or_else(|| PyKeyboardInterrupt::new_err(()))?;
        let place = match objects {
            Some(objects) => objects,
            None => store
                .place()
                .as_os_str()
                .into_pyobject(py)?
                .unbind()
                .into_any(),
        };
        #[cfg(unix)]
        let descriptor = store.descriptor();
        #[cfg(not(unix))]
        let descriptor = None;
        Ok(Self {
            inner: Mutex::new(Some(Box::new(store))),
            stopped: Mutex::new(py.check_signals().err()),
            descriptor,
            place,
        })
    }

    /// Numbers of the tasks that are still to be carried out.
    fn open_tasks(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        py.detach(|| self.with(|it| it.open_tasks()))?.or_raise()
    }

    /// Takes the answer of a worker to a task.
    fn take(&self, py: Python<'_>, answer: &[u8]) -> PyResult<()> {
        let answer = Answer::from_bytes(answer).or_raise()?;
        py.detach(|| self.with(|it| it.take(answer)))?.or_raise()
    }

    /// Hears that a task was lost.
    fn lose(&self, py: Python<'_>, task: usize, reason: &str) -> PyResult<()> {
        py.detach(|| self.with(|it| it.lose(task, reason)))
    }

    /// Share of the variants that have ended.
    fn share(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| self.with(|it| share(it.progress())))
    }

    /// Whether the result is in its place.
    fn is_public(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| self.with(|it| it.is_public()))
    }

    /// Makes ready for workers elsewhere; what Python raised meanwhile is the answer.
    fn start<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.watched(py, progress, |it, watch| it.start(watch))
    }

    /// Carries out all open tasks on threads; what Python raised meanwhile is the answer.
    fn run<'py>(
        &self,
        py: Python<'py>,
        jobs: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.watched(py, progress, |it, watch| it.run(jobs, watch))
    }

    /// Ends the sweep, and tells what came of it; of a sweep in memory with its arrays.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (tally, summary) = py.detach(|| self.with(|it| it.finish()))?.or_raise()?;
        self.with(|it| {
            let (sweep, outcomes) = (it.sweep(), it.progress().outcomes);
            let answer = PyDict::new(py);
            if !outcomes.is_empty() {
                let stacked = sweep.stack(outcomes);
                let (counts, ending) = (tally.counts(), tally.ending());
                let attributes = sweep.attributes(&stacked.methods, counts, &ending);
                let attributes = serde_json::Value::Object(attributes);
                answer.set_item("attributes", attributes.to_string())?;
                fill(&answer, sweep, stacked)?;
            }
            answer.set_item("finished", tally.finished)?;
            answer.set_item("open", tally.open)?;
            answer.set_item("summary", summary)?;
            answer.set_item("warning", tally.warning(sweep))?;
            Ok(answer)
        })?
    }

    /// Gives the claim back.
    fn close(&self, py: Python<'_>) {
        // Last words may have to go through the interpreter, on any thread.
        py.detach(|| drop(self.inner().take()));
    }
}

impl Drop for SweepCoordinator {
    /// Last words may have to go through the interpreter, on another thread.
    fn drop(&mut self) {
        Python::attach(|py| py.detach(|| drop(self.inner().take())));
    }
}

impl SweepCoordinator {
    fn inner(&self) -> MutexGuard<'_, Option<Box<dyn Coordinator + Send>>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets `act` work while Python is told how far the sweep is; what it raised meanwhile is the answer.
    fn watched<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
        act: impl FnOnce(&mut dyn Coordinator, &mut Watch<'_>) -> Result<Go, SweepError> + Send,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let stopped = || {
            self.stopped
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .take()
        };
        let mut raised = py.detach(stopped);
        let told = |raised: PyErr| raised.into_value(py).into_bound(py).into_any();
        if raised.is_some() {
            return Ok(raised.map(told));
        }
        let mut looked = Instant::now();
        let mut watch = |state: Progress<'_>| {
            if state.finished < state.variants && looked.elapsed() < PATIENCE {
                return Go::On;
            }
            looked = Instant::now();
            heard(&mut raised, progress.as_ref(), share(state))
        };
        py.detach(|| self.with(|it| act(it, &mut watch)))?
            .or_raise()?;
        Ok(raised.map(told))
    }

    fn with<T>(&self, act: impl FnOnce(&mut (dyn Coordinator + Send)) -> T) -> PyResult<T> {
        let mut inner = self.inner();
        let open = inner.as_mut().map(|inner| act(inner.as_mut()));
        open.ok_or_else(|| PyValueError::new_err("the sweep is closed"))
    }
}

/// Whether to go on, as Python's signals and whoever is told have it; what they raised is kept.
fn heard(raised: &mut Option<PyErr>, progress: Option<&Py<PyAny>>, share: f64) -> Go {
    match look(progress, share) {
        Ok(()) => Go::On,
        Err(error) => {
            raised.get_or_insert(error);
            Go::NoFurther
        }
    }
}

fn share(state: Progress<'_>) -> f64 {
    state.finished as f64 / state.variants as f64
}

#[pymethods]
impl SweepWorker {
    /// Opens what a coordinator has as its place.
    #[new]
    fn new(py: Python<'_>, work: Work) -> PyResult<Self> {
        let worker = match work {
            Work::InStore(store) => py
                .detach(|| Worker::open(StoreLocation::from(store)))
                .or_raise(),
            Work::InMemory(recipe, variants_per_task) => {
                let recipe = serde_json::from_str(&recipe);
                let recipe = recipe.map_err(|error| PyValueError::new_err(error.to_string()))?;
                py.detach(|| Worker::in_memory(recipe, variants_per_task))
                    .or_raise()
            }
        };
        Ok(Self(worker?))
    }

    /// Computes the variants of a task, and returns an answer for the coordinator; Ctrl-C is heard meanwhile.
    fn carry_out<'py>(&self, py: Python<'py>, task: usize) -> PyResult<Bound<'py, PyBytes>> {
        let mut raised = None;
        let answer = py.detach(|| {
            let go = || heard(&mut raised, None, 0.0);
            self.0.carry_out_watched(task, go)
        });
        raised.map_or(Ok(()), Err)?;
        let answer = answer.or_raise()?;
        Ok(PyBytes::new(py, &answer.unwrap_or_default().to_bytes()))
    }
}
