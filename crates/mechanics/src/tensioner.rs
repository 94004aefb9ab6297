//! Tensioners: a carrier with one degree of freedom and the force that drives it outward.

pub mod carriers;
pub mod pushes;

pub use carriers::Carrier;
pub(crate) use carriers::{Extension, ReducedInertia, Weight};
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
    /// Its push.
    pub push: Push,
}

impl Tensioner {
    /// Names every parameter out of range.
    pub fn problems(&self) -> Vec<DriveError> {
        let place = |what: &str| format!("tensioners.{}.{what}", self.name);
        let mut problems = Vec::new();
        if let (key, None) = self.carrier.inertia()
            && self.push != Push::Locked
        {
            problems.push(DriveError::Conflict {
                path: place(&format!("carrier.{key}")),
                problem: "a tensioner that is not locked needs it".into(),
            });
        }
        problems.extend(self.carrier.check(&place("carrier")).err());
        let push = self.push.check();
        problems.extend(
            push.err()
                .map(|source| DriveError::law(&place("push"), source)),
        );
        problems
    }
}
