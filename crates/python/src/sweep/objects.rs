//! Object stores through the Python package that speaks to them, which brings credentials, retries and regions along.

use std::io;
use std::thread;

use chaindrive::record::{Object, Objects};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// An object of the class `chaindrive.objects.Objects`.
#[derive(Debug)]
pub(super) struct PythonObjects(pub(super) Py<PyAny>);

impl PythonObjects {
    /// Asks on a thread of its own: on the main thread an answer might be Ctrl-C, which is not for the store to hear. The caller
    /// must not hold the interpreter's lock.
    fn ask<T: Send>(
        &self,
        act: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T> + Send,
    ) -> io::Result<T> {
        let ask = || {
            Python::attach(|py| {
                let answer = act(self.0.bind(py));
                answer.map_err(|error| io::Error::other(error.value(py).to_string()))
            })
        };
        thread::scope(|scope| {
            let answer = thread::Builder::new().spawn_scoped(scope, ask)?;
            let answer = answer.join();
            answer.unwrap_or_else(|_| Err(io::Error::other("a request to the store panicked")))
        })
    }
}

impl Objects for PythonObjects {
    fn name(&self) -> String {
        let name = self.ask(|it| it.str()?.extract());
        name.unwrap_or_else(|_| "object store".to_owned())
    }

    fn get(&self, key: &str) -> io::Result<Option<Object>> {
        let found: Option<(Vec<u8>, String)> =
            self.ask(|it| it.call_method1("get", (key,))?.extract())?;
        Ok(found.map(|(bytes, tag)| Object { bytes, tag }))
    }

    fn size(&self, key: &str) -> io::Result<Option<u64>> {
        self.ask(|it| it.call_method1("size", (key,))?.extract())
    }

    fn put(&self, key: &str, bytes: &[u8]) -> io::Result<()> {
        self.ask(|it| {
            let bytes = PyBytes::new(it.py(), bytes);
            it.call_method1("put", (key, bytes)).map(drop)
        })
    }

    fn put_if(&self, key: &str, bytes: &[u8], tag: Option<&str>) -> io::Result<bool> {
        self.ask(|it| {
            let bytes = PyBytes::new(it.py(), bytes);
            it.call_method1("put_if", (key, bytes, tag))?.extract()
        })
    }

    fn erase(&self, keys: &[String]) -> io::Result<()> {
        self.ask(|it| it.call_method1("erase", (keys,)).map(drop))
    }

    fn list(&self, prefix: &str) -> io::Result<Vec<String>> {
        self.ask(|it| it.call_method1("list", (prefix,))?.extract())
    }
}
