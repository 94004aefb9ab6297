//! The family of elastic laws: what an indentation costs at rest.
//!
//! To add a member write one file with its parameters and `impl ElasticLaw`, and enter it in the
//! four places of this file: `mod`, the variant, the arm of `each!`, and
//! [`specimens`](Elastic::specimens). It then inherits the tests of the family.

mod johnson;
mod lambert;
mod power;

pub use johnson::Johnson;
pub use power::Power;

use serde::{Deserialize, Serialize};

use crate::ParameterError;

/// What every elastic law can be asked; kernels that fix the law outside their loop are generic over it.
///
/// All three functions are zero for δ ≤ 0 and consistent with each other:
///
/// ```text
/// g = dU/dδ,   k = dg/dδ
/// ```
pub trait ElasticLaw: Copy {
    /// Force g \[N\] at the penetration δ \[m\], compressive; grows with δ.
    fn force(&self, penetration: f64) -> f64;

    /// Tangent stiffness k = dg/dδ \[N/m\] at the penetration δ \[m\].
    fn stiffness(&self, penetration: f64) -> f64;

    /// Stored energy U = ∫ g dδ \[J\] at the penetration δ \[m\].
    fn energy(&self, penetration: f64) -> f64;

    /// Refuses parameters outside the range of the law.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    fn check(&self) -> Result<(), ParameterError>;
}

/// An elastic law, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Elastic {
    /// A power of the penetration: linear, Hertzian, or fitted.
    Power(Power),
    /// Two parallel cylinders after Johnson.
    Johnson(Johnson),
}

/// Runs an expression on the member behind the enum.
macro_rules! each {
    ($law:expr, $member:ident => $answer:expr) => {
        match $law {
            Elastic::Power($member) => $answer,
            Elastic::Johnson($member) => $answer,
        }
    };
}

impl ElasticLaw for Elastic {
    #[inline]
    fn force(&self, penetration: f64) -> f64 {
        each!(self, law => law.force(penetration))
    }

    #[inline]
    fn stiffness(&self, penetration: f64) -> f64 {
        each!(self, law => law.stiffness(penetration))
    }

    #[inline]
    fn energy(&self, penetration: f64) -> f64 {
        each!(self, law => law.energy(penetration))
    }

    fn check(&self) -> Result<(), ParameterError> {
        each!(self, law => law.check())
    }
}

impl Elastic {
    /// At least one law of every kind, with parameters of real chains, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        vec![
            Self::Power(Power {
                stiffness: 1e8,
                exponent: 1.0,
            }),
            Self::Power(Power {
                stiffness: 8.5e8,
                exponent: 1.08,
            }),
            Self::Power(Power {
                stiffness: 6.61e10,
                exponent: 1.5,
            }),
            Self::Johnson(Johnson::internal(1.85e-3, 1.80e-3, 4.5e-3, 113.7e9)),
            Self::Johnson(Johnson::external(3.875e-3, 18.6e-3, 2.2e-3, 113.7e9)),
        ]
    }
}
