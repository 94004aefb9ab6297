//! Parts of rigid links: plates, joints, rollers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Contact;
use chaindrive_quantities::{AngularDamping, Inertia, Length, Mass};

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
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Moment of inertia about the centre of mass [kg m²].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inertia: Option<Inertia>,
    /// Centre of mass [m] from the middle between the joints: along the link in the order of the
    /// chain, and to its left; absent: the middle.
    #[serde(default)]
    pub(crate) centre: [Length; 2],
}

/// Pins in their bushes.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Joint {
    /// Diameter of the pin [m], on which the joints slide.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pin_diameter: Option<Length>,
    /// Radial clearance [m]: radius of the bore less radius of the pin; for clearance joints. At 0 pins have no play, and
    /// the link beside them yields: with `contact.series`, or with the stiffness of the link. Between bush strands it is the play in
    /// which a strand of an inner link hangs loose; absent there: 0, and strands push as they pull.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) clearance: Option<Length>,
    /// Length on which pin and bush touch [m]; for clearance joints.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Viscous damping [N m s] against turning; absent: none.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: AngularDamping,
    /// Contact of pin and bush, where it differs from `contact.joints`; joints without clearance have nothing of it but the
    /// friction.
    #[serde(default)]
    pub(crate) contact: Contact,
}

/// Rollers on their bushes.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Roller {
    /// Mass of one roller [kg].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Moment of inertia of one roller [kg m²]; for free rollers.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inertia: Option<Inertia>,
    /// Outer diameter of the bush [m]; for free rollers.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) bush_diameter: Option<Length>,
    /// Radial clearance [m]: radius of the roller's bore less outer radius of the bush; for free
    /// rollers.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) clearance: Option<Length>,
    /// Length of the roller [m]: on its bush, and on the teeth.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Contact of bush and roller, where it differs from `contact.rollers`.
    #[serde(default)]
    pub(crate) contact: Contact,
}
