//! The family of elastic laws: what an indentation costs at rest.
//!
//! To add a member write one file with its parameters and `impl ElasticLaw`, and enter it in the
//! five places of this file: `mod`, the variant, the arm of `each!`, its `Curve`, and
//! [`specimens`](Elastic::specimens). It then inherits the tests of the family.
//!
//! | law | `kind` | what it is | range |
//! |---|---|---|---|
//! | [`Power`] | `power` | K δⁿ: a linear spring, a fitted curve | any |
//! | [`Power::hertz`] | `power` | point contact, n = 1.5 | surfaces that touch in a point |
//! | [`Johnson`] | `johnson` | parallel cylinders, the reference | δ ≤ 0.16 ΔR to 4.5 % |
//! | [`Conformal`] | `conformal` | Johnson, extended to wide contacts in a hole | δ ≤ 1.59 ΔR |
//! | [`Radzimovsky`] | `radzimovsky` | Johnson with D = 5.294 ΔR | δ < 0.716 ΔR |
//! | [`Esdu78035`] | `esdu-78035` | Johnson with D = 29.56 ΔR | δ < 4 ΔR |
//! | [`DubowskyFreudenstein`] | `dubowsky-freudenstein` | Johnson with D = e² L²/R | δ < L²/R |
//! | [`Cylindrical`] | `cylindrical` | a power fitted to Johnson | ΔR 0.005–10 mm inside, 4–300 mm outside |
//!
//! [`CylinderLaw::between`] builds those of cylinders from radii and lengths. What they cost and how far they
//! are from one another is in `docs/contact-laws.md`.

mod conformal;
mod curve;
mod cylinders;
mod cylindrical;
mod dubowsky_freudenstein;
mod esdu_78035;
mod johnson;
mod lambert;
mod logarithmic;
mod power;
mod radzimovsky;
mod stack;

pub use conformal::Conformal;
pub(crate) use curve::Curve;
pub use cylinders::{CylinderLaw, Cylinders};
pub use cylindrical::Cylindrical;
pub use dubowsky_freudenstein::DubowskyFreudenstein;
pub use esdu_78035::Esdu78035;
pub use johnson::Johnson;
pub use power::Power;
pub use radzimovsky::Radzimovsky;
pub(crate) use stack::Stack;

use serde::{Deserialize, Serialize};

use crate::ParameterError;

/// Questions that every elastic law answers; kernels that fix the law outside their loop are generic over it.
///
/// All functions are zero for δ ≤ 0 and consistent with each other:
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

    /// Force \[N\] and tangent stiffness \[N/m\] at once, for the price of one where a law can.
    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        (self.force(penetration), self.stiffness(penetration))
    }

    /// Refuses parameters outside the range of the law.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    fn check(&self) -> Result<(), ParameterError>;
}

/// An elastic law, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Elastic {
    /// A power of the penetration: linear, Hertzian, or fitted.
    Power(Power),
    /// Two parallel cylinders after Johnson.
    Johnson(Johnson),
    /// A pin in a hole, narrow or wide contact.
    Conformal(Conformal),
    /// Two parallel cylinders after Radzimovsky.
    Radzimovsky(Radzimovsky),
    /// Two parallel cylinders after ESDU 78035.
    #[serde(rename = "esdu-78035")]
    Esdu78035(Esdu78035),
    /// Two parallel cylinders after Dubowsky and Freudenstein.
    DubowskyFreudenstein(DubowskyFreudenstein),
    /// Two parallel cylinders after Pereira, Ramalho and Ambrósio.
    Cylindrical(Cylindrical),
}

/// Runs an expression on the member behind the enum.
macro_rules! each {
    ($law:expr, $member:ident => $answer:expr) => {
        match $law {
            Elastic::Power($member) => $answer,
            Elastic::Johnson($member) => $answer,
            Elastic::Conformal($member) => $answer,
            Elastic::Radzimovsky($member) => $answer,
            Elastic::Esdu78035($member) => $answer,
            Elastic::DubowskyFreudenstein($member) => $answer,
            Elastic::Cylindrical($member) => $answer,
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

    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        each!(self, law => law.pair(penetration))
    }

    fn check(&self) -> Result<(), ParameterError> {
        each!(self, law => law.check())
    }
}

impl Elastic {
    /// Depth \[m\] from which on a law that is asked as it is goes on as its own tangent.
    fn reach(&self) -> Option<f64> {
        match self {
            Self::Conformal(law) => Some(law.reach()),
            Self::Power(_)
            | Self::Johnson(_)
            | Self::Radzimovsky(_)
            | Self::Esdu78035(_)
            | Self::DubowskyFreudenstein(_)
            | Self::Cylindrical(_) => None,
        }
    }

    /// The law with its constants worked out.
    pub(crate) fn curve(&self) -> Curve {
        match self {
            Self::Power(law) => Curve::of_power(*law),
            Self::Johnson(law) => Curve::Logarithmic(law.curve()),
            Self::Conformal(_) => Curve::Plain(*self),
            Self::Radzimovsky(law) => Curve::Logarithmic(law.curve()),
            Self::Esdu78035(law) => Curve::Logarithmic(law.curve()),
            Self::DubowskyFreudenstein(law) => Curve::Logarithmic(law.curve()),
            Self::Cylindrical(law) => Curve::of_power(law.power()),
        }
    }

    /// At least one law of every kind, with parameters of real chains, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        let mut laws = vec![
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
        ];
        let pairs = [
            Cylinders::pin_in_hole(1.85e-3, 1.80e-3, 4.5e-3, 113.7e9),
            Cylinders::side_by_side(3.875e-3, 18.6e-3, 2.2e-3, 113.7e9),
        ];
        for law in CylinderLaw::ALL {
            for pair in &pairs {
                let built = law.between(pair).ok();
                laws.extend(built.filter(|built| !laws.contains(built)));
            }
        }
        laws
    }
}
