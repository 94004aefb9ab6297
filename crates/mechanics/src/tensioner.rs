//! Tensioners: a carrier with one degree of freedom and the force that drives it outward.

pub mod carriers;
pub mod pushes;

pub use carriers::Carrier;
pub(crate) use carriers::{Extension, Reduced, Weight};
pub(crate) use pushes::Slopes;
pub use pushes::{Push, PushForce};

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
    /// Its push.
    pub push: Push,
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
        problems.extend(self.push.check(&place("push")).err());
        problems
    }
}
