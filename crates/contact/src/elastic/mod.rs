//! The family of elastic laws: what an indentation costs at rest.
//!
//! To add a member write one file with its parameters and `impl ElasticLaw` and `Member`, for cylinders `OfCylinders` too, and enter it in the
//! table of this file. One that is no law of cylinders needs a [specimen](Elastic::specimens). It then inherits the tests of the family, and scenes
//! know it: name, keys, quantities and ranges are those of the struct.
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
//! are from one another is in `docs/contact-laws.md`. Other programs [register] theirs.

mod conformal;
mod curve;
mod cylinders;
mod cylindrical;
mod dubowsky_freudenstein;
mod esdu_78035;
mod johnson;
mod lambert;
mod library;
mod logarithmic;
mod power;
mod radzimovsky;
mod series;
mod specification;

pub use conformal::Conformal;
pub use cylinders::Cylinders;
pub use cylindrical::Cylindrical;
pub use dubowsky_freudenstein::DubowskyFreudenstein;
pub use esdu_78035::Esdu78035;
pub use johnson::Johnson;
pub use library::{library, register};
use logarithmic::Logarithmic;
pub use power::Power;
pub use radzimovsky::Radzimovsky;
pub(crate) use series::Stack;
pub use specification::{CurveOrBodies, Linear, Spheres, Surfaces};

use std::fmt::Debug;

use chaindrive_quantities::{Handle, JsonSchema, check};
use serde::{Deserialize, Serialize};

use crate::ParameterError;

/// Questions that every elastic law answers, be it a member of the family or [registered](register).
///
/// All functions are zero for δ ≤ 0 and consistent with each other:
///
/// ```text
/// g = dU/dδ,   k = dg/dδ
/// ```
pub trait ElasticLaw: Debug + Send + Sync + 'static {
    /// Force g \[N\] at the penetration δ \[m\], compressive; grows with δ, in equal steps or ever faster.
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

    /// Depth \[m\] from which on the law goes on as its own tangent; none where it holds at any depth.
    fn reach(&self) -> Option<f64> {
        None
    }

    /// Refuses parameters that do not go together; each by itself is held to the range above its field.
    ///
    /// # Errors
    /// Names the first of them.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

/// Curve of an elastic law once its member has supplied the constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Curve {
    /// g = K δ
    Linear(f64),
    /// g = K δ √δ
    Hertz(f64),
    /// g = K δⁿ
    Power(Power),
    /// δ = p [ln(D/p) − 1]
    Logarithmic(Logarithmic),
    /// A law without constants to work out, asked as it is.
    Plain(Elastic),
}

/// A member of the family, beside its curve.
pub(crate) trait Member: Copy + Into<Elastic> {
    /// The law with its constants worked out, for loops. A law without any is asked as it is.
    fn curve(&self) -> Curve {
        Curve::Plain((*self).into())
    }
}

/// A member that two parallel cylinders make.
pub(crate) trait OfCylinders: Member {
    /// The law of the pair, or another one to which it hands over there.
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError>;
}

macro_rules! family {
    (
        curves { $($(#[$curve_doc:meta])* $curve:ident;)* }
        cylinders { $($(#[$doc:meta])* $law:ident;)* }
    ) => {
        /// An elastic law, chosen at run time.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "kebab-case", remote = "Self")]
        pub enum Elastic {
            $($(#[$curve_doc])* $curve($curve),)*
            $($(#[$doc])* $law($law),)*
            /// A law of another program.
            #[serde(skip)]
            Registered(Handle<dyn ElasticLaw>),
        }

        /// A law of the family, to be built from the geometry of two parallel cylinders.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum CylinderLaw {
            $($(#[$doc])* $law,)*
            /// [`Power::hertz`] with the reduced radius: a point contact, several times too soft for a line, as the
            /// elastic part of Lankarani and Nikravesh is often used.
            Hertz,
        }

        /// An elastic law as an engineer specifies it: by its curve, or by the bodies that touch.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "kebab-case", remote = "Self")]
        #[schemars(rename = "Elastic")]
        pub enum Specification {
            /// A spring.
            Linear(Linear),
            $($(#[$curve_doc])* $curve($curve),)*
            /// Hertz's point contact of two bodies of one material. Too soft for cylinders.
            Hertz(Spheres),
            $($(#[$doc])* $law(Surfaces),)*
            /// A law of another program.
            #[serde(skip)]
            Registered(Handle<dyn ElasticLaw>),
        }

        impl CylinderLaw {
            /// Every law, for tests and tables.
            pub const ALL: &[Self] = &[$(Self::$law,)* Self::Hertz];

            fn of(self, pair: &Cylinders) -> Result<Elastic, ParameterError> {
                match self {
                    $(Self::$law => $law::between(pair),)*
                    Self::Hertz => Ok(Power::hertz(pair.reduced_radius(), pair.modulus).into()),
                }
            }
        }

        impl Specification {
            /// The law where its own curve is specified, otherwise which law of which bodies.
            pub fn given(self) -> CurveOrBodies {
                match self {
                    Self::Linear(Linear { stiffness }) => CurveOrBodies::Curve(Power::linear(stiffness).into()),
                    $(Self::$curve(law) => CurveOrBodies::Curve(law.into()),)*
                    Self::Hertz(bodies) => CurveOrBodies::Bodies(CylinderLaw::Hertz, bodies.into()),
                    $(Self::$law(bodies) => CurveOrBodies::Bodies(CylinderLaw::$law, bodies),)*
                    Self::Registered(law) => CurveOrBodies::Curve(law.into()),
                }
            }

            /// Refuses parameters outside the range of the law or the bodies.
            ///
            /// # Errors
            /// Names the first parameter outside its range.
            pub fn check(&self) -> Result<(), ParameterError> {
                match self {
                    Self::Registered(law) => law.check(),
                    own => check(own),
                }
            }
        }

        $(
            impl From<$curve> for Elastic {
                fn from(law: $curve) -> Self {
                    Self::$curve(law)
                }
            }
        )*
        $(
            impl From<$law> for Elastic {
                fn from(law: $law) -> Self {
                    Self::$law(law)
                }
            }
        )*

        /// Runs an expression on the member behind the enum.
        macro_rules! each {
            ($elastic:expr, $member:ident, $answer:expr) => {
                match $elastic {
                    $(Elastic::$curve($member) => $answer,)*
                    $(Elastic::$law($member) => $answer,)*
                    Elastic::Registered($member) => $answer,
                }
            };
        }
    };
}

family! {
    curves {
        /// A power of the penetration: linear, Hertzian, or fitted.
        Power;
    }
    cylinders {
        /// Johnson's law for parallel cylinders, D = 4ΔR.
        Johnson;
        /// Johnson's law, extended to wide contacts in a hollow. A flat or convex counterpart does not conform: its law **is** Johnson's.
        Conformal;
        /// Radzimovsky's law for parallel cylinders, D = e^{5/3} ΔR.
        Radzimovsky;
        /// The law of ESDU 78035 for parallel cylinders, D = 4e² ΔR.
        #[serde(rename = "esdu-78035")]
        Esdu78035;
        /// The law of Dubowsky and Freudenstein for parallel cylinders, D = e² L²/R; needs no depth.
        DubowskyFreudenstein;
        /// The enhanced cylindrical law of Pereira, Ramalho and Ambrósio: a power fitted to Johnson's, for a clearance of 5 µm to 10 mm, or radii of
        /// 4 mm to 300 mm in sum. It is refused below, and beyond, towards a flat, where it has no limit, the law **is** Johnson's.
        Cylindrical;
    }
}

impl ElasticLaw for Elastic {
    #[inline]
    fn force(&self, penetration: f64) -> f64 {
        each!(self, law, law.force(penetration))
    }

    #[inline]
    fn stiffness(&self, penetration: f64) -> f64 {
        each!(self, law, law.stiffness(penetration))
    }

    #[inline]
    fn energy(&self, penetration: f64) -> f64 {
        each!(self, law, law.energy(penetration))
    }

    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        each!(self, law, law.pair(penetration))
    }

    fn reach(&self) -> Option<f64> {
        each!(self, law, law.reach())
    }
}

impl Elastic {
    /// The law with its constants worked out.
    pub(crate) fn curve(&self) -> Curve {
        each!(self, law, law.curve())
    }

    /// Refuses parameters outside the range of the law.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Registered(law) => law.check(),
            own => check(own),
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

impl CylinderLaw {
    /// The law of two cylinders. Where a law hands over to Johnson's is part of its description above,
    /// and the answer says which law it is.
    ///
    /// # Errors
    /// Names a parameter of the geometry that is impossible or outside the range of the law.
    pub fn between(self, pair: &Cylinders) -> Result<Elastic, ParameterError> {
        pair.check()?;
        let elastic = self.of(pair)?;
        elastic.check()?;
        Ok(elastic)
    }
}
