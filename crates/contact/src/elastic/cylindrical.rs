//! The enhanced cylindrical law of Pereira, Ramalho and Ambrósio.

use chaindrive_quantities::{ContactStiffness, JsonSchema, Ratio};
use serde::{Deserialize, Serialize};

use super::{Curve, Cylinders, Elastic, ElasticLaw, Johnson, Member, OfCylinders, Power};
use crate::ParameterError;
use crate::error::require;

/// Clearances \[mm\] at which the internal form may be used.
const INTERNAL: [f64; 2] = [0.005, 10.0];

/// Sums of radii \[mm\] at which the external form may be used.
const EXTERNAL: [f64; 2] = [4.0, 300.0];

/// Clearance \[mm\] at which the exponent changes its formula; both give 1.156278.
const BRANCH: f64 = 0.349_54;

/// Room for rounding at the ends of a range \[–\].
const ROUNDING: f64 = 1e-9;

/// The enhanced cylindrical law: a power fitted to Johnson's law by Pereira, Ramalho and Ambrósio.
///
/// ```text
/// g = (a ΔR + b) L E*/ΔR · δⁿ                     mm, N, MPa
///
/// internal   ΔR = R_hole − R_pin   a = 0.965   b = 0.0965   n = Y ΔR^(−0.005)
/// external   ΔR = R₁ + R₂          a = 0.39    b = 0.85     n = 1.094
///
/// Y = 1.51 [ln(1000 ΔR)]^(−0.151)    0.005 mm ≤ ΔR < 0.34954 mm
/// Y = 0.0151 ΔR + 1.151              0.34954 mm ≤ ΔR ≤ 10 mm
/// ```
///
/// The fit holds in millimetres, newtons and megapascals only; the constructors convert once, to K in N/mⁿ.
/// It follows [`Johnson`](super::Johnson) to about 5 % in the mean and 15 % at worst where chains work, and
/// less well elsewhere: inside it is 7 % to 19 % too soft at 0.1 µm and 21 % to 50 % at 0.01 µm. In a
/// tight joint under high load it is nearer to the exact solution than Johnson's law is, see
/// [`Conformal`](super::Conformal).
///
/// # Range
/// Internal: clearances of 0.005 mm to 10 mm, as published. External: no range is published; sums of radii of
/// 4 mm to 300 mm are accepted, between which the error against Johnson stays near 10 % (at 2 mm it
/// is 40 %, and towards a flat the stiffness has the wrong limit).
///
/// # Source
/// C. Pereira, A. Ramalho and J. Ambrósio, *Multibody Syst. Dyn.* **35**, 2015, 277–298,
/// <https://doi.org/10.1007/s11044-015-9463-x>; constants as in the program *DyS* of the Ladisk laboratory, with the
/// second branch of Y in millimetres, without which Y would jump.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylindrical {
    /// Stiffness K \[N/mⁿ\], n being the exponent.
    #[schemars(with = "ContactStiffness", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Exponent n \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 1.09, "maximum" = 1.45, "x-remedy" = "the formulas give no other, take power"))]
    pub exponent: f64,
}

impl Cylindrical {
    /// A pin in a hole: radii and contact length \[m\], composite modulus \[Pa\].
    ///
    /// # Errors
    /// The clearance is not between 0.005 mm and 10 mm.
    pub fn internal(
        hole: f64,
        pin: f64,
        length: f64,
        composite_modulus: f64,
    ) -> Result<Self, ParameterError> {
        let clearance = hole - pin;
        require(
            within(1e3 * clearance, INTERNAL),
            "clearance",
            clearance,
            "in [5e-6, 0.01] [m] for the internal cylindrical law; take johnson or conformal",
        )?;
        let d = 1e3 * clearance;
        let y = if d < BRANCH {
            // Y = 1.51 [ln(1000 ΔR)]^(−0.151)
            1.51 * (1e3 * d).ln().powf(-0.151)
        } else {
            // Y = 0.0151 ΔR + 1.151
            0.0151 * d + 1.151
        };
        // n = Y ΔR^(−0.005)
        let exponent = y * d.powf(-0.005);
        let share = (0.965 * d + 0.0965) / d;
        Ok(Self::converted(share, exponent, length, composite_modulus))
    }

    /// Two cylinders side by side: radii and contact length \[m\], composite modulus \[Pa\].
    ///
    /// # Errors
    /// The sum of the radii is not between 4 mm and 300 mm.
    pub fn external(
        radius: f64,
        other: f64,
        length: f64,
        composite_modulus: f64,
    ) -> Result<Self, ParameterError> {
        let sum = radius + other;
        require(
            within(1e3 * sum, EXTERNAL),
            "radius",
            sum,
            "in [0.004, 0.3] [m], summed, for the external cylindrical law; take johnson",
        )?;
        let d = 1e3 * sum;
        let share = (0.39 * d + 0.85) / d;
        Ok(Self::converted(share, 1.094, length, composite_modulus))
    }

    /// Whether a hollow \[m\] is too flat for the internal form.
    fn is_nearly_flat_inside(clearance: f64) -> bool {
        1e3 * clearance > INTERNAL[1] * (1.0 + ROUNDING)
    }

    /// Whether a bulge \[m\] is too flat for the external form.
    fn is_nearly_flat_outside(sum: f64) -> bool {
        1e3 * sum > EXTERNAL[1] * (1.0 + ROUNDING)
    }

    /// K and n from the share (a ΔR + b)/ΔR, in SI units.
    fn converted(share: f64, exponent: f64, length: f64, composite_modulus: f64) -> Self {
        // K [N/mmⁿ] = share · L [mm] · E* [MPa],   K [N/mⁿ] = 1000ⁿ K [N/mmⁿ]
        let per_millimetre = share * (1e3 * length) * (1e-6 * composite_modulus);
        Self {
            stiffness: per_millimetre * 1e3_f64.powf(exponent),
            exponent,
        }
    }

    /// The same curve as a power law.
    #[inline]
    fn power(self) -> Power {
        Power {
            stiffness: self.stiffness,
            exponent: self.exponent,
        }
    }
}

/// Whether a length \[mm\] lies in a range, ends included.
fn within(length: f64, [least, most]: [f64; 2]) -> bool {
    length >= least * (1.0 - ROUNDING) && length <= most * (1.0 + ROUNDING)
}

impl ElasticLaw for Cylindrical {
    #[inline]
    fn force(&self, penetration: f64) -> f64 {
        self.power().force(penetration)
    }

    #[inline]
    fn stiffness(&self, penetration: f64) -> f64 {
        self.power().stiffness(penetration)
    }

    #[inline]
    fn energy(&self, penetration: f64) -> f64 {
        self.power().energy(penetration)
    }

    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        self.power().pair(penetration)
    }
}

impl Member for Cylindrical {
    fn curve(&self) -> Curve {
        Curve::of_power(self.power())
    }
}

impl OfCylinders for Cylindrical {
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError> {
        let &Cylinders {
            radius,
            curvature,
            length,
            modulus,
            ..
        } = pair;
        let law = if curvature < 0.0 {
            if Self::is_nearly_flat_inside(pair.radii()) {
                return Johnson::between(pair);
            }
            Self::internal(-1.0 / curvature, radius, length, modulus)?
        } else {
            if Self::is_nearly_flat_outside(pair.radii()) {
                return Johnson::between(pair);
            }
            Self::external(radius, 1.0 / curvature, length, modulus)?
        };
        Ok(law.into())
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_quantities::check;

    use super::*;

    /// The two formulas of the exponent meet where the second takes over.
    #[test]
    fn exponent_is_continuous() {
        let exponent = |clearance_mm: f64| {
            Cylindrical::internal((10.0 + clearance_mm) * 1e-3, 0.01, 0.01, 1e11)
                .unwrap()
                .exponent
        };
        let y = exponent(BRANCH) * BRANCH.powf(0.005);
        assert!((y - 1.156_278_03).abs() < 1e-7);
        assert!((exponent(BRANCH - 1e-6) - exponent(BRANCH + 1e-6)).abs() < 1e-6);
    }

    #[test]
    fn ranges_hold_at_their_ends() {
        let internal = |mm: f64| Cylindrical::internal((20.0 + mm) * 1e-3, 0.02, 0.01, 1e11);
        let external = |mm: f64| Cylindrical::external(1e-3 * mm, 0.0, 0.01, 1e11);
        for law in [
            internal(0.005),
            internal(10.0),
            external(4.0),
            external(300.0),
        ] {
            check(&law.unwrap()).unwrap();
        }
        assert_eq!(internal(0.0049).unwrap_err().parameter, "clearance");
        assert!(internal(10.1).is_err() && external(3.9).is_err() && external(301.0).is_err());
        assert!(external(f64::NAN).is_err());
    }
}
