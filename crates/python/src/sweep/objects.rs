//! Object stores through the Python package that speaks to them, which brings credentials, retries and regions along.

use std::io;

use chaindrive::record::{Object, Objects};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// An object of the class `chaindrive.objects.Objects`.
#[derive(Debug)]
pub(super) struct InPython(pub(super) Py<PyAny>);

impl InPython {
    fn ask<T>(&self, act: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>) -> io::Result<T> {
        let answer = Python::attach(|py| act(self.0.bind(py)));
        answer.map_err(|error| Python::attach(|py| io::Error::other(error.value(py).to_string())))
    }
}

impl Objects for InPython {
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

    fn erase(&self, key: &str) -> io::Result<()> {
        self.ask(|it| it.call_method1("erase", (key,)).map(drop))
    }

    fn list(&self, prefix: &str) -> io::Result<Vec<String>> {
        self.ask(|it| it.call_method1("list", (prefix,))?.extract())
    }
}
