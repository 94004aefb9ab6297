//! Defaults of values that a scene leaves open: one table, with value, unit and source.
//!
//! Defaults of the drive stand here, those of `[run]` in `schema/run.rs`, of an accuracy in `accuracy.rs`: the parts of a scene are resolved with them,
//! the schema tells them to editors, and [`Scene::resolved`](super::Scene::resolved) writes it out. Scenes that say `defaults = "…"` are promised the values of
//! that release: whoever changes one after its release keeps the old value for them.
//!
//! An absent thing (no friction, no damping, a phase of zero) is no default in this sense: it
//! is the empty value of its type in `schema`.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use chaindrive_contact::dissipation::Hysteresis;
use chaindrive_mechanics::{BeamEnds, PretensionAt, SpanStart};
use serde::Serialize;
use serde_json::{Value as Json, json};

use super::expected::kind_of;

/// Source of a default.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Basis {
    /// Nothing but judgement; the text gives the reason.
    Assumed(&'static str),
    /// Something published, or a definition.
    Source(&'static str),
}

impl Basis {
    /// As a remark: "assumed: …", or the source.
    pub(crate) fn remark(self) -> Cow<'static, str> {
        match self {
            Self::Assumed("") => "assumed".into(),
            Self::Assumed(reason) => format!("assumed: {reason}").into(),
            Self::Source(source) => source.into(),
        }
    }
}

/// A number, or a member of a family, that is taken where a scene gives none.
#[derive(Debug)]
pub(crate) struct Default<T = f64> {
    /// Keys of the schema that it is for, as `Type.key`.
    pub(crate) keys: &'static [&'static str],
    /// Unit, or what it is a multiple of; none of a member of a family.
    pub(crate) unit: &'static str,
    /// Its source.
    pub(crate) basis: Basis,
    pub(crate) value: T,
}

impl Default {
    /// So many times a number that has its unit, and the remark about it.
    pub(crate) fn multiple(&self, of: f64) -> (f64, String) {
        let remark = format!("{} {}, {}", self.value, self.unit, self.basis.remark());
        (self.value * of, remark)
    }
}

impl<T: Serialize> Default<T> {
    /// Writes it into the schema, at all its keys.
    fn put_into(&self, schema: &mut Json) {
        let mut told = json!({"value": self.value});
        if !self.unit.is_empty() {
            told["unit"] = self.unit.into();
        }
        told["basis"] = self.basis.remark().into();
        for key in self.keys {
            for property in properties(schema, key) {
                match property["x-defaults"].as_array_mut() {
                    Some(list) => list.push(told.clone()),
                    None => property["x-defaults"] = json!([told]),
                }
            }
        }
    }
}

macro_rules! defaults {
    (
        choices { $($(#[$choice_doc:meta])* $choice:ident: $type:ty = $member:expr, $why:expr, $places:expr;)* }
        numbers { $($(#[$doc:meta])* $name:ident = $value:expr, $unit:literal, $basis:expr, $keys:expr;)* }
    ) => {
        $($(#[$choice_doc])* pub(crate) static $choice: Default<$type> = Default {
            keys: &$places,
            unit: "",
            basis: $why,
            value: $member,
        };)*
        $($(#[$doc])* pub(crate) static $name: Default = Default {
            keys: &$keys,
            unit: $unit,
            basis: $basis,
            value: $value,
        };)*
        /// Every number.
        static NUMBERS: &[&Default] = &[$(&$name),*];

        /// Writes the defaults into the schema, as `x-defaults`.
        pub(crate) fn put_into(schema: &mut Json) {
            for default in NUMBERS {
                default.put_into(schema);
            }
            $($choice.put_into(schema);)*
        }
    };
}

use Basis::{Assumed, Source};

const STEEL: &str = "steel on steel";

defaults! {
choices {
    /// Motion of the spans at the start.
    SPAN_START: SpanStart = SpanStart::Quiet, Assumed("what polygons do across a span at one instant averages to nothing over a tooth"), ["Route.start"];
    /// Phase at which a chain carries its pretension.
    PRETENSION_AT: PretensionAt = PretensionAt::MeanPhase, Assumed("a drive is not another one for where it happens to stand"), ["Route.pretension_at"];
    /// Energy loss of impacts.
    DISSIPATION: Hysteresis = Hysteresis::Exact, Assumed("delivers the restitution that is asked for, Lankarani and Nikravesh's law of version 0.1 does not"), ["Contact.dissipation"];
    /// Support of pins in their plates.
    PIN_ENDS: BeamEnds = BeamEnds::Supported, Assumed("pressed into plates that are thinner than the pin and turn with it"), ["Stack.pin_ends"];
    /// Motion before t = 0.
    RUN_IN: &str = "auto where the inputs of closed chains repeat, else 0 s", Assumed("whoever simulates a closed chain whose inputs repeat wants its steady motion; others begin as they stand"), ["Run.run_in"];
}
numbers {
    /// Acceleration of gravity along y.
    GRAVITY = -9.81, "m/s^2", Source("standard gravity, to three digits"), ["SceneText.gravity"];
    /// Damping ratio ζ of a link.
    DAMPING_RATIO = 0.03, "1", Assumed("measured values are not published, 0.01 to 0.05 are in use"), ["Chain.damping_ratio"];
    /// Height of the link plates.
    PLATE_HEIGHT = 1.4, "roller diameters", Source("1.31 to 1.47 in the catalogues"), ["Chain.plate_height"];
    /// Strands of a chain that is rated.
    STRANDS = 1.0, "1", Assumed("the catalogue has single strands"), ["Chain.strands"];
    /// Service factor of a chain that is rated.
    SERVICE_FACTOR = 1.0, "1", Assumed("none: a smooth load, for which power is rated"), ["Chain.service_factor"];
    /// Roller diameter of a strand that touches nothing.
    ROLLER_DIAMETER = 0.6, "pitches", Assumed("it touches nothing"), ["Chain.roller_diameter"];
    /// Laying stiffness of rigid links with ideal joints.
    LAYING_STIFFNESS = 10.0, "stiffnesses of a tooth", Assumed("their stretch must not show beside the indentation of the teeth"), ["Chain.stiffness"];
    /// Compliance of links beside their joints with clearance.
    PLATES = 1.0, "of what the stiffness of a link leaves beside its joint", Source("the stiffness of a link is that between its pins, joints included"), ["Contact.series"];
    /// Compliance of pins where roller, bush and pin are points: the rest is in the links.
    PINS = 0.5, "of what the stiffness of a link leaves beside its joint", Assumed("half of it is in the pins, which bend whichever way they are pushed, and half in plates; impacts are then those of rigid links with the whole behind their pins"), ["Contact.series"];
    /// Load at which what lies behind teeth is reckoned.
    BEHIND_TEETH = 0.1, "breaking loads", Assumed("roller on bush and bush on pin as secants of their conformal laws at a load that strikes; the play of rollers as that of pins"), ["Contact.series"];
    /// Load at which the contacts of the whole stack behind teeth are reckoned.
    STACK_LOAD = 0.1, "1", Assumed("of the breaking load: about a force that strikes"), ["Stack.load"];
    /// Restitution on teeth.
    TEETH_RESTITUTION = 0.8, "1", Assumed("teeth of steel"), ["Contact.restitution"];
    /// Restitution on guides.
    GUIDES_RESTITUTION = 0.5, "1", Assumed("a lining of rubber or plastic"), ["Contact.restitution"];
    /// Restitution of pins in their bushes.
    JOINTS_RESTITUTION = 0.7, "1", Assumed("steel in an oiled bush"), ["Contact.restitution"];
    /// Friction in joints of chains of the catalogue.
    JOINTS_FRICTION = 0.1, "1", Assumed("steel on oiled steel with boundary lubrication, 0.1 to 0.15"), ["Contact.friction"];
    /// Spring with which friction in joints holds.
    JOINTS_SPRING = 0.1, "link stiffnesses times the pitch over the radius of the pin, squared", Assumed("explicit steps stay those of the links, and a strand slides when its joints have turned by some 1e-5"), ["Friction.stiffness"];
    /// The same where pins have play, and the spring resists motion as well as rotation.
    PLAY_SPRING = 0.82, "link stiffnesses", Source("2(1 − ν)/(2 − ν) with ν = 0.3: how much a contact resists across of what it resists along (R. D. Mindlin, J. Appl. Mech. 16, 1949, 259–268); assumed that pins and plates behind it do alike"), ["Friction.stiffness"];
    /// Pressure coefficient of oil.
    PRESSURE_VISCOSITY = 20e-9, "1/Pa", Source("machine oils at 60 °C have 20 to 26, from 30 to 100 °C 13 to 29 1/GPa (G. W. Stachowiak, A. W. Batchelor, Engineering Tribology, table 2.3)"), ["Film.pressure_coefficient"];
    /// Roughness at which metal bears the rest of a film.
    FILM_ROUGHNESS = 0.8e-6, "m", Assumed("0.4 to 1.6 µm, as turned and hardened"), ["Film.roughness"];
    /// Time in which oil comes back.
    REFILL_TIME = 0.0, "s", Assumed("flooded: oil follows the surfaces at once, up to the thickness at touch"), ["Film.refill_time"];
    /// Hersey number at which metal bears half.
    TRANSITION = 1e-6, "1", Assumed("journals run in oil alone from η ω/P of some 0.5e-6 (McKee's 30 cP rpm/psi) to 11e-6 (what designers keep to) on"), ["Friction.transition"];
    /// Friction of plates where a chain runs out of line.
    LATERAL_FRICTION = 0.1, "1", Assumed("steel on oiled steel with boundary lubrication, 0.1 to 0.15"), ["Lateral.friction"];
    /// Lever of plates that rub.
    LATERAL_LEVER = 0.5, "plate heights", Assumed("they rub at their edges, where the side of a tooth ends; 0.4 to 0.7 of them"), ["Lateral.lever"];
    /// Lateral play of a chain.
    LATERAL_PLAY = 0.0, "m", Assumed("none, so that the loss is rather too great"), ["Lateral.play"];
    /// Restitution of bushes in free rollers.
    ROLLERS_RESTITUTION = 0.7, "1", Assumed("steel in an oiled roller"), ["Contact.restitution"];
    /// Least closing speed that a restitution reckons with.
    ONSET_FLOOR = 0.05, "m/s", Assumed("keeps contacts that begin gently from overdamping"), ["Contact.onset_floor"];
    /// Stiffness of teeth under a chain of particles.
    TEETH_STIFFNESS = 5.0, "link stiffnesses", Assumed("stiffer than a link, which bends its pins"), ["Contact.law"];
    /// Stiffness of guides.
    GUIDES_STIFFNESS = 1.0, "link stiffnesses", Assumed("a lining as soft as a link"), ["Contact.law"];
    /// Young's modulus.
    MODULUS = 207e9, "Pa", Assumed(STEEL), ["Elastic.modulus"];
    /// Poisson's ratio.
    POISSON = 0.3, "1", Assumed(STEEL), ["Elastic.poisson"];
    /// Passage from the law of the seat to that of the flank, on either side.
    FLANK_WIDTH = 0.05, "roller diameters", Assumed("about the half-width of the patch of contact"), ["Flank.width"];
    /// Speed of slip at which friction is fully there.
    SLIP_SPEED = 0.05, "m/s", Assumed("small beside the speeds at which chains slide"), ["Friction.slip_speed"];
    /// Normal force at which viscous friction is whole.
    TRANSITION_FORCE = 1.0, "N", Assumed("small beside the forces of a chain"), ["Friction.transition_force"];
    /// Speed over which the torque of a bearing reverses.
    CREEP_SPEED = 0.1, "rad/s", Assumed("small beside the speeds at which shafts turn"), ["Bearing.creep_speed"];
    /// Boundary lubrication in rolling bearings.
    BEARING_BOUNDARY = 0.15, "1", Source("SKF, Rolling bearings, 2013: generally about 0.15"), ["Bearing.boundary_coefficient"];
    /// Full film in ball bearings.
    BEARING_FILM = 0.05, "1", Source("SKF, Rolling bearings, 2013: 0.05 with mineral, 0.04 with synthetic oil, 0.1 with transmission fluids"), ["Bearing.full_film_coefficient"];
    /// Growth of the drag of a shaft with its speed.
    DRAG_EXPONENT = 2.0, "1", Assumed("oil that is thrown and air that is stirred resist with the square of the speed"), ["ShaftDrag.exponent"];
    /// Thermal expansion of chain and sprockets.
    CHAIN_EXPANSION = 11.5e-6, "1/K", Source("steel, 11e-6 to 13e-6 in the tables"), ["Housing.chain_expansion"];
    /// Temperature at which a chain was fitted.
    ASSEMBLED_AT = 293.15, "K", Assumed("a workshop at 20 °C"), ["Housing.assembled_at"];
    /// Viscosity index of an oil.
    VISCOSITY_INDEX = 95.0, "1", Assumed("mineral oils, 90 to 105"), ["Lubricant.viscosity_index"];
    /// Density of an oil at 15 °C.
    OIL_DENSITY = 880.0, "kg/m^3", Assumed("mineral oils, 860 to 900 kg/m³"), ["Lubricant.density"];
    /// Gap between the extremes of ISO 606.
    GAP = 0.5, "1", Assumed("half-way between the extreme forms of ISO 606"), ["Sprocket.tooth"];
    /// Radius of a circular seat.
    SEAT_RADIUS = 0.505, "roller diameters", Source("ISO 606, smallest seat"), ["Tooth.seat_radius"];
    /// Angle of a gap on a sprocket that no route passes.
    GAP_ANGLE = FRAC_PI_2, "rad", Assumed("a gap upward"), ["Sprocket.gap_angle"];
    /// Deviation of the fit from measured points.
    TOLERANCE = 1e-3, "pitches", Assumed("finer than teeth are cut"), ["Tooth.tolerance"];
    /// Radius of the ends of a bar.
    END_RADIUS = 0.25, "straight lengths", Assumed(""), ["Face.end_radius"];
    /// Angle of the ends of a bar.
    END_ANGLE = PI / 18.0, "rad", Assumed("10 degrees lead the chain in"), ["Face.end_angle"];
    /// Place of the first sprocket within a tooth.
    PHASE = 0.5, "1", Assumed("symmetric"), ["Route.phase"];
}
}

/// The keys of a type of the schema, or of one kind of a family, that have a default in their own unit.
pub(crate) fn of_keys(
    schema: &'static Json,
    of_type: &str,
    kind: Option<&str>,
) -> Vec<(&'static str, &'static Default)> {
    let table = &schema["$defs"][of_type];
    let members = table.get("oneOf").and_then(Json::as_array);
    let of_kind = |member: &&Json| kind_of(member) == kind;
    let table = members.map_or(Some(table), |list| list.iter().find(of_kind));
    let unit = |key: &str| table?.get("properties")?.get(key)?.get("x-unit")?.as_str();
    let keys = |default: &'static &Default| {
        let names = default
            .keys
            .iter()
            .filter_map(|place| place.split_once('.'));
        let of_this =
            names.filter(|(name, key)| *name == of_type && unit(key) == Some(default.unit));
        of_this.map(|(_, key)| (key, *default)).collect::<Vec<_>>()
    };
    NUMBERS.iter().flat_map(keys).collect()
}

/// The properties of the schema called `Type.key`, one for every member of a family.
fn properties<'s>(schema: &'s mut Json, place: &str) -> Vec<&'s mut Json> {
    let (of_type, key) = place.split_once('.').unwrap_or_default();
    let table = if of_type == "SceneText" {
        Some(schema)
    } else {
        schema["$defs"].get_mut(of_type)
    };
    let Some(table) = table.and_then(Json::as_object_mut) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for (name, part) in table {
        match name.as_str() {
            "properties" => found.extend(part.get_mut(key)),
            "oneOf" => {
                let members = part.as_array_mut().into_iter().flatten();
                found.extend(members.filter_map(|member| member["properties"].get_mut(key)));
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::raw;

    #[test]
    fn every_default_is_finite_and_has_a_key_in_the_schema() {
        let mut schema = raw().clone();
        for default in NUMBERS {
            assert!(default.value.is_finite(), "{default:?}");
            for key in default.keys {
                assert!(!properties(&mut schema, key).is_empty(), "{key}");
            }
        }
    }
}
