//! Contact laws on arrays.

use chaindrive_contact::elastic::{CylinderLaw, Cylinders};
use chaindrive_contact::{Approach, Dissipation, Response, restitution};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use serde_json::Value;

use crate::errors::{OrRaise, parameter};

/// A contact law.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Law(pub(crate) chaindrive_contact::Law);

pub(crate) type Values<'py> = PyReadonlyArray1<'py, f64>;
pub(crate) type Answer<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl Law {
    /// A law from its parameters as JSON.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let law: chaindrive_contact::Law =
            serde_json::from_str(text).map_err(|error| refused(&error, "law", "a contact law"))?;
        law.check().or_raise()?;
        Ok(Self(law))
    }

    /// A law of two parallel cylinders; the dissipation as JSON.
    #[staticmethod]
    fn between(
        kind: &str,
        arrangement: &str,
        measures: Vec<f64>,
        length: f64,
        modulus: f64,
        dissipation: &str,
        onset_floor: f64,
    ) -> PyResult<Self> {
        let pair = match (arrangement, measures.as_slice()) {
            ("pin_in_hole", &[hole, pin]) => Cylinders::pin_in_hole(hole, pin, length, modulus),
            ("side_by_side", &[radius, other]) => {
                Cylinders::side_by_side(radius, other, length, modulus)
            }
            ("on_curve", &[radius, curvature, depth_cap]) => {
                Cylinders::on_curve(radius, curvature, length, modulus, depth_cap)
            }
            _ => {
                let message = format!("{arrangement} with {} measures", measures.len());
                return Err(parameter(message, "cylinders", "an arrangement"));
            }
        };
        let cylinders: CylinderLaw = serde_json::from_value(Value::from(kind))
            .map_err(|error| refused(&error, "kind", "a law of two cylinders"))?;
        let dissipation: Dissipation = serde_json::from_str(dissipation)
            .map_err(|error| refused(&error, "dissipation", "a dissipation"))?;
        let law = chaindrive_contact::Law {
            series: None,
            elastic: cylinders.between(&pair).or_raise()?,
            dissipation,
            onset_floor,
        };
        law.check().or_raise()?;
        Ok(Self(law))
    }

    /// The parameters as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0)
            .map_err(|error| parameter(error.to_string(), "law", "finite"))
    }

    /// Damping factor and delivered restitution of a hysteretic law.
    fn hysteresis(&self) -> Option<(f64, f64)> {
        let factor = self.0.dissipation.factor()?;
        Some((factor, restitution::delivered(factor)))
    }

    /// Force, its elastic part, stiffness and damping at penetrations, closing speeds and closing
    /// speeds at onset of one length.
    fn respond<'py>(
        &self,
        py: Python<'py>,
        penetration: Values<'py>,
        rate: Values<'py>,
        onset_rate: Values<'py>,
    ) -> [Answer<'py>; 4] {
        let responses = self.responses([penetration, rate, onset_rate]);
        let each = |part: fn(&Response) -> f64| -> Answer<'py> {
            let values: Vec<f64> = responses.iter().map(part).collect();
            values.into_pyarray(py)
        };
        [
            each(|response| response.force),
            each(|response| response.elastic),
            each(|response| response.stiffness),
            each(|response| response.damping),
        ]
    }

    /// Stored energy.
    fn energy<'py>(&self, py: Python<'py>, penetration: Values<'py>) -> Answer<'py> {
        let law = self.0.prepared();
        penetration
            .as_array()
            .mapv(|depth| law.energy(depth))
            .into_pyarray(py)
    }
}

impl Law {
    fn responses(&self, [penetration, rate, onset_rate]: [Values<'_>; 3]) -> Vec<Response> {
        let law = self.0.prepared();
        let (penetration, rate) = (penetration.as_array(), rate.as_array());
        let approaches = penetration.iter().zip(rate).zip(onset_rate.as_array());
        approaches
            .map(|((&penetration, &rate), &onset_rate)| {
                law.respond(Approach {
                    penetration,
                    rate,
                    onset_rate,
                })
            })
            .collect()
    }
}

/// A parameter error from JSON that is not what was expected; places in the text mean nothing to the caller.
pub(crate) fn refused(error: &serde_json::Error, path: &str, allowed: &str) -> PyErr {
    let message = error.to_string();
    let message = message.split(" at line").next().unwrap_or_default();
    let told = match message
        .strip_prefix("invalid type: ")
        .and_then(|rest| rest.split_once(", expected "))
    {
        Some((found, "f64")) => format!("{path}: found {found}, needed is a number"),
        Some((found, needed)) => format!("{path}: found {found}, needed is {needed}"),
        None => message
            .replace("missing field", "missing is")
            .replace("unknown field", "unknown is")
            .replace("unknown variant", "unknown is"),
    };
    parameter(told, path, allowed)
}
