//! Parallel cylinders after Dubowsky and Freudenstein.

use std::f64::consts::E;

use chaindrive_quantities::{JsonSchema, Length, Stiffness};
use serde::{Deserialize, Serialize};

use super::logarithmic::follows_the_logarithm;
use super::{Cylinders, Elastic, OfCylinders};
use crate::ParameterError;

/// The law of Dubowsky and Freudenstein: the logarithm of [`Johnson`](super::Johnson) with another length.
///
/// ```text
/// δ = p [ln(L²/(R p)) + 1],   1/R = 1/R₁ ∓ 1/R₂
///   = p [ln(D/p) − 1],   D = e² L²/R
/// ```
///
/// Written here with its exponent m = 3, which makes the logarithm's argument a number. The length of the
/// contact stands under the logarithm, so that the force is not in proportion to it: a short roller comes out
/// stiffer than with Johnson's law, a long pin in a tight bushing 31 % softer. For comparison with
/// published results; continued from 0.9 δ_max, δ_max = L²/R, as its tangent.
///
/// # Source
/// S. Dubowsky and F. Freudenstein, *J. Eng. Ind.* **93**(1), 1971, 305–309.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DubowskyFreudenstein {
    /// Length D under the logarithm \[m\]: e² L²/R.
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length_scale: f64,
    /// Composite modulus times length of the contact, E* L \[N/m\].
    #[schemars(with = "Stiffness", extend("exclusiveMinimum" = 0))]
    pub modulus_length: f64,
}

impl DubowskyFreudenstein {
    /// Reduced radius R and contact length L \[m\], composite modulus \[Pa\].
    ///
    /// ```text
    /// D = e² L²/R
    /// ```
    pub fn of_reduced_radius(reduced: f64, length: f64, composite_modulus: f64) -> Self {
        Self {
            // D = e² L²/R
            length_scale: E * E * length * length / reduced,
            modulus_length: composite_modulus * length,
        }
    }
}

follows_the_logarithm!(DubowskyFreudenstein);

impl OfCylinders for DubowskyFreudenstein {
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError> {
        Ok(Self::of_reduced_radius(pair.reduced_radius(), pair.length, pair.modulus).into())
    }
}
