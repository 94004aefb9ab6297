//! How surfaces push and rub.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_contact::dissipation::Hysteresis;
use chaindrive_contact::elastic::Specification;
use chaindrive_contact::{Film, Friction};

use super::{Stack, Written};
use chaindrive_quantities::{Damping, Length, Ratio, Speed, Stiffness};

/// Contact laws, one for every kind of pair in the drive.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Contacts {
    /// Contact of rollers with teeth.
    pub(crate) teeth: Contact,
    /// Differences on the flanks of all teeth; absent: none, but for rigid links that leave the
    /// law of their teeth open, where seat and flank follow from their own curvatures.
    pub(crate) flanks: Option<Flank>,
    /// Contact of the chain with guides.
    pub(crate) guides: Contact,
    /// Contact of pins with their bushes; where joints have no clearance, its friction.
    pub(crate) joints: Contact,
    /// Contact of bushes with free rollers.
    pub(crate) rollers: Contact,
}

/// The flank of a tooth, where it does not answer like the hollow seat.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Flank {
    /// Elastic law beyond the hollow.
    pub(crate) law: Written<Specification>,
    /// The law changes smoothly within this distance on either side of the end of the hollow [m]; absent: a
    /// twentieth of the roller diameter, about the half-width of the patch of contact.
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
    pub(crate) law: Option<Written<Specification>>,
    /// Stiffness [N/m] of what lies behind the surfaces and bears their force, such as plates behind a pin; absent: rigid, but in
    /// joints with clearance of links whose stiffness is known: what leaves the links that stiffness between their pins; and on teeth
    /// with a law, under chains of the catalogue: what roller on bush and bush on pin yield, where they do not move by themselves; 0: rigid.
    #[schemars(extend("minimum" = 0))]
    pub(crate) series: Option<Stiffness>,
    /// Coefficient of restitution of an impact [–], unless `damping` is given.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub(crate) restitution: Option<Ratio>,
    /// Viscous damping [N s/m], instead of a restitution: Kelvin and Voigt.
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: Option<Damping>,
    /// How the restitution becomes a force; absent: exact.
    pub(crate) dissipation: Option<Hysteresis>,
    /// Least closing speed with which a restitution reckons [m/s]: keeps contacts that begin gently
    /// from overdamping.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) onset_floor: Option<Speed>,
    /// Parts behind teeth that yield, in place of `series`; for teeth only. Absent: as `series` says.
    pub(crate) stack: Option<Stack>,
    /// Friction; absent: none, but in joints of a chain whose pin the catalogue knows: a spring and a slider.
    pub(crate) friction: Option<Written<Friction>>,
    /// Film of oil between the surfaces; absent: they are dry.
    pub(crate) film: Option<Written<Film>>,
}
