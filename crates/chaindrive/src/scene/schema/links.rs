//! Parts of rigid links: plates, joints, rollers.

use std::f64::consts::{FRAC_PI_2, PI};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Contact;
use chaindrive_quantities::{AngularDamping, Inertia, Length, Mass, Ratio, Torque};

/// Model of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ChainModel {
    /// Point masses at the rollers, joined by links that are springs with dampers.
    #[default]
    Particles,
    /// Bush chains of several strands: point masses at the joints, links of springs side by side that share the load, bushes that turn
    /// with their inner link.
    BushStrands,
    /// Rigid inner and outer links, joined by ideal hinges.
    IdealJoints,
    /// Rigid inner and outer links, joined by pins that have play in their bushes.
    ClearanceJoints,
}

impl ChainModel {
    /// What such a chain is described by, in words.
    pub(crate) fn knows(self, rollers: Option<Rollers>) -> &'static str {
        match (self, rollers) {
            (Self::Particles, Some(Rollers::Free)) => {
                "particles with free rollers know masses of `inner` and `outer`, `joint`, `roller`, `outer_first`, `stiffness`, and `damping` or `damping_ratio`"
            }
            (Self::Particles, _) => {
                "particles know `mass`, `stiffness`, `damping` or `damping_ratio`, and of `joint` what rubs and damps"
            }
            (Self::BushStrands, _) => {
                "bush strands know `strands`, `mass`, `stiffness`, `damping` or `damping_ratio`, `outer_first`, `joint.clearance`, and of `joint` what rubs and damps"
            }
            (Self::IdealJoints, _) => {
                "links with ideal joints know `inner`, `outer`, `outer_first`, `roller`, `rollers`, `stiffness`, and of `joint` what rubs and damps"
            }
            (Self::ClearanceJoints, _) => {
                "links with clearance joints know `inner`, `outer`, `outer_first`, `joint`, `roller`, `rollers`, `stiffness`"
            }
        }
    }

    /// True for links that are springs with dampers.
    pub(crate) fn has_springs(self) -> bool {
        matches!(self, Self::Particles | Self::BushStrands)
    }

    /// True for strands side by side that share the load.
    pub(crate) fn has_strands(self) -> bool {
        self == Self::BushStrands
    }

    /// True for pins with play in their bushes.
    pub(crate) fn has_play(self) -> bool {
        self == Self::ClearanceJoints
    }
}

/// Rollers on the teeth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Rollers {
    /// Rollers that move with their bush.
    Lumped,
    /// Rollers as bodies, or as points, of their own, with play on their bush.
    Free,
    /// No rollers: the bush meets the teeth.
    None,
}

/// Mass properties of one link: its two plates and its bushes or pins, without rollers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Link {
    /// Mass [kg].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Moment of inertia about the centre of mass [kg m²].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inertia: Option<Inertia>,
    /// Centre of mass [m] from the middle between the joints: along the link in the order of the
    /// chain, and to its left; absent: the middle.
    #[serde(default)]
    pub(crate) centre: [Length; 2],
}

/// Pins in their bushes.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Joint {
    /// Diameter of the pin [m], on which the joints slide.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pin_diameter: Option<Length>,
    /// Radial clearance [m]: radius of the bore less radius of the pin; for clearance joints. At 0 pins have no play, and
    /// the link beside them yields: with `contact.series`, or with the stiffness of the link. Between bush strands it is the play in
    /// which a strand of an inner link hangs loose; absent there: 0, and strands push as they pull.
    #[schemars(extend("minimum" = 0))]
    pub(crate) clearance: Option<Length>,
    /// Length on which pin and bush touch [m]; for clearance joints.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Viscous damping [N m s] against turning; absent: none.
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: AngularDamping,
    /// Sum of the pressures of a pin on its bush over the force that they balance, κ [–], for the friction f(κ N, v): "line" (1) where they
    /// touch along a line, "cosine" (4/π) and "uniform" (π/2) where the pin has worn in and bears on half of its circumference. A coefficient
    /// that was found with one of them is of no use with another. Absent: line.
    pub(crate) pressure_factor: PressureFactor,
    /// Torque with which the seal of every joint resists [N m], an O-ring or X-ring between inner and outer plate; absent: none.
    #[schemars(extend("minimum" = 0))]
    pub(crate) seal_torque: Torque,
    /// Contact of pin and bush, where it differs from `contact.joints`; joints without clearance have nothing of it but the
    /// friction.
    pub(crate) contact: Contact,
}

/// Sum of pressures over the force that they balance.
// A pressure over half of a circumference: ∫ p dφ / ∫ p cos φ dφ of p = cos φ and of p = 1.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend(
    "x-words" = {"line": 1.0, "cosine": 4.0 / PI, "uniform": FRAC_PI_2},
    "examples" = ["uniform"],
    "minimum" = 1,
    "maximum" = 2,
))]
pub(crate) struct PressureFactor(pub(crate) Ratio);

impl Default for PressureFactor {
    fn default() -> Self {
        Self(Ratio(1.0))
    }
}

/// Rollers on their bushes.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Roller {
    /// Mass of one roller [kg].
    #[schemars(extend("minimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Moment of inertia of one roller [kg m²]; for free rollers.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inertia: Option<Inertia>,
    /// Outer diameter of the bush [m]; for free rollers.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) bush_diameter: Option<Length>,
    /// Radial clearance [m]: radius of the roller's bore less outer radius of the bush; for free
    /// rollers.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) clearance: Option<Length>,
    /// Length of the roller [m]: on its bush, and on the teeth.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Contact of bush and roller, where it differs from `contact.rollers`.
    #[serde(default)]
    pub(crate) contact: Contact,
}
