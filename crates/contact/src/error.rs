//! Why a law refuses one of its parameters.

use chaindrive_quantities::ParameterError;
use serde::{Deserialize, Deserializer};

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
            parameter: parameter.into(),
            value,
            allowed: allowed.into(),
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
