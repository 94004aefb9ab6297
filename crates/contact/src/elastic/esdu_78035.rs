//! Parallel cylinders after ESDU 78035.

use std::f64::consts::E;

use chaindrive_quantities::{JsonSchema, Length, Stiffness};
use serde::{Deserialize, Serialize};

use super::logarithmic::follows_the_logarithm;
use super::{Cylinders, Elastic, OfCylinders};
use crate::ParameterError;

/// The law of ESDU 78035 for two parallel cylinders: the logarithm of [`Johnson`](super::Johnson) with another length.
///
/// ```text
/// δ = p [ln(4ΔR/p) + 1]
///   = p [ln(D/p) − 1],   D = 4 e² ΔR = 29.56 ΔR
/// ```
///
/// Softer than Johnson: by 14 % to 28 % at 1 µm, and by 45 % at 10 µm in a tight joint. Its theory ends
/// at δ_max = 4ΔR, deeper than any contact; continued from 0.9 δ_max as its tangent.
///
/// # Source
/// Engineering Sciences Data Unit, *Contact phenomena I: stresses, deflections and contact dimensions
/// for normally loaded unlubricated elastic components*, item 78035, 1978; the form for a pair as in
/// C. M. Pereira, A. L. Ramalho and J. A. Ambrósio, *Nonlinear Dyn.* **63**, 2011, 681–697,
/// <https://doi.org/10.1007/s11071-010-9830-3>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Esdu78035 {
    /// Length D under the logarithm \[m\]: 4 e² ΔR.
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length_scale: f64,
    /// Composite modulus times length of the contact, E* L \[N/m\].
    #[schemars(with = "Stiffness", extend("exclusiveMinimum" = 0))]
    pub modulus_length: f64,
}

impl Esdu78035 {
    /// ΔR \[m\]: clearance of a pin, sum of the radii side by side; contact length \[m\], composite modulus \[Pa\].
    ///
    /// ```text
    /// D = 4 e² ΔR
    /// ```
    pub fn of_radii(difference: f64, length: f64, composite_modulus: f64) -> Self {
        Self {
            // D = 4 e² ΔR
            length_scale: 4.0 * E * E * difference,
            modulus_length: composite_modulus * length,
        }
    }
}

follows_the_logarithm!(Esdu78035);

impl OfCylinders for Esdu78035 {
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError> {
        Ok(Self::of_radii(pair.effective_radii(), pair.length, pair.modulus).into())
    }
}
