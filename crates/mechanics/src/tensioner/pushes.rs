//! Pushes as a family: this table of contents, and one file a member.
//!
//! A push is a force on a carrier that depends on its extension x, its rate ẋ, and on a state z of its own where it has one. What it
//! stores is a function of x and z; what it loses is a power.

mod column;
mod hydraulic;
mod library;
mod oil;
mod spring;

pub use column::OilColumn;
pub use hydraulic::Hydraulic;
pub use library::{library, register};
pub use oil::Oil;
pub use spring::{Spring, TorsionSpring};

use std::fmt::Debug;

use chaindrive_quantities::{Handle, JsonSchema, ParameterError, check};
use serde::{Deserialize, Serialize};

/// The law of the push F(x, ẋ, z), x being the extension since assembly.
///
/// # Example
///
/// A spring that pushes with 400 N and has moved out by 2 mm, at 0.1 m/s:
///
/// ```
/// use chaindrive_mechanics::{Push, pushes::Spring};
///
/// let push = Push::Spring(Spring { preload: 400.0, stiffness: 20e3, damping: 100.0 });
/// let force = push.force(2e-3, 0.1, 0.0);
/// // F₀ − k x, and − c ẋ
/// assert!((force.elastic - 360.0).abs() < 1e-9);
/// assert!((force.damping + 10.0).abs() < 1e-9);
/// // It gives back what it stored: the mean force over the way.
/// assert!((push.energy(0.0, 0.0) - push.energy(2e-3, 0.0) - 380.0 * 2e-3).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", remote = "Self")]
pub enum Push {
    /// Nothing: the carrier stays where it was assembled.
    #[schemars(with = "()", extend("additionalProperties" = false))]
    Locked,
    /// A spring with a damper, on a slider or a plunger.
    Spring(Spring),
    /// A torsion spring with a damper, on an arm without a plunger.
    TorsionSpring(TorsionSpring),
    /// An oil-filled plunger that follows easily and yields only through a leak. Forces are given directly (`supply`, `relief`, `leak`), or
    /// follow from `oil`.
    Hydraulic(Hydraulic),
    /// A push of another program.
    #[serde(skip)]
    Registered(Handle<dyn PushLaw>),
}

/// Asks the member; a locked push has nothing.
macro_rules! ask {
    ($push:expr, $member:ident => $answer:expr) => {
        match $push {
            Push::Locked => Default::default(),
            Push::Spring($member) => $answer,
            Push::TorsionSpring($member) => $answer,
            Push::Hydraulic($member) => $answer,
            Push::Registered($member) => $answer,
        }
    };
}

/// Questions that a push answers, be it a member of the family or [registered](register); those without a state leave out the second half.
///
/// Above each field of its struct stand quantity and range.
pub trait PushLaw: Debug + Send + Sync + 'static {
    /// SI unit of the push: that of a force, `N`, or on an arm without a plunger of a torque, `N m`.
    fn unit(&self) -> &'static str;

    /// Force at extension x \[m or rad\] and rate ẋ, with what its state z does.
    fn force(&self, x: f64, rate: f64, z: f64) -> PushForce;

    /// Stored energy \[J\] relative to x = 0 with z settled there.
    fn energy(&self, x: f64, z: f64) -> f64;

    /// Stiffness −∂F/∂x at extension x of what has no state \[N/m or N m/rad\].
    fn stiffness(&self, x: f64) -> f64;

    /// Largest damping −∂F/∂ẋ \[N s/m or N m s\].
    fn damping(&self) -> f64;

    /// Refuses parameters that do not go together; each by itself is held to the range above its field.
    ///
    /// # Errors
    /// Names the first of them.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    /// Damping and stiffness of a push outward.
    fn outward(&self) -> [f64; 2] {
        [self.damping(), self.stiffness(0.0)]
    }

    /// The state at which nothing flows at extension x; none without a state.
    fn settled(&self, x: f64) -> Option<f64> {
        let _ = x;
        None
    }

    /// The push with its state settled at every moment; none where that is the push itself.
    fn relaxed(&self) -> Option<Push> {
        None
    }

    /// Share of the state in the derivatives.
    fn slopes(&self, x: f64, z: f64) -> Slopes {
        let _ = (x, z);
        Slopes::default()
    }

    /// Pressure above that of the air \[Pa\], where there is one.
    fn pressure(&self, x: f64, z: f64) -> Option<f64> {
        let _ = (x, z);
        None
    }
}

/// The force of a push, taken apart, and what goes on in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PushForce {
    /// Part that derives from stored energy \[N or N m\].
    pub elastic: f64,
    /// Part that dissipates \[N or N m\].
    pub damping: f64,
    /// Rate ż of its state.
    pub flow: f64,
    /// Power that is lost as the state flows \[W\].
    pub loss: f64,
}

/// Derivatives of a push with a state, beside those without.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slopes {
    /// −∂F/∂x with the state held \[N/m or N m/rad\].
    pub stiffness: f64,
    /// ∂F/∂z
    pub by_state: f64,
    /// ∂ż/∂x
    pub flow: f64,
    /// −∂ż/∂z \[1/s\]
    pub settling: f64,
    /// The largest that the stiffness, and the settling, can become without warning.
    pub largest: [f64; 2],
}

impl Slopes {
    /// Stiffness left when the state follows within a step that gives it the weight c \[s\].
    ///
    /// ```text
    /// K − c ∂F/∂z ∂ż/∂x/(1 − c ∂ż/∂z)
    /// ```
    pub(crate) fn within(&self, c: f64) -> f64 {
        self.stiffness - c * self.by_state * self.flow / (1.0 + c * self.settling)
    }
}

impl Push {
    /// Time c/k \[s\] in which a push outward dies out against its own damping; 0 without a spring.
    pub fn relaxation(&self) -> f64 {
        let [damping, stiffness]: [f64; 2] = ask!(self, push => push.outward());
        if stiffness > 0.0 {
            damping / stiffness
        } else {
            0.0
        }
    }

    /// Force \[N, or N m for a bare arm\] at extension x \[m or rad\], rate ẋ and state z.
    pub fn force(&self, x: f64, rate: f64, z: f64) -> PushForce {
        ask!(self, push => push.force(x, rate, z))
    }

    /// Stored energy \[J\] relative to x = 0.
    pub fn energy(&self, x: f64, z: f64) -> f64 {
        ask!(self, push => push.energy(x, z))
    }

    /// Stiffness −∂F/∂x of the elastic part at extension x, without that of a state \[N/m or N m/rad\].
    pub fn stiffness(&self, x: f64) -> f64 {
        ask!(self, push => push.stiffness(x))
    }

    /// Largest damping −∂F/∂ẋ \[N s/m or N m s\].
    pub fn damping(&self) -> f64 {
        ask!(self, push => push.damping())
    }

    /// The state at which nothing flows at extension x; none for a push without a state.
    pub fn settled(&self, x: f64) -> Option<f64> {
        ask!(self, push => push.settled(x))
    }

    /// Pressure above that of the air \[Pa\], where there is one.
    pub fn pressure(&self, x: f64, z: f64) -> Option<f64> {
        ask!(self, push => push.pressure(x, z))
    }

    /// The same push with its state settled at every moment: what statics looks at.
    #[must_use]
    pub(crate) fn relaxed(self) -> Self {
        let relaxed: Option<Self> = ask!(self, push => push.relaxed());
        relaxed.unwrap_or(self)
    }

    /// Share of its state in the derivatives.
    pub(crate) fn slopes(&self, x: f64, z: f64) -> Slopes {
        ask!(self, push => push.slopes(x, z))
    }

    /// SI unit of what it pushes with: that of a force or a torque; none where it is locked.
    pub fn unit(&self) -> Option<&'static str> {
        ask!(self, push => Some(push.unit()))
    }

    /// Refuses parameters outside the range of the member.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(self)?;
        let refused: Option<ParameterError> = ask!(self, push => push.check().err());
        refused.map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests;
