//! Chains of the catalogue: what a scene leaves out is taken from there.

use chaindrive_mechanics::{Capacity, MissingRating, PowerLimits};
use serde::Serialize;

use super::Findings;
use crate::catalogue::{CatalogueChain, Number, Status, catalogue};
use crate::scene::error::Problem;
use crate::scene::schema::{self, Rollers};
use crate::scene::suggest::{nearest, one_of};
use chaindrive_quantities::{Length, Mass};

/// The chain of the catalogue of a name.
///
/// # Errors
/// The name, with the nearest one that there is.
pub fn chain_named(name: &str) -> Result<&'static CatalogueChain, Problem> {
    CatalogueChain::named(name).ok_or_else(|| {
        let message = format!("no chain of the catalogue is named `{name}`");
        Problem::new("", None, message).hint(one_of(name, &names()))
    })
}

/// The chain of a name. For a name that none has another one stands in, so that all other mistakes are found as well.
pub(super) fn named(name: &str, findings: &mut Findings<'_>) -> &'static CatalogueChain {
    chain_named(name).unwrap_or_else(|problem| {
        let hint = problem.hint.unwrap_or_default();
        findings.refuse_with("chain.type", problem.message, hint);
        let near = nearest(name, &names()).and_then(CatalogueChain::named);
        near.unwrap_or(&catalogue()[0])
    })
}

fn names() -> Vec<&'static str> {
    let names = catalogue().iter().map(|chain| chain.name.as_str());
    names.collect()
}

/// Length of the rollers \[m\]: they fill the space between the inner plates.
pub(super) fn roller_length(chain: &CatalogueChain) -> Option<f64> {
    chain.number(Number::InnerWidth)
}

/// Limit of the power of a catalogue chain; none where the scene gives another pitch.
pub(super) fn capacity(chain: &CatalogueChain, pitch: f64) -> Capacity {
    let own = chain.number(Number::Pitch);
    if !own.is_some_and(|own| (pitch - own).abs() <= SAME_PITCH * own) {
        return Capacity::Unknown(MissingRating::OtherPitch);
    }
    if let Some(limits) = american(chain, pitch) {
        return Capacity::American(limits);
    }
    // Narrow chains, as those of bicycles, have the pitch of an American one but are no kin of it.
    let is_kin = |it: &CatalogueChain| {
        chain.name.ends_with("B-1") && it.kind == chain.kind && it.number(Number::Pitch) == own
    };
    let kin = catalogue().iter().filter(|it| is_kin(it));
    let mut limits = kin.filter_map(|it| american(it, pitch));
    let twin = limits.find(|limits| limits.plates > LIGHT);
    Capacity::Unknown(MissingRating::SourceMissing { twin })
}

/// Factor of the plates of number 41, which are lighter than those of the other chains.
const LIGHT: f64 = 0.0022;

/// The formula of the American Chain Association with the factors of a chain of ASME B29.1.
fn american(chain: &CatalogueChain, pitch: f64) -> Option<PowerLimits> {
    let [plates, rollers] = match chain.ansi.as_str() {
        "25" | "35" => [0.004, 29.0],
        "41" => [LIGHT, 3.4],
        "40" | "50" | "60" | "80" | "100" | "120" | "140" | "160" | "180" | "200" | "240" => {
            [0.004, 17.0]
        }
        _ => return None,
    };
    Some(PowerLimits {
        pitch,
        plates,
        rollers,
    })
}

/// Area on which a pin bears on its bush \[m²\]: d b, of the joints as written or those of the catalogue.
pub(super) fn bearing_area(text: &schema::Chain, of_type: Option<&CatalogueChain>) -> Option<f64> {
    let joint = text.joint.as_ref();
    let length = joint.and_then(|joint| joint.length).map(f64::from);
    let length = length.or_else(|| of_type?.joint_length())?;
    Some(pin_diameter(text, of_type)? * length)
}

/// Diameter of the pin \[m\], of the joints as written or those of the catalogue.
pub(super) fn pin_diameter(text: &schema::Chain, of_type: Option<&CatalogueChain>) -> Option<f64> {
    let joint = text.joint.as_ref();
    let given = joint.and_then(|joint| joint.pin_diameter).map(f64::from);
    given.or_else(|| of_type?.number(Number::PinDiameter))
}

/// Difference of pitches, relative, up to which they are the same.
const SAME_PITCH: f64 = 1e-3;

/// The chain as written, with the values of the catalogue where it has none.
pub(super) fn completed(
    text: &schema::Chain,
    chain: &CatalogueChain,
    findings: &mut Findings<'_>,
) -> schema::Chain {
    let mut text = text.clone();
    let mut take = CatalogueDefaults { chain, findings };
    take.number(&mut text.pitch, "pitch", Number::Pitch);
    take.number(
        &mut text.roller_diameter,
        "roller_diameter",
        Number::RollerDiameter,
    );
    take.number(&mut text.plate_height, "plate_height", Number::PlateHeight);
    take.number(
        &mut text.breaking_load,
        "breaking_load",
        Number::BreakingLoad,
    );
    if text.model.has_springs() {
        if text.masses.is_none() {
            take.value(&mut text.mass, "mass", chain.mass().map(Mass), Status::Mass);
        }
        if text.stiffnesses.is_none() {
            take.number(&mut text.stiffness, "stiffness", Number::LinkStiffness);
        }
        if text.rollers != Some(Rollers::Free) {
            return text;
        }
        let inner = text.inner.get_or_insert_default();
        take.number(&mut inner.mass, "inner.mass", Number::InnerMass);
        let outer = text.outer.get_or_insert_default();
        take.number(&mut outer.mass, "outer.mass", Number::OuterMass);
        take.roller(&mut text);
        take.joint(&mut text);
        return text;
    }
    let inner = text.inner.get_or_insert_default();
    take.number(&mut inner.mass, "inner.mass", Number::InnerMass);
    take.number(&mut inner.inertia, "inner.inertia", Number::InnerInertia);
    let outer = text.outer.get_or_insert_default();
    take.number(&mut outer.mass, "outer.mass", Number::OuterMass);
    take.number(&mut outer.inertia, "outer.inertia", Number::OuterInertia);
    if chain.kind == "bush" {
        let none = Some(Rollers::None);
        take.value(&mut text.rollers, "rollers", none, Status::Dimensions);
    }
    if text.rollers != Some(Rollers::None) {
        take.roller(&mut text);
    }
    if text.model.has_play() {
        take.joint(&mut text);
    }
    text
}

/// Takes from the catalogue what a scene leaves open.
struct CatalogueDefaults<'c, 'f, 't> {
    chain: &'c CatalogueChain,
    findings: &'f mut Findings<'t>,
}

impl CatalogueDefaults<'_, '_, '_> {
    fn roller(&mut self, text: &mut schema::Chain) {
        let roller = text.roller.get_or_insert_default();
        self.number(&mut roller.mass, "roller.mass", Number::RollerMass);
        self.number(&mut roller.inertia, "roller.inertia", Number::RollerInertia);
        self.number(
            &mut roller.bush_diameter,
            "roller.bush_diameter",
            Number::BushDiameter,
        );
    }

    fn joint(&mut self, text: &mut schema::Chain) {
        let joint = text.joint.get_or_insert_default();
        self.number(
            &mut joint.pin_diameter,
            "joint.pin_diameter",
            Number::PinDiameter,
        );
        let clearance = self.chain.joint_clearance().map(Length);
        self.value(
            &mut joint.clearance,
            "joint.clearance",
            clearance,
            Status::Bore,
        );
        let length = self.chain.joint_length().map(Length);
        self.value(
            &mut joint.length,
            "joint.length",
            length,
            Status::Dimensions,
        );
    }

    fn number<T: Serialize + From<f64>>(
        &mut self,
        place: &mut Option<T>,
        key: &str,
        number: Number,
    ) {
        let value = self.chain.number(number).map(T::from);
        self.value(place, key, value, number.status());
    }

    fn value<T: Serialize>(
        &mut self,
        place: &mut Option<T>,
        key: &str,
        value: Option<T>,
        status: Status,
    ) {
        if place.is_some() {
            return;
        }
        if let Some(Ok(json)) = value.as_ref().map(serde_json::to_value) {
            let remark = format!("{}: {}", self.chain.name, self.chain.status(status));
            self.findings.assume(&format!("chain.{key}"), json, remark);
        }
        *place = value;
    }
}
