//! Signals: Python looks at them while the core works, and is told how far a run is.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use chaindrive::{Onlooker, Simulation};
use pyo3::prelude::*;

use crate::errors::OrRaise;

/// Between two looks at signals.
pub(crate) const PATIENCE: Duration = Duration::from_millis(50);

/// Silence after which the log is told what goes on.
const SILENCE: Duration = Duration::from_millis(1500);

/// Python as an onlooker: its signals, and the function that it wants to be told by.
pub(crate) struct Interpreter<'a> {
    progress: Option<&'a Py<PyAny>>,
    /// How far the run is.
    share: Cell<f64>,
    /// How far the run-in is, until the run begins.
    run_in: Cell<Option<f64>>,
    looked: Cell<Instant>,
    began: Instant,
    /// Whether the log has been told: one line will do.
    logged: Cell<bool>,
    /// What goes on before a run, in words.
    before: &'static str,
    /// What a signal or the function raised.
    pub(crate) raised: RefCell<Option<PyErr>>,
}

impl<'a> Interpreter<'a> {
    pub(crate) fn new(progress: Option<&'a Py<PyAny>>) -> Self {
        Self {
            progress,
            share: Cell::new(0.0),
            run_in: Cell::new(None),
            looked: Cell::new(Instant::now()),
            began: Instant::now(),
            // Who is told how far a run is needs no log.
            logged: Cell::new(progress.is_some()),
            before: "the drive is assembled and settled, and its step chosen, before it moves",
            raised: RefCell::new(None),
        }
    }

    fn look(&self, progress: Option<&Py<PyAny>>) {
        self.looked.set(Instant::now());
        let looked = match self.run_in.get() {
            Some(share) => look_at_run_in(progress, share),
            None => look(progress, self.share.get()),
        };
        let logged = if !self.logged.get() && self.began.elapsed() >= SILENCE {
            self.logged.set(true);
            log(&self.under_way())
        } else {
            Ok(())
        };
        if let Err(error) = looked.and(logged) {
            self.raised.borrow_mut().get_or_insert(error);
        }
    }

    /// What goes on, in words.
    fn under_way(&self) -> String {
        match (self.run_in.get(), self.share.get()) {
            (Some(share), _) => {
                let percent = share * 100.0;
                format!(
                    "the drive is run in before t = 0, {percent:.0} % done; `run_in` sets how long"
                )
            }
            (None, share) if share > 0.0 => {
                format!("the run is under way, {:.0} % done", share * 100.0)
            }
            _ => self.before.to_owned(),
        }
    }
}

/// Tells the log of Python, under the name of the package.
fn log(what: &str) -> PyResult<()> {
    Python::attach(|py| {
        let logger = py
            .import("logging")?
            .call_method1("getLogger", ("chaindrive",))?;
        logger.call_method1("warning", (what,)).map(drop)
    })
}

impl Onlooker for Interpreter<'_> {
    fn stop(&self) -> bool {
        if self.looked.get().elapsed() >= PATIENCE {
            // Before the first step and after the last there is nothing to tell.
            let under_way = (f64::MIN_POSITIVE..1.0).contains(&self.share.get());
            let under_way = under_way || self.run_in.get().is_some();
            self.look(self.progress.filter(|_| under_way));
        }
        self.raised.borrow().is_some()
    }

    fn see_run_in(&self, share: f64) {
        self.run_in.set(Some(share));
    }

    fn asks_for_time(&self) -> bool {
        true
    }

    fn foretell(&self, sentence: &str) {
        if let Err(error) = log(sentence) {
            self.raised.borrow_mut().get_or_insert(error);
        }
    }

    fn see(&self, simulation: &Simulation) {
        self.run_in.set(None);
        let before = self.share.replace(simulation.progress());
        if before < 1.0 && self.share.get() >= 1.0 {
            self.look(self.progress);
        }
    }
}

/// What goes on where the log is told that a drive has not settled yet.
pub(crate) const SETTLING: &str = "the drive is assembled and settled";

/// Does something that nobody can interrupt, while Python looks at its signals; the log is told of it where it takes long.
pub(crate) fn patiently<T: Send + 'static>(
    py: Python<'_>,
    what: &'static str,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let mut interpreter = Interpreter::new(None);
    interpreter.before = what;
    let (done, raised) =
        py.detach(|| seen_by(interpreter, |stop| chaindrive::patiently(work, stop)));
    raised?;
    done.or_raise()
}

/// Lets `work` look at Python's signals, and raises what it found there.
pub(crate) fn watched<T>(work: impl FnOnce(&dyn Fn() -> bool) -> T) -> (T, PyResult<()>) {
    let interpreter = Interpreter::new(None);
    interpreter.logged.set(true);
    seen_by(interpreter, work)
}

fn seen_by<T>(
    interpreter: Interpreter<'_>,
    work: impl FnOnce(&dyn Fn() -> bool) -> T,
) -> (T, PyResult<()>) {
    let answer = work(&|| interpreter.stop());
    (answer, interpreter.raised.into_inner().map_or(Ok(()), Err))
}

/// Lets Python handle signals and tells it how far the run is.
pub(crate) fn look(progress: Option<&Py<PyAny>>, share: f64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |tell| tell.call1(py, (share,)).map(drop))
    })
}

/// The same while a drive is run in: the share goes to the method `run_in` of whoever is told, if it has one, and else that of the run
/// is told, zero.
fn look_at_run_in(progress: Option<&Py<PyAny>>, share: f64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        let Some(tell) = progress.map(|tell| tell.bind(py)) else {
            return Ok(());
        };
        let told = if tell.hasattr("run_in")? {
            tell.call_method1("run_in", (share,))
        } else {
            tell.call1((0.0,))
        };
        told.map(drop)
    })
}
