//! How surfaces push and rub.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Friction;
use crate::scene::quantity::{
    ContactStiffness, Damping, Length, Pressure, Ratio, Speed, Stiffness,
};

/// Contact laws, one for every kind of pair in the drive.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Contacts {
    /// Contact of rollers with teeth.
    #[serde(default)]
    pub(crate) teeth: Contact,
    /// Differences on the flanks of all teeth; absent: none, but for rigid links that leave the
    /// law of their teeth open, where seat and flank follow from their own curvatures.
    #[serde(default)]
    pub(crate) flanks: Option<Flank>,
    /// Contact of the chain with guides.
    #[serde(default)]
    pub(crate) guides: Contact,
    /// Contact of pins with their bushes; where joints have no clearance, its friction.
    #[serde(default)]
    pub(crate) joints: Contact,
    /// Contact of bushes with free rollers.
    #[serde(default)]
    pub(crate) rollers: Contact,
}

/// The flank of a tooth, where it does not answer like the hollow seat.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Flank {
    /// Elastic law beyond the hollow.
    pub(crate) law: Elastic,
    /// The law changes smoothly within this distance on either side of the end of the hollow [m]; absent: a
    /// twentieth of the roller diameter, about the half-width of the patch of contact.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) width: Option<Length>,
}

/// A contact. What a sprocket or guide leaves out is taken from `contact.teeth` or
/// `contact.guides`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Contact {
    /// Elastic law; absent, for particles: linear, with five times the link stiffness on teeth and the
    /// link stiffness on guides; for rigid links: cylindrical on teeth, and linear on guides with
    /// the stiffness of a joint; in joints and rollers: cylindrical.
    #[serde(default)]
    pub(crate) law: Option<Elastic>,
    /// Stiffness [N/m] of what lies behind the surfaces and bears their force, such as plates behind a pin; absent: rigid, but in
    /// joints with clearance of links whose stiffness is known: what leaves the links that stiffness between their pins; and on teeth
    /// with a law, under chains of the catalogue: what roller on bush and bush on pin yield, where they do not move by themselves; 0: rigid.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) series: Option<Stiffness>,
    /// Coefficient of restitution of an impact [–]; absent, without `damping`: 0.8 on teeth, 0.5 on
    /// guides, 0.7 in joints and rollers.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub(crate) restitution: Option<Ratio>,
    /// Viscous damping [N s/m], instead of a restitution: Kelvin and Voigt.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: Option<Damping>,
    /// How the restitution becomes a force; absent: exact.
    #[serde(default)]
    pub(crate) dissipation: Option<Dissipation>,
    /// Least closing speed with which a restitution reckons [m/s]: keeps contacts that begin gently
    /// from overdamping; absent: 0.05 m/s.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) onset_floor: Option<Speed>,
    /// Friction; absent: none, but in joints of a chain whose pin the catalogue knows: a spring and a slider, with a coefficient of
    /// 0.1.
    #[serde(default)]
    pub(crate) friction: Option<Friction>,
}

/// How a restitution becomes a force: the factor χ of F = g(δ) (1 + χ δ̇/v).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Dissipation {
    /// No loss; without a restitution.
    None,
    /// The factor that delivers the restitution asked for.
    Exact,
    /// ³⁄₂ (1 − e).
    HuntCrossley,
    /// ¾ (1 − e²), for nearly elastic impacts.
    LankaraniNikravesh,
    /// ¾ (1 − e).
    LeeWang,
    /// 6 (1 − e)/[(2e − 1)² + 3].
    #[serde(rename = "herbert-mcwhannell")]
    HerbertMcWhannell,
    /// (1 − e²)/e.
    Gonthier,
    /// ¾ (1 − e²) exp[2 (1 − e)].
    ZhiyingQishao,
    /// 8 (1 − e)/(5e).
    Flores,
    /// 3 (1 − e)/(2e).
    HuGuo,
}

/// An elastic law: force over penetration.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Elastic {
    /// A spring.
    Linear {
        /// Stiffness [N/m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: Stiffness,
    },
    /// Stiffness × penetration ^ exponent.
    Power {
        /// Stiffness [N/mⁿ], n being the exponent.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: ContactStiffness,
        /// Exponent [–].
        #[schemars(extend("minimum" = 1, "maximum" = 3))]
        exponent: Ratio,
    },
    /// Hertz's point contact of two bodies of one material. Too soft for cylinders.
    Hertz {
        /// Young's modulus [Pa]; absent: steel, 207 GPa.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus: Option<Pressure>,
        /// Poisson's ratio [–]; absent: 0.3.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
        poisson: Option<Ratio>,
        /// Radius of the first body [m]; absent: that of the roller.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Option<Length>,
        /// Radius of the second body [m], negative for a hollow; absent: a flat.
        #[serde(default)]
        other_radius: Option<Length>,
    },
    /// Johnson's law for parallel cylinders of one material.
    Johnson(Cylinders),
    /// Johnson's law, extended to wide contacts in a hollow.
    Conformal(Cylinders),
    /// Radzimovsky's law for parallel cylinders.
    Radzimovsky(Cylinders),
    /// The law of ESDU 78035 for parallel cylinders.
    #[serde(rename = "esdu-78035")]
    Esdu78035(Cylinders),
    /// The law of Dubowsky and Freudenstein for parallel cylinders.
    DubowskyFreudenstein(Cylinders),
    /// The enhanced cylindrical law of Pereira, Ramalho and Ambrósio: a power fitted to Johnson's, for a
    /// clearance of 5 µm to 10 mm, or radii of 4 mm to 300 mm in sum.
    Cylindrical(Cylinders),
}

/// Two parallel cylinders of one material. In joints and rollers the radii are those of the chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cylinders {
    /// Length of the contact [m]; absent: that of the roller or joint, where the chain gives it.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Young's modulus [Pa]; absent: steel, 207 GPa.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) modulus: Option<Pressure>,
    /// Poisson's ratio [–]; absent: 0.3.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub(crate) poisson: Option<Ratio>,
    /// Radius of the first cylinder [m]; absent: that of the roller.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) radius: Option<Length>,
    /// Radius of the second cylinder [m], negative for a hollow; absent: a flat.
    #[serde(default)]
    pub(crate) other_radius: Option<Length>,
    /// Radial clearance in a hollow [m], instead of the second radius.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) clearance: Option<Length>,
    /// Greatest depth that the law reckons with [m], where the second surface is a part of a cylinder; absent: the
    /// second radius, or on a flat the first one.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) depth_cap: Option<Length>,
}
