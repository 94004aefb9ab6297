//! Force laws of two surfaces in contact: functions of indentation, rate and slip.
//!
//! A contact is made of three independent choices, and each is a family with one file per member:
//!
//! | choice | members | answers |
//! |---|---|---|
//! | [`Elastic`] | [linear, Hertz, power](elastic::Power), [Johnson](elastic::Johnson) and [its relatives](elastic) | force g(δ), tangent stiffness, stored energy |
//! | [`Dissipation`] | none, [nine hysteretic factors](dissipation), [Kelvin–Voigt](dissipation::Viscous) | what the closing speed makes of g |
//! | [`Friction`] | none, [Coulomb](friction::Coulomb) and [five others](friction) | tangential force from normal force and slip |
//!
//! A [`Law`] joins an elastic law and a dissipation; a Kelvin–Voigt element, for example, is a linear
//! [`Power`](elastic::Power) with a [`Viscous`](dissipation::Viscous) damper. Kernels keep the law
//! [`PreparedLaw`] and take force, stiffness and damping from one [`Response`]; the laws of two cylinders are built
//! from their geometry by [`CylinderLaw::between`](elastic::CylinderLaw::between).
//!
//! # Conventions
//!
//! Penetration δ is positive in contact, rates are positive while the surfaces close, a normal
//! force is compressive and never negative. Everything is in SI units. Laws know no body, no
//! shape and no time: what a contact remembers, the speed at which it began, is an argument
//! ([`Approach::onset_rate`]) and is kept by the caller.
//!
//! # Example
//!
//! ```
//! use chaindrive_contact::{Approach, Dissipation, Elastic, Law};
//! use chaindrive_contact::{dissipation::LankaraniNikravesh, elastic::Power};
//!
//! let law = Law {
//!     series: None,
//!     elastic: Elastic::Power(Power { stiffness: 6.61e10, exponent: 1.5 }),
//!     dissipation: Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.9 }),
//!     onset_floor: 1e-3,
//! };
//! law.check()?;
//! let closing = law.force(Approach { penetration: 1e-5, rate: 0.5, onset_rate: 1.0 });
//! let opening = law.force(Approach { penetration: 1e-5, rate: -0.5, onset_rate: 1.0 });
//! assert!(closing > law.elastic_force(1e-5) && law.elastic_force(1e-5) > opening);
//! # Ok::<(), chaindrive_contact::ParameterError>(())
//! ```

pub mod dissipation;
pub mod elastic;
mod error;
pub mod film;
pub mod friction;
mod law;
pub mod lubricant;
pub mod material;
pub mod onset;
pub mod restitution;

pub use chaindrive_quantities::ParameterError;
pub use dissipation::Dissipation;
pub use elastic::Elastic;
pub use film::Film;
pub use friction::{Friction, Rub};
pub use law::{Approach, Law, PreparedLaw, Response};
pub use lubricant::Lubricant;
pub use material::Elasticity;
pub use onset::interpolated_onset;

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
