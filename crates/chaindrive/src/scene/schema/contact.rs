//! How surfaces push and rub.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::quantity::{
    ContactStiffness, Damping, Length, Pressure, Ratio, Speed, Stiffness,
};

/// Contact laws for all sprockets and all guides.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Contacts {
    /// Contact of rollers with teeth.
    #[serde(default)]
    pub(crate) teeth: Contact,
    /// Contact of the chain with guides.
    #[serde(default)]
    pub(crate) guides: Contact,
}

/// A contact. What a sprocket or guide leaves out is taken from `contact.teeth` or
/// `contact.guides`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Contact {
    /// Elastic law; absent: linear, with five times the link stiffness on teeth and the link
    /// stiffness on guides.
    #[serde(default)]
    pub(crate) law: Option<Elastic>,
    /// Coefficient of restitution of an impact [–], after Lankarani and Nikravesh; absent, without
    /// `damping`: 0.8 on teeth, 0.5 on guides.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub(crate) restitution: Option<Ratio>,
    /// Viscous damping [N s/m], instead of a restitution.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: Option<Damping>,
    /// Least closing speed with which a restitution reckons [m/s]: keeps contacts that begin gently
    /// from overdamping; absent: 0.05 m/s.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) onset_floor: Option<Speed>,
    /// Coulomb friction; absent: none.
    #[serde(default)]
    pub(crate) friction: Option<Friction>,
}

/// Coulomb friction, made smooth around standstill.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Friction {
    /// Coefficient of friction [–].
    #[schemars(extend("minimum" = 0))]
    pub(crate) coefficient: Ratio,
    /// Speed of slip around which the friction changes sign [m/s]; absent: 0.05 m/s.
    #[serde(default = "slip_speed")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) slip_speed: Speed,
}

fn slip_speed() -> Speed {
    Speed(0.05)
}

/// An elastic law: force over penetration.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
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
        #[serde(default = "steel_modulus")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus: Pressure,
        /// Poisson's ratio [–]; absent: 0.3.
        #[serde(default = "steel_poisson")]
        #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
        poisson: Ratio,
        /// Radius of the first body [m]; absent: that of the roller.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Option<Length>,
        /// Radius of the second body [m], negative for a hollow; absent: a flat.
        #[serde(default)]
        other_radius: Option<Length>,
    },
    /// Johnson's law for parallel cylinders of one material.
    Johnson {
        /// Length of the contact [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        length: Length,
        /// Young's modulus [Pa]; absent: steel, 207 GPa.
        #[serde(default = "steel_modulus")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        modulus: Pressure,
        /// Poisson's ratio [–]; absent: 0.3.
        #[serde(default = "steel_poisson")]
        #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
        poisson: Ratio,
        /// Radius of the first cylinder [m]; absent: that of the roller.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Option<Length>,
        /// Radius of the second cylinder [m], negative for a hollow; absent: a flat.
        #[serde(default)]
        other_radius: Option<Length>,
        /// Radial clearance in a hollow [m], instead of the radii.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        clearance: Option<Length>,
    },
}

fn steel_modulus() -> Pressure {
    Pressure(207e9)
}

fn steel_poisson() -> Ratio {
    Ratio(0.3)
}
