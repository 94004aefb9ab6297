//! The family of friction laws: tangential force from normal force and slip.
//!
//! To add a member write one file with its parameters, and enter it in `mod`, the variant, the
//! arm of `each!` and [`specimens`](Friction::specimens). Scenes know it by then: name, keys, quantities and ranges are those of the
//! struct.
//!
//! | friction | `kind` | at rest | static peak |
//! |---|---|---|---|
//! | none | `none` | | |
//! | [`Coulomb`] | `coulomb` | creeps, slope μN/v_s | no |
//! | [`Ambrosio`] | `ambrosio` | free below v₀ | no |
//! | [`Threlfall`] | `threlfall` | creeps, slope 3 μN/v_r | no |
//! | [`BengisuAkay`] | `bengisu-akay` | creeps, slope 2 μ_s N/v₀ | yes |
//! | [`BrownMcphee`] | `brown-mcphee` | creeps, slope above 4 μ_d N/v_t | yes |
//! | [`Lugre`] | `lugre` | sticks, a spring σ₀ N | yes |
//! | [`SpringSlider`] | `spring-slider` | sticks, a spring k | no |
//! | [`Stribeck`] | `stribeck` | sticks, a spring k | yes |
//!
//! Other programs [register] theirs.

mod ambrosio;
mod bengisu_akay;
mod brown_mcphee;
mod coulomb;
mod library;
mod lugre;
mod spring_slider;
mod stribeck;
mod threlfall;

pub use ambrosio::Ambrosio;
pub use bengisu_akay::BengisuAkay;
pub use brown_mcphee::BrownMcphee;
pub use coulomb::Coulomb;
pub use library::{FrictionLaw, library, register};
pub use lugre::Lugre;
pub use spring_slider::SpringSlider;
pub use stribeck::Stribeck;
pub use threlfall::Threlfall;

use chaindrive_quantities::{Handle, JsonSchema, check};
use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::{no_parameters, require};

/// The kind of a table without `kind`.
const PLAIN: &str = "coulomb";

/// A friction law, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", remote = "Self")]
#[schemars(extend("x-default-kind" = PLAIN))]
pub enum Friction {
    /// No friction.
    #[serde(deserialize_with = "no_parameters")]
    #[schemars(with = "()", extend("additionalProperties" = false))]
    None,
    /// Coulomb friction, smooth through zero slip.
    Coulomb(Coulomb),
    /// Coulomb friction that fades in between two slip speeds.
    Ambrosio(Ambrosio),
    /// Coulomb friction approached exponentially.
    Threlfall(Threlfall),
    /// A parabola up to static friction, a decay to kinetic friction.
    BengisuAkay(BengisuAkay),
    /// Static, kinetic and viscous friction in one smooth curve.
    BrownMcphee(BrownMcphee),
    /// Bristles that bend: sticking, with a state.
    Lugre(Lugre),
    /// Coulomb friction that holds elastically: with a state.
    SpringSlider(SpringSlider),
    /// A lubricated journal over its Hersey number: with a state.
    Stribeck(Stribeck),
    /// A law of another program.
    #[serde(skip)]
    Registered(Handle<dyn FrictionLaw>),
}

/// Force and state of a rubbing contact over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rub {
    /// Tangential force f \[N\], opposes the slip; with a state at the end of the step.
    pub force: f64,
    /// Damping −∂f/∂v \[N s/m\], zero where the force falls with the slip.
    pub damping: f64,
    /// State at the end of the step, to be kept when the step is accepted.
    pub state: f64,
}

/// Runs an expression on the member behind the enum, or another without friction.
macro_rules! each {
    ($friction:expr, $member:ident => $answer:expr, none => $otherwise:expr) => {
        match $friction {
            Friction::None => $otherwise,
            Friction::Coulomb($member) => $answer,
            Friction::Ambrosio($member) => $answer,
            Friction::Threlfall($member) => $answer,
            Friction::BengisuAkay($member) => $answer,
            Friction::BrownMcphee($member) => $answer,
            Friction::Lugre($member) => $answer,
            Friction::SpringSlider($member) => $answer,
            Friction::Stribeck($member) => $answer,
            Friction::Registered($member) => $answer,
        }
    };
}

impl Friction {
    /// Tangential force \[N\] under the normal force \[N\] at the slip velocity \[m/s\]; opposes the slip.
    ///
    /// A law with a state answers its steady state.
    #[inline]
    pub fn force(&self, normal: f64, slip: f64) -> f64 {
        each!(self, member => member.force(normal, slip), none => 0.0)
    }

    /// Damping −∂f/∂v \[N s/m\] at the same arguments, zero where the force falls with the slip; what limits
    /// an explicit time step.
    #[inline]
    pub fn damping(&self, normal: f64, slip: f64) -> f64 {
        each!(self, member => member.damping(normal, slip), none => 0.0)
    }

    /// Force, damping and state after rubbing for dt \[s\] at constant normal force \[N\] and slip \[m/s\].
    ///
    /// `state` is that of the last accepted step, zero for a new contact. Laws without memory ignore
    /// it and hand back zero; see [`Lugre`], [`SpringSlider`] and [`Stribeck`] for those
    /// that have it.
    #[inline]
    pub fn rub(&self, normal: f64, slip: f64, state: f64, dt: f64) -> Rub {
        match self {
            Self::Lugre(member) => member.rub(normal, slip, state, dt),
            Self::SpringSlider(member) => member.rub(normal, slip, state, dt),
            Self::Stribeck(member) => member.rub(normal, slip, state, dt),
            _ => Rub {
                force: self.force(normal, slip),
                damping: self.damping(normal, slip),
                state: 0.0,
            },
        }
    }

    /// Stiffness along the surface \[N/m\] of a contact that sticks under the normal force \[N\]; zero for laws that creep.
    pub fn stiffness(&self, normal: f64) -> f64 {
        match self {
            Self::Lugre(member) => member.stiffness * normal,
            Self::SpringSlider(member) => member.stiffness,
            Self::Stribeck(member) => member.stiffness,
            _ => 0.0,
        }
    }

    /// The law of a surface whose pressures sum to `factor` times the force that they balance: f(κ N, v).
    ///
    /// A line of contact has κ = 1; pins in bushes that have worn in have more, see `chain.joint.pressure_factor` of scenes.
    ///
    /// # Errors
    /// A law of another program that is to have another factor than 1: its parameters are its own.
    pub fn pressed(self, factor: f64) -> Result<Self, ParameterError> {
        let mut law = self;
        match &mut law {
            Self::None => {}
            Self::Coulomb(Coulomb { coefficient, .. })
            | Self::Ambrosio(Ambrosio { coefficient, .. })
            | Self::Threlfall(Threlfall { coefficient, .. })
            | Self::SpringSlider(SpringSlider { coefficient, .. }) => *coefficient *= factor,
            Self::BengisuAkay(member) => {
                member.static_coefficient *= factor;
                member.coefficient *= factor;
            }
            Self::BrownMcphee(member) => {
                member.static_coefficient *= factor;
                member.coefficient *= factor;
                member.transition_force /= factor;
            }
            Self::Lugre(member) => {
                member.static_coefficient *= factor;
                member.coefficient *= factor;
                member.stiffness *= factor;
                member.damping *= factor;
                member.viscosity *= factor;
            }
            Self::Stribeck(member) => {
                member.coefficient *= factor;
                member.transition *= factor;
            }
            Self::Registered(_) => require(
                (factor - 1.0).abs() < f64::EPSILON,
                "pressure_factor",
                factor,
                "1 with a law of another program, whose own parameters can contain it",
            )?,
        }
        Ok(law)
    }

    /// Whether the law has a state to be kept between steps.
    pub fn has_state(&self) -> bool {
        matches!(
            self,
            Self::Lugre(_) | Self::SpringSlider(_) | Self::Stribeck(_)
        )
    }

    /// Refuses parameters outside the range of the member.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(self)?;
        match *self {
            Self::Ambrosio(Ambrosio {
                lower_speed,
                upper_speed,
                ..
            }) => require(
                upper_speed > lower_speed,
                "upper_speed",
                upper_speed,
                "above lower_speed [m/s]",
            ),
            Self::BengisuAkay(BengisuAkay {
                static_coefficient,
                coefficient,
                ..
            })
            | Self::BrownMcphee(BrownMcphee {
                static_coefficient,
                coefficient,
                ..
            })
            | Self::Lugre(Lugre {
                static_coefficient,
                coefficient,
                ..
            }) => require(
                static_coefficient >= coefficient,
                "static_coefficient",
                static_coefficient,
                "at least the coefficient of sliding",
            ),
            Self::Registered(law) => law.check(),
            Self::None
            | Self::Coulomb(_)
            | Self::Threlfall(_)
            | Self::SpringSlider(_)
            | Self::Stribeck(_) => Ok(()),
        }
    }

    /// At least one law of every kind, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        vec![
            Self::None,
            Self::Coulomb(Coulomb {
                coefficient: 0.12,
                slip_speed: 0.01,
            }),
            Self::Ambrosio(Ambrosio {
                coefficient: 0.1,
                lower_speed: 1e-4,
                upper_speed: 1e-3,
            }),
            Self::Threlfall(Threlfall {
                coefficient: 0.1,
                slip_speed: 0.01,
            }),
            Self::BengisuAkay(BengisuAkay {
                static_coefficient: 0.12,
                coefficient: 0.1,
                slip_speed: 0.01,
                decay: 500.0,
            }),
            Self::BrownMcphee(BrownMcphee::dry(0.12, 0.1, 0.01)),
            Self::Lugre(Lugre {
                static_coefficient: 0.12,
                coefficient: 0.1,
                slip_speed: 0.01,
                stiffness: 1e5,
                damping: 10.0,
                viscosity: 0.0,
            }),
            Self::SpringSlider(SpringSlider {
                coefficient: 0.1,
                stiffness: 1e8,
            }),
            Self::Stribeck(Stribeck {
                coefficient: 0.1,
                transition: 1e-6,
                viscosity: 0.05,
                length: 0.02,
                relative_clearance: 0.01,
                stiffness: 1e8,
            }),
        ]
    }
}

/// A slope of the friction curve, or zero where the force falls with the slip.
fn not_below_zero(damping: f64) -> f64 {
    damping.max(0.0)
}
