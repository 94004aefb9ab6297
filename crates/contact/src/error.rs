//! Why a law refuses one of its parameters.

use serde::{Deserialize, Deserializer};

/// A parameter outside its range: which one, its value, and what is allowed.
///
/// Reads as the tail of a path, so that a caller can put the place in front:
/// `restitution = 1.4, must be in (0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{parameter} = {value}, must be {allowed}")]
pub struct ParameterError {
    /// Name of the parameter, as its field is called.
    pub parameter: &'static str,
    /// The value that was refused.
    pub value: f64,
    /// The range it has to be in, with the unit in brackets.
    pub allowed: &'static str,
}

/// Lets a parameter pass or names it.
pub(crate) fn require(
    condition: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), ParameterError> {
    if condition {
        Ok(())
    } else {
        Err(ParameterError {
            parameter,
            value,
            allowed,
        })
    }
}

/// Lets a positive and finite parameter pass or names it.
pub(crate) fn require_positive(
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), ParameterError> {
    require(value > 0.0 && value.is_finite(), parameter, value, allowed)
}

/// Reads a member without parameters, as strictly as the others: serde alone would drop whatever it finds.
pub(crate) fn no_parameters<'de, D: Deserializer<'de>>(member: D) -> Result<(), D::Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Nothing {}

    Nothing::deserialize(member).map(|Nothing {}| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_names_parameter_value_and_range() {
        let refused = require(false, "restitution", 1.4, "in (0, 1]").unwrap_err();
        assert_eq!(refused.to_string(), "restitution = 1.4, must be in (0, 1]");
        assert!(require_positive("stiffness", f64::NAN, "positive").is_err());
        assert!(require_positive("stiffness", f64::INFINITY, "positive").is_err());
    }
}
