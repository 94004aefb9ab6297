//! Sweeps in a store: who hands out the tasks, and who carries them out.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use chaindrive::record::{Existing, Objects, WriteError};
use chaindrive::sweep::{self, Finished, Go, Worker};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::Sweep;
use super::objects::InPython;
use crate::errors::OrRaise;
use crate::signals::{PATIENCE, look};

/// The store of a sweep, claimed by this process until it is closed.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct SweepStore(Mutex<Option<sweep::SweepStore>>);

/// A store opened to carry out tasks.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct SweepWorker(Worker);

/// Where a store is: a path, or an object store that `chaindrive.objects` has made one of.
#[derive(FromPyObject)]
pub(crate) enum Place {
    Disk(PathBuf),
    Objects(Py<PyAny>),
}

impl Place {
    fn objects(object: Py<PyAny>) -> Arc<dyn Objects> {
        Arc::new(InPython(object))
    }
}

/// Counts of a task: done, failed, distrusted.
type Counts = (usize, usize, usize);

fn counts(task: Finished) -> Counts {
    (task.done, task.failed, task.distrusted)
}

#[pymethods]
impl SweepStore {
    /// Begins the store of a sweep, once some variants have been timed for so many workers.
    #[staticmethod]
    fn begin(
        py: Python<'_>,
        place: Place,
        sweep: &Sweep,
        overwrite: bool,
        workers: Option<usize>,
    ) -> PyResult<Self> {
        let existing = if overwrite {
            Existing::Replace
        } else {
            Existing::Keep
        };
        let mut raised = None;
        let sample = py.detach(|| {
            sweep.0.time_sample(workers, || match look(None, 0.0) {
                Ok(()) => Go::On,
                Err(error) => {
                    raised = Some(error);
                    Go::NoFurther
                }
            })
        });
        let sample = sample.or_raise()?;
        raised.map_or(Ok(()), Err)?;
        let begin = || match place {
            Place::Disk(path) => sweep::SweepStore::begin(&path, &sweep.0, &sample, existing),
            Place::Objects(object) => {
                let objects = Place::objects(object);
                sweep::SweepStore::begin_in(&objects, &sweep.0, &sample, existing)
            }
        };
        Ok(Self(Mutex::new(Some(py.detach(begin).or_raise()?))))
    }

    /// Goes on with a store that was left.
    #[staticmethod]
    fn go_on(py: Python<'_>, place: Place, sweep: &Sweep) -> PyResult<Self> {
        let store = py.detach(|| match place {
            Place::Disk(path) => sweep::SweepStore::go_on(&path, &sweep.0),
            Place::Objects(object) => {
                sweep::SweepStore::go_on_in(&Place::objects(object), &sweep.0)
            }
        });
        Ok(Self(Mutex::new(Some(store.or_raise()?))))
    }

    /// The path for workers, of a store on disk.
    fn place(&self, py: Python<'_>) -> PyResult<PathBuf> {
        py.detach(|| self.with(|store| Ok(store.place().to_owned())))
    }

    /// Number of the open file that holds the claim, for processes that are forked; None in object stores.
    #[cfg(unix)]
    fn descriptor(&self, py: Python<'_>) -> PyResult<Option<i32>> {
        py.detach(|| self.with(|store| Ok(store.descriptor())))
    }

    /// Numbers of the tasks that are not stored.
    fn open_tasks(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        py.detach(|| self.with(|store| store.open_tasks().or_raise()))
    }

    /// Number of variants that are stored.
    fn stored(&self, py: Python<'_>) -> PyResult<usize> {
        py.detach(|| self.with(|store| Ok(store.stored())))
    }

    /// Takes the counts of a task that a worker stored.
    fn count(&self, py: Python<'_>, task: Counts) -> PyResult<()> {
        let (done, failed, distrusted) = task;
        let task = Finished {
            done,
            failed,
            distrusted,
        };
        py.detach(|| self.with(|store| store.count(task).or_raise()))
    }

    /// Puts the store in its place, if need be once it has something; what Python raised meanwhile is the answer.
    fn start<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.watched(py, progress, |store, watch| store.start(watch).map(drop))
    }

    /// Whether the store is in its place.
    fn is_public(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| self.with(|store| Ok(store.is_public())))
    }

    /// Carries out all open tasks on threads; what Python raised meanwhile is the answer.
    fn run<'py>(
        &self,
        py: Python<'py>,
        jobs: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.watched(py, progress, |store, watch| store.run(jobs, watch))
    }

    /// Says in the store how the sweep ended, and here what came of it.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (tally, summary, warning) = py.detach(|| {
            self.with(|store| {
                let (tally, summary) = store.finish().or_raise()?;
                let warning = tally.warning(store.sweep());
                Ok((tally, summary, warning))
            })
        })?;
        let answer = PyDict::new(py);
        answer.set_item("finished", tally.finished)?;
        answer.set_item("open", tally.open)?;
        answer.set_item("summary", summary)?;
        answer.set_item("warning", warning)?;
        Ok(answer)
    }

    /// Gives the claim back.
    fn close(&self, py: Python<'_>) {
        // Last words may have to go through the interpreter, on any thread.
        py.detach(|| drop(self.inner().take()));
    }
}

impl Drop for SweepStore {
    /// Last words may have to go through the interpreter, on another thread.
    fn drop(&mut self) {
        Python::attach(|py| py.detach(|| drop(self.inner().take())));
    }
}

impl SweepStore {
    fn inner(&self) -> MutexGuard<'_, Option<sweep::SweepStore>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out tasks while Python is told how far they are; what it raised meanwhile is the answer.
    fn watched<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
        act: impl FnOnce(&mut sweep::SweepStore, &mut dyn FnMut(usize) -> Go) -> Result<(), WriteError>
        + Send,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let mut raised = None;
        py.detach(|| {
            self.with(|store| {
                let all = store.sweep().len();
                let mut looked = Instant::now();
                let mut watch = |stored: usize| {
                    if stored < all && looked.elapsed() < PATIENCE {
                        return Go::On;
                    }
                    looked = Instant::now();
                    match look(progress.as_ref(), stored as f64 / all as f64) {
                        Ok(()) => Go::On,
                        Err(error) => {
                            raised = Some(error);
                            Go::NoFurther
                        }
                    }
                };
                act(store, &mut watch).or_raise()
            })
        })?;
        Ok(raised.map(|error| error.into_value(py).into_bound(py).into_any()))
    }

    fn with<T>(&self, act: impl FnOnce(&mut sweep::SweepStore) -> PyResult<T>) -> PyResult<T> {
        match self.inner().as_mut() {
            Some(store) => act(store),
            None => Err(PyValueError::new_err("the store is closed")),
        }
    }
}

#[pymethods]
impl SweepWorker {
    /// Opens a store by its place.
    #[new]
    fn new(py: Python<'_>, place: Place) -> PyResult<Self> {
        let worker = py.detach(|| match place {
            Place::Disk(path) => Worker::open(&path),
            Place::Objects(object) => Worker::open_in(&Place::objects(object)),
        });
        Ok(Self(worker.or_raise()?))
    }

    /// Computes the variants of a task and stores them; Ctrl-C is heard meanwhile.
    fn carry_out(&self, py: Python<'_>, task: usize) -> PyResult<Counts> {
        let stop = AtomicBool::new(false);
        let (finished, raised) = py.detach(|| {
            let (sender, receiver) = channel();
            thread::scope(|scope| {
                let (worker, stop) = (&self.0, &stop);
                let _ = scope.spawn(move || sender.send(worker.carry_out(task, stop)));
                let mut raised = None;
                loop {
                    match receiver.recv_timeout(PATIENCE) {
                        Ok(finished) => return (Some(finished), raised),
                        Err(RecvTimeoutError::Disconnected) => return (None, raised),
                        Err(RecvTimeoutError::Timeout) if raised.is_some() => {}
                        Err(RecvTimeoutError::Timeout) => {
                            if let Err(error) = look(None, 0.0) {
                                stop.store(true, Ordering::Relaxed);
                                raised = Some(error);
                            }
                        }
                    }
                }
            })
        });
        raised.map_or(Ok(()), Err)?;
        let finished = finished.map_or(Ok(None), OrRaise::or_raise)?;
        Ok(counts(finished.unwrap_or_default()))
    }
}
