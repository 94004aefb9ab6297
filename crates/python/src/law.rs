//! Contact laws on arrays.

use chaindrive_contact::Approach;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors::{OrRaise, parameter};

/// A contact law.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Law(pub(crate) chaindrive_contact::Law);

type Values<'py> = PyReadonlyArray1<'py, f64>;
type Answer<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl Law {
    /// A law from its parameters as JSON.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let law: chaindrive_contact::Law = serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let message = message.split(" at line").next().unwrap_or_default();
            parameter(message.to_owned(), "law", "a contact law")
        })?;
        law.check().or_raise()?;
        Ok(Self(law))
    }

    /// The parameters as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0)
            .map_err(|error| parameter(error.to_string(), "law", "finite"))
    }

    /// Normal force at penetrations, closing speeds and closing speeds at onset of one length.
    fn force<'py>(
        &self,
        py: Python<'py>,
        penetration: Values<'py>,
        rate: Values<'py>,
        onset_rate: Values<'py>,
    ) -> Answer<'py> {
        along(py, [penetration, rate, onset_rate], |approach| {
            self.0.force(approach)
        })
    }

    /// Damping, in the arguments of the force.
    fn damping<'py>(
        &self,
        py: Python<'py>,
        penetration: Values<'py>,
        rate: Values<'py>,
        onset_rate: Values<'py>,
    ) -> Answer<'py> {
        along(py, [penetration, rate, onset_rate], |approach| {
            self.0.damping(approach)
        })
    }

    /// Tangent stiffness of the elastic part.
    fn stiffness<'py>(&self, py: Python<'py>, penetration: Values<'py>) -> Answer<'py> {
        penetration
            .as_array()
            .mapv(|depth| self.0.stiffness(depth))
            .into_pyarray(py)
    }

    /// Stored energy.
    fn energy<'py>(&self, py: Python<'py>, penetration: Values<'py>) -> Answer<'py> {
        penetration
            .as_array()
            .mapv(|depth| self.0.energy(depth))
            .into_pyarray(py)
    }
}

/// Evaluates a function of the approach along arrays of one length.
fn along<'py>(
    py: Python<'py>,
    [penetration, rate, onset_rate]: [Values<'py>; 3],
    evaluate: impl Fn(Approach) -> f64,
) -> Answer<'py> {
    let (penetration, rate) = (penetration.as_array(), rate.as_array());
    let approaches = penetration.iter().zip(rate).zip(onset_rate.as_array());
    let values: Vec<f64> = approaches
        .map(|((&penetration, &rate), &onset_rate)| {
            evaluate(Approach {
                penetration,
                rate,
                onset_rate,
            })
        })
        .collect();
    values.into_pyarray(py)
}
