//! Friction laws on arrays.

use chaindrive_contact::Rub;
use numpy::IntoPyArray;
use pyo3::prelude::*;

use crate::errors::{in_an_argument, parameter};
use crate::law::{Answer, Values};

/// A friction law.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Friction(chaindrive_contact::Friction);

#[pymethods]
impl Friction {
    /// A law as scenes have it, as JSON.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        chaindrive::scene::read_friction(text)
            .map(Self)
            .map_err(in_an_argument)
    }

    /// The parameters as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0)
            .map_err(|error| parameter(error.to_string(), "friction", "finite"))
    }

    /// Force and damping at normal forces and slips of one length.
    fn act<'py>(
        &self,
        py: Python<'py>,
        normal: Values<'py>,
        slip: Values<'py>,
    ) -> [Answer<'py>; 2] {
        let (normal, slip) = (normal.as_array(), slip.as_array());
        let each = |evaluate: fn(&chaindrive_contact::Friction, f64, f64) -> f64| {
            let pairs = normal.iter().zip(slip);
            let values: Vec<f64> = pairs.map(|(&n, &v)| evaluate(&self.0, n, v)).collect();
            values.into_pyarray(py)
        };
        [
            each(chaindrive_contact::Friction::force),
            each(chaindrive_contact::Friction::damping),
        ]
    }

    /// Force, damping and state after a step, in arrays of one length.
    fn rub<'py>(
        &self,
        py: Python<'py>,
        normal: Values<'py>,
        slip: Values<'py>,
        state: Values<'py>,
        dt: Values<'py>,
    ) -> [Answer<'py>; 3] {
        let (normal, slip) = (normal.as_array(), slip.as_array());
        let (state, dt) = (state.as_array(), dt.as_array());
        let each = normal.iter().zip(slip).zip(state.iter().zip(dt));
        let rubs: Vec<Rub> = each
            .map(|((&n, &v), (&z, &h))| self.0.rub(n, v, z, h))
            .collect();
        let part = |part: fn(&Rub) -> f64| -> Answer<'py> {
            let values: Vec<f64> = rubs.iter().map(part).collect();
            values.into_pyarray(py)
        };
        [
            part(|rub| rub.force),
            part(|rub| rub.damping),
            part(|rub| rub.state),
        ]
    }
}
