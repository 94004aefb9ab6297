//! Parallel cylinders after Johnson, solved explicitly for the force.

use chaindrive_quantities::{JsonSchema, Length, Stiffness};
use serde::{Deserialize, Serialize};

use super::logarithmic::follows_the_logarithm;
use super::{Cylinders, Elastic, OfCylinders};
use crate::ParameterError;

/// Johnson's law for two parallel cylinders, inside or outside one another.
///
/// ```text
/// δ = p [ln(D/p) − 1],   p = g/(π E* L),   D = 4ΔR
///
/// g = π E* L δ/u,   k = π E* L/(u − 1),   U = π E* L p² (2u − 1)/4,
/// u = −W₋₁(−e δ/D),  that is  u − ln u = 1 + ln(δ_max/δ),   δ_max = D/e²
/// ```
///
/// ΔR is the clearance of a pin in its bushing or the sum of the radii of two
/// cylinders side by side. Written with Lambert's function the law needs no iteration on the force.
///
/// The theory supposes a contact narrow against the radii: the force is 2 % too large at δ = 0.10 ΔR and
/// 4.5 % at 0.16 ΔR. Its stiffness is infinite at δ_max = 0.541 ΔR and there is no force
/// beyond. **From 0.9 δ_max on the law continues as its own tangent**, with the stiffness 1.88 π E* L: force,
/// stiffness and energy are continuous, the force keeps growing, and a collision that is too hard yields a
/// large number and not NaN. Results from that range are no prediction. A pin pressed deep into
/// its hole is [`Conformal`](super::Conformal)'s.
///
/// # Source
/// K. L. Johnson, *Contact Mechanics*, Cambridge University Press, 1985, section 5.6; form for a pair:
/// C. M. Pereira, A. L. Ramalho and J. A. Ambrósio, *Nonlinear Dyn.* **63**, 2011, 681–697,
/// <https://doi.org/10.1007/s11071-010-9830-3>.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Johnson {
    /// Length D under the logarithm \[m\]: 4ΔR.
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length_scale: f64,
    /// Composite modulus times length of the contact, E* L \[N/m\].
    #[schemars(with = "Stiffness", extend("exclusiveMinimum" = 0))]
    pub modulus_length: f64,
}

impl Johnson {
    /// A pin in a hole: radii and contact length \[m\], composite modulus \[Pa\].
    ///
    /// ```text
    /// D = 4 (R_hole − R_pin)
    /// ```
    ///
    /// A pin without clearance gives D ≤ 0, which [`check`](super::Elastic::check) refuses.
    pub fn internal(hole: f64, pin: f64, length: f64, composite_modulus: f64) -> Self {
        Self {
            // D = 4 (R_hole − R_pin)
            length_scale: 4.0 * (hole - pin),
            modulus_length: composite_modulus * length,
        }
    }

    /// Two cylinders side by side: radii and contact length \[m\], composite modulus \[Pa\].
    ///
    /// ```text
    /// D = 4 (R₁ + R₂)
    /// ```
    pub fn external(radius: f64, other: f64, length: f64, composite_modulus: f64) -> Self {
        Self {
            // D = 4 (R₁ + R₂)
            length_scale: 4.0 * (radius + other),
            modulus_length: composite_modulus * length,
        }
    }

    /// A cylinder on a flat: radius and contact length \[m\], composite modulus \[Pa\].
    ///
    /// ```text
    /// D = 4 R
    /// ```
    ///
    /// Exact on a rigid flat. The approach of an elastic half-plane grows without bound with
    /// the depth it is measured to; the same D then stands for a depth of
    /// 2R exp[½ (ν/(1−ν) − 1)], 1.5 R in steel: a rail about as thick as the roller.
    /// [`Cylinders::on_curve`](super::Cylinders::on_curve) takes the depth as a parameter.
    pub fn flat(radius: f64, length: f64, composite_modulus: f64) -> Self {
        // D = 4 R
        Self::external(radius, 0.0, length, composite_modulus)
    }
}

follows_the_logarithm!(Johnson);

impl OfCylinders for Johnson {
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError> {
        Ok(Self {
            // D = 4ΔR
            length_scale: 4.0 * pair.effective_radii(),
            modulus_length: pair.modulus * pair.length,
        }
        .into())
    }
}
