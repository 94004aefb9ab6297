//! The page in which a browser computes a drive.

use pyo3::prelude::*;

use crate::errors::parameter;

/// The page of the lab, opened on the text of a scene.
#[pyfunction]
pub(crate) fn lab_page(page: &str, text: &str, name: &str) -> PyResult<String> {
    chaindrive_lab::with_scene(page, text, name).ok_or_else(|| {
        let message = "this is not the page that `make lab` builds".to_owned();
        parameter(message, "page", "the page of this build, without a scene")
    })
}
