//! Elastic laws by their data on a drawing: a stiffness, or the bodies that touch.

use chaindrive_quantities::{JsonSchema, Length, Pressure, Ratio, Stiffness};
use serde::{Deserialize, Serialize};

use super::{CylinderLaw, Elastic};

/// The law, or the bodies, of a specification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveOrBodies {
    /// A law by its own parameters.
    Curve(Elastic),
    /// Bodies that touch, and the law that they are to make.
    Bodies(CylinderLaw, Surfaces),
}

/// A spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Linear {
    /// Stiffness \[N/m\].
    #[schemars(with = "Stiffness", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
}

/// Two bodies of one material that touch in a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Spheres {
    /// Young's modulus \[Pa\].
    #[schemars(with = "Option<Pressure>", extend("exclusiveMinimum" = 0))]
    pub modulus: f64,
    /// Poisson's ratio \[–\].
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub poisson: f64,
    /// Radius of the first body \[m\]; absent: that of the roller.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Radius of the second body \[m\], negative for a hollow; absent: a flat.
    #[schemars(with = "Option<Length>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_radius: Option<f64>,
}

/// Two parallel cylinders of one material. In joints and rollers the radii are those of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Surfaces {
    /// Length of the contact \[m\]; absent: that of the roller or joint, where the chain gives it.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// Young's modulus \[Pa\].
    #[schemars(with = "Option<Pressure>", extend("exclusiveMinimum" = 0))]
    pub modulus: f64,
    /// Poisson's ratio \[–\].
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub poisson: f64,
    /// Radius of the first cylinder \[m\]; absent: that of the roller.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Radius of the second cylinder \[m\], negative for a hollow; absent: a flat.
    #[schemars(with = "Option<Length>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_radius: Option<f64>,
    /// Radial clearance in a hollow \[m\], instead of the second radius.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<f64>,
    /// Greatest depth that the law reckons with \[m\], where the second surface is a part of a cylinder; absent: the
    /// second radius, or on a flat the first one.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_cap: Option<f64>,
}

impl From<Spheres> for Surfaces {
    fn from(bodies: Spheres) -> Self {
        let Spheres {
            modulus,
            poisson,
            radius,
            other_radius,
        } = bodies;
        Self {
            length: None,
            modulus,
            poisson,
            radius,
            other_radius,
            clearance: None,
            depth_cap: None,
        }
    }
}
