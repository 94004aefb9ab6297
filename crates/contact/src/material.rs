//! Elastic constants of one body and the composite modulus of a pair.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::require;

/// Elastic constants of an isotropic material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Elasticity {
    /// Young's modulus E \[Pa\], positive; infinite for a rigid body.
    pub modulus: f64,
    /// Poisson's ratio ν \[–\], in (−1, 0.5].
    pub poisson: f64,
}

impl Elasticity {
    /// Steel: E = 207 GPa, ν = 0.3.
    pub const STEEL: Self = Self {
        modulus: 207e9,
        poisson: 0.3,
    };

    /// A body that does not deform.
    pub const RIGID: Self = Self {
        modulus: f64::INFINITY,
        poisson: 0.0,
    };

    /// Composite modulus of two bodies in contact \[Pa\].
    ///
    /// ```text
    /// 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
    /// ```
    ///
    /// Plane strain on both sides. Infinite if both bodies are rigid, which the laws refuse.
    ///
    /// # Source
    /// K. L. Johnson, *Contact Mechanics*, Cambridge University Press, 1985, section 4.2.
    pub fn composite(self, other: Self) -> f64 {
        // 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
        1.0 / (self.compliance() + other.compliance())
    }

    /// Plane-strain compliance (1 − ν²)/E \[1/Pa\].
    fn compliance(self) -> f64 {
        (1.0 - self.poisson * self.poisson) / self.modulus
    }

    /// Refuses constants no stable material has.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        let Self { modulus, poisson } = *self;
        require(modulus > 0.0, "modulus", modulus, "positive [Pa]")?;
        require(
            poisson > -1.0 && poisson <= 0.5,
            "poisson",
            poisson,
            "in (-1, 0.5]",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steel_on_steel_and_on_a_rigid_body() {
        let pair = Elasticity::STEEL.composite(Elasticity::STEEL);
        assert!((pair / 113.736_263_736_263_73e9 - 1.0).abs() < 1e-14);
        let single = Elasticity::STEEL.composite(Elasticity::RIGID);
        assert!((single / pair - 2.0).abs() < 1e-14);
    }

    #[test]
    fn impossible_constants_are_named() {
        let soft = Elasticity {
            modulus: -1.0,
            poisson: 0.3,
        };
        assert_eq!(soft.check().unwrap_err().parameter, "modulus");
        let auxetic = Elasticity {
            modulus: 1.0,
            poisson: 0.6,
        };
        assert_eq!(auxetic.check().unwrap_err().parameter, "poisson");
        assert!(Elasticity::STEEL.check().is_ok() && Elasticity::RIGID.check().is_ok());
    }
}
