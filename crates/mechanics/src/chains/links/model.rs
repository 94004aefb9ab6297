//! Rigid links: the chain as bodies, joined ideally or with clearance.

use chaindrive_geometry::Vector;

use crate::DriveError;
use crate::joints::{Clearance, FreeRoller};

/// Rigid inner and outer links in turn.
///
/// Inner links carry the bushes, outer links the pins. The roller distance over an inner link is
/// its own; over an outer link it grows with the clearance, as it does when a chain wears:
///
/// ```text
/// inner: L = p,   outer: L = p − 2 (c + δ(T₀))
/// ```
///
/// so that the chain under its pretension T₀ has the pitch p everywhere.
///
/// # Source
/// C. Pereira, J. Ambrósio and A. Ramalho, *Contact mechanics in a roller chain drive using a
/// multibody approach*, 13th World Congress in Mechanism and Machine Science, 2011, A8-585.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidLinks {
    /// Links with bushes.
    pub inner: LinkBody,
    /// Links with pins.
    pub outer: LinkBody,
    /// Whether link 0 is an outer one.
    pub outer_first: bool,
    /// How neighbouring links are joined.
    pub joint: Joint,
    /// The part that runs on the teeth.
    pub rollers: RollerModel,
}

/// Mass properties of one link, both plates and its pins or bushes; free rollers not included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBody {
    /// Mass \[kg\], positive.
    pub mass: f64,
    /// Moment of inertia about the centre of mass \[kg m²\], positive.
    pub inertia: f64,
    /// Centre of mass from the middle between the joints \[m\]: along the link in the order of the
    /// chain, and to its left.
    pub centre: Vector,
}

/// How neighbouring links are joined.
#[expect(
    clippy::large_enum_variant,
    reason = "a chain has one, and copies it while it is built"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// An ideal hinge.
    Ideal,
    /// A pin in a larger bush.
    Clearance(Clearance),
}

/// The part that runs on the teeth.
#[expect(
    clippy::large_enum_variant,
    reason = "a chain has one, and copies it while it is built"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RollerModel {
    /// Rollers that move with the bush: their mass is the link's. They slide, as the particles do.
    Lumped {
        /// Mass of one roller \[kg\], not negative.
        mass: f64,
    },
    /// Rollers as bodies of their own, loose on the bush.
    Free(FreeRoller),
    /// None: the bush itself meets the tooth, and turns with its link.
    Bush,
}

impl RigidLinks {
    /// Whether link `index` carries the bushes.
    pub(crate) fn is_inner(&self, index: usize) -> bool {
        index.is_multiple_of(2) != self.outer_first
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let mut problems = Vec::new();
        let mut need = |ok: bool, path: &str, value: f64, allowed: &'static str| {
            problems.extend(DriveError::require(ok, path, value, allowed).err());
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (name, body) in [("inner", &self.inner), ("outer", &self.outer)] {
            let path = |what: &str| format!("chain.{name}.{what}");
            need(
                positive(body.mass),
                &path("mass"),
                body.mass,
                "positive [kg]",
            );
            need(
                positive(body.inertia),
                &path("inertia"),
                body.inertia,
                "positive [kg m²]",
            );
            for (axis, value) in [("x", body.centre.x), ("y", body.centre.y)] {
                need(
                    value.is_finite(),
                    &path(&format!("centre.{axis}")),
                    value,
                    "finite [m]",
                );
            }
        }
        if let RollerModel::Lumped { mass } = self.rollers {
            need(
                mass >= 0.0 && mass.is_finite(),
                "chain.roller.mass",
                mass,
                "not negative [kg]",
            );
        }
        if let Joint::Clearance(joint) = &self.joint {
            problems.extend(joint.problems());
        }
        if let RollerModel::Free(roller) = &self.rollers {
            problems.extend(roller.problems());
        }
        problems
    }
}
