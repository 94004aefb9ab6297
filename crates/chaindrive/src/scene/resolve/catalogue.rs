//! Chains of the catalogue: what a scene leaves out is taken from there.

use super::Findings;
use crate::catalogue::{CatalogueChain, Number, catalogue};
use crate::scene::quantity::{Inertia, Length, Mass, Stiffness};
use crate::scene::schema::{self, ChainModel, Rollers};
use crate::scene::suggest::one_of;

/// The chain of a name.
pub(super) fn named(name: &str, findings: &mut Findings<'_>) -> Option<&'static CatalogueChain> {
    let found = CatalogueChain::named(name);
    if found.is_none() {
        let names = catalogue().iter().map(|chain| chain.name.as_str());
        let known: Vec<&str> = names.collect();
        let message = format!("no chain of the catalogue is named `{name}`");
        findings.refuse_with("chain.type", message, one_of(name, &known));
    }
    found
}

/// Length of the rollers \[m\]: they fill the space between the inner plates.
pub(super) fn roller_length(chain: &CatalogueChain) -> Option<f64> {
    chain.number(Number::InnerWidth)
}

/// The chain as written, with the values of the catalogue where it has none.
pub(super) fn completed(text: &schema::Chain, chain: &CatalogueChain) -> schema::Chain {
    let mut text = text.clone();
    let length = |number| chain.number(number).map(Length);
    let mass = |number| chain.number(number).map(Mass);
    let inertia = |number| chain.number(number).map(Inertia);
    text.pitch = text.pitch.or(length(Number::Pitch));
    text.roller_diameter = text.roller_diameter.or(length(Number::RollerDiameter));
    text.plate_height = text.plate_height.or(length(Number::PlateHeight));
    if text.model == ChainModel::Particles {
        if text.masses.is_none() {
            text.mass = text.mass.or(chain.mass().map(Mass));
        }
        if text.stiffnesses.is_none() {
            let stiffness = chain.number(Number::LinkStiffness).map(Stiffness);
            text.stiffness = text.stiffness.or(stiffness);
        }
        return text;
    }
    let inner = text.inner.get_or_insert_default();
    inner.mass = inner.mass.or(mass(Number::InnerMass));
    inner.inertia = inner.inertia.or(inertia(Number::InnerInertia));
    let outer = text.outer.get_or_insert_default();
    outer.mass = outer.mass.or(mass(Number::OuterMass));
    outer.inertia = outer.inertia.or(inertia(Number::OuterInertia));
    if chain.kind == "bush" {
        text.rollers = text.rollers.or(Some(Rollers::None));
    }
    if text.rollers != Some(Rollers::None) {
        let roller = text.roller.get_or_insert_default();
        roller.mass = roller.mass.or(mass(Number::RollerMass));
        roller.inertia = roller.inertia.or(inertia(Number::RollerInertia));
        roller.bush_diameter = roller.bush_diameter.or(length(Number::BushDiameter));
    }
    if text.model == ChainModel::ClearanceJoints {
        let joint = text.joint.get_or_insert_default();
        joint.pin_diameter = joint.pin_diameter.or(length(Number::PinDiameter));
        joint.clearance = joint.clearance.or(chain.joint_clearance().map(Length));
        joint.length = joint.length.or(chain.joint_length().map(Length));
    }
    text
}
