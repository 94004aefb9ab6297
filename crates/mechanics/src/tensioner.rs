//! Tensioners: a carrier with one degree of freedom and the force that drives it outward.

pub mod carriers;
mod hydraulic;
mod spring;

pub use carriers::Carrier;
pub(crate) use carriers::{Extension, Reduced, Weight};
pub use hydraulic::Hydraulic;
pub use spring::Spring;

use crate::DriveError;

/// A body with one coordinate s that carries sprockets or guides and presses them on the chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensioner {
    /// Name, unique in the drive.
    pub name: String,
    /// How it moves.
    pub carrier: Carrier,
    /// Mass of a slider \[kg\] or moment of inertia of an arm about its pivot \[kg m²\], without
    /// the sprockets it carries; positive.
    pub inertia: f64,
    /// What pushes it.
    pub push: Push,
}

/// The law of the push F(x, ẋ), x being the extension since assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Push {
    /// The carrier stays where it was assembled.
    Locked,
    /// Spring and damper.
    Spring(Spring),
    /// One-way hydraulic plunger.
    Hydraulic(Hydraulic),
}

/// The force of a push, taken apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PushForce {
    /// Part that derives from stored energy \[N or N m\].
    pub elastic: f64,
    /// Part that dissipates \[N or N m\].
    pub damping: f64,
}

impl Push {
    /// Force \[N, or N m for a bare arm\] at extension x \[m or rad\] and rate ẋ.
    pub fn force(&self, x: f64, rate: f64) -> PushForce {
        match self {
            Self::Locked => PushForce::default(),
            Self::Spring(spring) => spring.force(x, rate),
            Self::Hydraulic(hydraulic) => hydraulic.force(x, rate),
        }
    }

    /// Stored energy \[J\] relative to x = 0.
    pub fn energy(&self, x: f64) -> f64 {
        match self {
            Self::Locked => 0.0,
            Self::Spring(spring) => spring.energy(x),
            Self::Hydraulic(hydraulic) => hydraulic.energy(x),
        }
    }

    /// Stiffness −∂F/∂x of the elastic part \[N/m or N m/rad\].
    pub fn stiffness(&self) -> f64 {
        match self {
            Self::Locked => 0.0,
            Self::Spring(spring) => spring.stiffness,
            Self::Hydraulic(hydraulic) => hydraulic.stiffness,
        }
    }

    /// Largest damping −∂F/∂ẋ \[N s/m or N m s\].
    pub fn damping(&self) -> f64 {
        match self {
            Self::Locked => 0.0,
            Self::Spring(spring) => spring.damping,
            Self::Hydraulic(hydraulic) => hydraulic.leak.max(hydraulic.extending),
        }
    }
}

impl Tensioner {
    /// Names every parameter out of range.
    pub fn problems(&self) -> Vec<DriveError> {
        let place = |what: &str| format!("tensioners.{}.{what}", self.name);
        let mut problems = Vec::new();
        if self.push != Push::Locked {
            problems.extend(
                DriveError::require(
                    self.inertia > 0.0 && self.inertia.is_finite(),
                    &place("inertia"),
                    self.inertia,
                    "positive [kg, or kg m² for an arm]",
                )
                .err(),
            );
        }
        let carrier = format!("tensioners.{}", self.name);
        problems.extend(self.carrier.check(&carrier).err());
        match &self.push {
            Push::Locked => {}
            Push::Spring(spring) => problems.extend(spring.check(&place("push")).err()),
            Push::Hydraulic(hydraulic) => {
                problems.extend(hydraulic.check(&place("push")).err());
            }
        }
        problems
    }
}
