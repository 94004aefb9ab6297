//! Tensioners: a carrier with one degree of freedom and the force that drives it outward.

pub mod carriers;
pub mod pushes;

pub use carriers::Carrier;
pub(crate) use carriers::{Extension, ReducedInertia, Weight};
pub(crate) use pushes::Slopes;
pub use pushes::{Push, PushForce};

use chaindrive_geometry::Point;

use crate::{DriveError, Forces};

/// A body with one coordinate s that carries sprockets or guides and presses them on the chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensioner {
    /// Name, unique in the drive.
    pub name: String,
    /// How it moves.
    pub carrier: Carrier,
    /// Its push.
    pub push: Push,
    /// Forces on it from outside, beside those on the centres that it carries.
    pub forces: Forces,
    /// Point of it on which they act, where it was assembled \[m\]; none of a slide, all points of which move alike.
    pub forced_at: Option<Point>,
}

impl Tensioner {
    /// Where the point is on which forces on it act \[m\], at its coordinate s \[m or rad\]; of a slide, how far all of it has moved.
    pub fn forced_place(&self, s: f64) -> [f64; 2] {
        let at = self.forced_at.unwrap_or_else(Point::origin);
        self.carrier.carry(s, at).0.into()
    }

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
        problems.extend(self.forces.problems(&format!("tensioners.{}", self.name)));
        let conflict = |key: &str, problem: &str| DriveError::Conflict {
            path: place(key),
            problem: problem.into(),
        };
        if self.carrier.pivot().is_some() && self.forced_at.is_none() && !self.forces.is_empty() {
            let problem = "a force on an arm needs the point on which it acts";
            problems.push(conflict("force_at", problem));
        }
        for (key, list) in [("force_x", &self.forces.x), ("force_y", &self.forces.y)] {
            for (i, action) in list.iter().enumerate() {
                if action.turns_with_an_angle() && action.follows().is_none() {
                    let problem = "a tensioner has no shaft: name the one whose angle counts";
                    problems.push(conflict(&format!("{key}[{i}].of"), problem));
                }
            }
        }
        problems
    }
}
