//! Models of a chain, as a drive describes them.

pub use super::links::model::{Joint, LinkBody, RigidLinks, RollerModel};
pub use super::points::PointJoints;
pub use super::strands::model::{BushStrands, Strand};

use crate::DriveError;
use crate::joints::{Clearance, FreeRoller};

/// Model of a chain: no more than a scene needs.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainModel {
    /// Point masses at the rollers, joined by spring-damper links: two coordinates a link.
    Particles,
    /// The same with roller, bush and pin as points of their own: six coordinates a link.
    Points(PointJoints),
    /// Rigid links with joints: three coordinates a link, three more for every free roller.
    Rigid(RigidLinks),
    /// Bush links of several strands on common pins: two coordinates a link.
    Strands(BushStrands),
}

impl ChainModel {
    /// Its name, and that of its rollers where they are told apart.
    pub fn names(&self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Particles => ("particles", None),
            Self::Points(_) => ("particles", Some("free")),
            Self::Rigid(links) => {
                let joints = match &links.joint {
                    Joint::Ideal => "ideal-joints",
                    Joint::Clearance(_) => "clearance-joints",
                };
                let rollers = match &links.rollers {
                    RollerModel::Lumped { .. } => "lumped",
                    RollerModel::Free(_) => "free",
                    RollerModel::Bush => "none",
                };
                (joints, Some(rollers))
            }
            Self::Strands(_) => ("bush-strands", None),
        }
    }

    /// True for links that are springs with dampers.
    pub fn has_springs(&self) -> bool {
        match self {
            Self::Particles | Self::Points(_) | Self::Strands(_) => true,
            Self::Rigid(_) => false,
        }
    }

    /// Whether roller and bush, and bush and pin, are one body: then no law of theirs yields behind a tooth.
    pub fn fused(&self) -> [bool; 2] {
        match self {
            Self::Particles => [true; 2],
            Self::Points(_) => [false; 2],
            Self::Rigid(links) => {
                let free = matches!(links.rollers, RollerModel::Free(_));
                let lumped = matches!(links.rollers, RollerModel::Lumped { .. });
                [lumped, links.joint == Joint::Ideal && !free]
            }
            Self::Strands(_) => [false, true],
        }
    }

    /// Whether links give when they are pulled, by themselves or at their joints.
    pub(crate) fn stretches(&self) -> bool {
        match self {
            Self::Particles | Self::Points(_) | Self::Strands(_) => true,
            Self::Rigid(links) => links.joint != Joint::Ideal,
        }
    }

    /// Whether joints move by themselves beside the rollers: then offsets in them can be recorded.
    pub(crate) fn has_joints(&self) -> bool {
        !matches!(self, Self::Particles | Self::Strands(_))
    }

    /// Whether the first link is an outer one.
    pub(crate) fn begins_outside(&self) -> bool {
        match self {
            Self::Particles => false,
            Self::Points(points) => points.outer_first,
            Self::Rigid(links) => links.outer_first,
            Self::Strands(chain) => chain.outer_first,
        }
    }

    /// Pins that have play in their bushes.
    pub fn clearance(&self) -> Option<&Clearance> {
        match self {
            Self::Points(PointJoints { joint, .. })
            | Self::Rigid(RigidLinks {
                joint: Joint::Clearance(joint),
                ..
            }) => Some(joint),
            Self::Particles | Self::Rigid(_) | Self::Strands(_) => None,
        }
    }

    /// Rollers with play on their bushes.
    pub fn free_roller(&self) -> Option<&FreeRoller> {
        match self {
            Self::Points(PointJoints { roller, .. })
            | Self::Rigid(RigidLinks {
                rollers: RollerModel::Free(roller),
                ..
            }) => Some(roller),
            Self::Particles | Self::Rigid(_) | Self::Strands(_) => None,
        }
    }

    /// Whether pins rub by the contact with their bushes.
    pub fn rubs_in_bushes(&self) -> bool {
        matches!(self, Self::Rigid(links) if matches!(links.joint, Joint::Clearance(_)))
    }

    /// Strands side by side that share the tension, none where the model does not tell them apart.
    pub fn strands(&self) -> &[Strand] {
        match self {
            Self::Strands(chain) => &chain.strands,
            Self::Particles | Self::Points(_) | Self::Rigid(_) => &[],
        }
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        match self {
            Self::Particles => Vec::new(),
            Self::Points(points) => points.problems(),
            Self::Rigid(links) => links.problems(),
            Self::Strands(chain) => chain.problems(),
        }
    }
}
