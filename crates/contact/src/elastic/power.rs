//! Force as a power of the penetration.

use chaindrive_quantities::{ContactStiffness, JsonSchema, Ratio};
use serde::{Deserialize, Serialize};

use super::{Curve, ElasticLaw, Member};

/// Power law: a linear spring, Hertz's point contact, or a fitted curve.
///
/// ```text
/// g = K δⁿ,   k = n K δⁿ⁻¹,   U = K δⁿ⁺¹ / (n + 1)
/// ```
///
/// n = 1 is a linear spring; n = 1.5 is exact for non-conforming surfaces that touch in a point
/// ([`Power::hertz`]); 1.0 to 1.3 fits the line contact of pins, bushings and rollers over a decade of load, with
/// K in the odd unit N/mⁿ. For parallel cylinders [`Johnson`](super::Johnson) needs no fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Power {
    /// Stiffness K \[N/mⁿ\], n being the exponent.
    #[schemars(with = "ContactStiffness", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Exponent n \[–\]; 1 and 1.5 are computed without a general power.
    #[schemars(with = "Ratio", extend("minimum" = 1, "maximum" = 3))]
    pub exponent: f64,
}

impl Power {
    /// A linear spring of stiffness K \[N/m\].
    pub const fn linear(stiffness: f64) -> Self {
        Self {
            stiffness,
            exponent: 1.0,
        }
    }

    /// Hertz's law for a sphere of radius R \[m\] and the composite modulus E* \[Pa\].
    ///
    /// ```text
    /// K = ⁴⁄₃ E* √R,   n = 1.5
    /// ```
    ///
    /// For two bodies R is the [reduced radius](Power::hertz_pair). A point contact has no length:
    /// used for parallel cylinders the law is several times too soft.
    ///
    /// # Source
    /// K. L. Johnson, *Contact Mechanics*, Cambridge University Press, 1985, section 4.2.
    pub fn hertz(radius: f64, composite_modulus: f64) -> Self {
        Self {
            // K = ⁴⁄₃ E* √R
            stiffness: 4.0 / 3.0 * composite_modulus * radius.sqrt(),
            exponent: 1.5,
        }
    }

    /// Hertz's law for two spheres of radii \[m\], the second negative for a hollow one.
    ///
    /// ```text
    /// 1/R = 1/R₁ + 1/R₂
    /// ```
    ///
    /// An infinite second radius is a flat.
    pub fn hertz_pair(radius: f64, other: f64, composite_modulus: f64) -> Self {
        // 1/R = 1/R₁ + 1/R₂
        Self::hertz(1.0 / (1.0 / radius + 1.0 / other), composite_modulus)
    }

    /// δⁿ⁻¹, without a general power for the two exponents that matter most.
    #[inline]
    #[expect(
        clippy::float_cmp,
        reason = "an exponent is a chosen constant, not the result of arithmetic"
    )]
    fn lower_power(self, penetration: f64) -> f64 {
        if self.exponent == 1.5 {
            penetration.sqrt()
        } else if self.exponent == 1.0 {
            1.0
        } else {
            penetration.powf(self.exponent - 1.0)
        }
    }
}

impl ElasticLaw for Power {
    #[inline]
    fn force(&self, penetration: f64) -> f64 {
        // g = K δⁿ
        let depth = penetration.max(0.0);
        self.stiffness * depth * self.lower_power(depth)
    }

    #[inline]
    fn stiffness(&self, penetration: f64) -> f64 {
        if penetration > 0.0 {
            // k = n K δⁿ⁻¹
            self.exponent * self.stiffness * self.lower_power(penetration)
        } else {
            0.0
        }
    }

    #[inline]
    fn energy(&self, penetration: f64) -> f64 {
        // U = K δⁿ⁺¹ / (n + 1)
        self.force(penetration) * penetration / (self.exponent + 1.0)
    }

    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        if penetration > 0.0 {
            // g = K δ δⁿ⁻¹,   k = n K δⁿ⁻¹
            let secant = self.stiffness * self.lower_power(penetration);
            (secant * penetration, self.exponent * secant)
        } else {
            (0.0, 0.0)
        }
    }
}

impl Member for Power {
    fn curve(&self) -> Curve {
        Curve::of_power(*self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quick exponents agree with the general power next to them.
    #[test]
    fn quick_exponents_are_the_general_power() {
        for exponent in [1.0, 1.5] {
            let quick = Power {
                stiffness: 3.0e9,
                exponent,
            };
            for penetration in [1e-9_f64, 1e-6, 1e-3] {
                let general = 3.0e9 * penetration.powf(exponent);
                assert!((quick.force(penetration) / general - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn hertz_on_a_flat_and_in_a_hollow() {
        let modulus = 113.7e9;
        let flat = Power::hertz_pair(5e-3, f64::INFINITY, modulus);
        assert!((flat.stiffness / Power::hertz(5e-3, modulus).stiffness - 1.0).abs() < 1e-15);
        // 1/R = 1/5 − 1/10 [1/mm] = 1/10
        let hollow = Power::hertz_pair(5e-3, -10e-3, modulus);
        assert!((hollow.stiffness / Power::hertz(10e-3, modulus).stiffness - 1.0).abs() < 1e-14);
    }
}
