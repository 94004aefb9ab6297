//! The scene format, as types: the one source of truth for parsing, messages and the shipped schema.
//!
//! Every comment on a key becomes its description in `chaindrive.schema.json`. A family of choices
//! is an enum whose members are told apart by `kind`; a member without further keys may be
//! written as its bare name, `support = "fixed"`.

mod chain;
mod contact;
mod friction;
mod guide;
mod links;
mod motion;
mod route;
mod run;
mod shaft;
mod sprocket;
mod tensioner;

pub(crate) use chain::{Chain, End, NamedChain, Start};
pub(crate) use contact::{Contact, Contacts, Cylinders, Dissipation, Elastic, Flank};
pub(crate) use friction::Friction;
pub(crate) use guide::{Face, Guide, GuideSupport, TravelSide};
pub(crate) use links::{ChainModel, Joint, Link, Roller, Rollers};
pub(crate) use motion::{Motion, OrderTerm, StartSpeed, Torque};
pub(crate) use route::{Adjust, Route};
pub(crate) use run::Run;
pub use run::RunDefaults;
pub(crate) use shaft::{Coupling, Gears, Shaft};
pub(crate) use sprocket::{PathPiece, Seat, Side, Sprocket, Support, TipForm, Tooth};
pub(crate) use tensioner::{Carrier, Oil, Push, Tensioner};

use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::defaults;
use super::quantity::Acceleration;

/// A chain drive: a chain, what it runs around, and how it starts.
///
/// Every quantity is a number in SI units or a text with a unit, such as "88.9 mm". Positions are
/// (x, y) with x to the right and y up; angles are counter-clockwise.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "chaindrive scene", extend("x-required-unless" = {"chains": ["chain"]}))]
pub(crate) struct SceneText {
    /// Address of the schema, for editors; ignored.
    #[serde(default, rename = "$schema", skip_serializing)]
    pub(crate) _schema: Option<String>,
    /// Version of the format that the scene is written in; absent: the present one.
    #[serde(default, skip_serializing)]
    pub(crate) format: Option<Version>,
    /// Version whose defaults hold for whatever the scene leaves open; absent: the present one.
    #[serde(default, skip_serializing)]
    pub(crate) defaults: Option<Version>,
    /// Title of the scene, in a line.
    #[serde(default)]
    pub(crate) title: String,
    /// Acceleration of gravity (x, y) [m/s²]; absent: 9.81 m/s² downward.
    #[serde(default)]
    pub(crate) gravity: Option<[Acceleration; 2]>,
    /// Whether the drive settles into static equilibrium under gravity and load before t = 0;
    /// absent: true.
    #[serde(default = "settle")]
    pub(crate) settle: bool,
    /// The chain, or the name of a chain of the catalogue, such as "16B-1".
    #[serde(default)]
    pub(crate) chain: Option<Chain>,
    /// Several chains, each with a name and a route of its own, instead of `chain` and `route`.
    #[serde(default)]
    #[schemars(extend("maxItems" = 100))]
    pub(crate) chains: Vec<NamedChain>,
    /// Contact laws that hold wherever a sprocket or guide does not give its own.
    #[serde(default)]
    pub(crate) contact: Contacts,
    /// The sprockets, usually in the order in which the chain passes them.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) sprockets: Vec<Sprocket>,
    /// Rails on which the chain slides.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) guides: Vec<Guide>,
    /// Movable carriers that press sprockets or guides on the chain.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) tensioners: Vec<Tensioner>,
    /// Shafts, where a sprocket does not turn by itself.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) shafts: Vec<Shaft>,
    /// Torsional springs and dampers between shafts.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) couplings: Vec<Coupling>,
    /// Pairs of gears between shafts.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) gears: Vec<Gears>,
    /// How a closed chain lies around its sprockets; absent: around all sprockets, in file order.
    #[serde(default)]
    pub(crate) route: Option<Route>,
    /// Settings of a run and channels to record, unless the caller gives others.
    #[serde(default)]
    pub(crate) run: Run,
}

/// A version of chaindrive.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize, JsonSchema,
)]
pub(crate) enum Version {
    /// The first one.
    #[serde(rename = "0.1")]
    V0_1,
    /// The second one.
    #[serde(rename = "0.2")]
    V0_2,
    /// The present one.
    #[default]
    #[serde(rename = "0.3")]
    V0_3,
}

impl Version {
    /// Every version, the first one first.
    pub(crate) const ALL: [Self; 3] = [Self::V0_1, Self::V0_2, Self::V0_3];

    /// Its name, as a scene writes it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::V0_1 => "0.1",
            Self::V0_2 => "0.2",
            Self::V0_3 => "0.3",
        }
    }
}

fn settle() -> bool {
    true
}

/// JSON Schema of the scene format (draft 2020-12), for editors and front ends.
///
/// Quantities carry their dimension as `x-dimension` and their SI unit as `x-unit`. The file
/// `chaindrive.schema.json` is this value.
pub fn schema() -> Value {
    let mut schema = raw().clone();
    defaults::put_into(&mut schema);
    for_editors(&mut schema);
    let chain = &mut schema["properties"]["chain"];
    *chain = json!({
        "description": chain["description"],
        "anyOf": [{"type": "string", "examples": ["16B-1"]}, {"$ref": chain["$ref"]}],
    });
    schema
}

/// The schema as derived, which the validator walks. Derived once: it takes longer than to read a scene.
pub(crate) fn raw() -> &'static Value {
    static RAW: LazyLock<Value> = LazyLock::new(|| schemars::schema_for!(SceneText).to_value());
    &RAW
}

/// Brings the schema to what the validator accepts: no `null`, and short forms allowed.
fn for_editors(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            for value in object.values_mut() {
                for_editors(value);
            }
            drop_null(object);
            allow_missing_kind(object);
            require_unless(object);
            allow_bare_kinds(object);
            allow_common_unit(object);
        }
        Value::Array(items) => items.iter_mut().for_each(for_editors),
        _ => {}
    }
}

fn drop_null(object: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            object.insert("type".into(), only);
        }
    }
    let says_nothing = |default: &Value| match default {
        Value::Null => true,
        Value::Object(table) => !table.contains_key("kind"),
        Value::Array(items) => items.is_empty(),
        _ => false,
    };
    if object.get("default").is_some_and(says_nothing) {
        object.remove("default");
    }
    if let Some(Value::Array(choices)) = object.get_mut("anyOf") {
        choices.retain(|choice| *choice != json!({"type": "null"}));
        if let [Value::Object(only)] = choices.as_slice() {
            let only = only.clone();
            object.remove("anyOf");
            for (key, value) in only {
                object.entry(key).or_insert(value);
            }
        }
    }
}

/// Some keys are required unless another one is there.
fn require_unless(object: &mut Map<String, Value>) {
    if let Some(Value::Object(unless)) = object.shift_remove("x-required-unless") {
        let choices = unless
            .into_iter()
            .flat_map(|(key, keys)| [json!({"required": [key]}), json!({"required": keys})]);
        object.insert("anyOf".into(), choices.collect());
    }
}

/// A table without `kind` may be one of the members.
fn allow_missing_kind(object: &mut Map<String, Value>) {
    let Some(kind) = object.remove("x-default-kind") else {
        return;
    };
    let members = object.get_mut("oneOf").and_then(Value::as_array_mut);
    for member in members.into_iter().flatten() {
        if member["properties"]["kind"]["const"] == kind
            && let Some(Value::Array(required)) = member.get_mut("required")
        {
            required.retain(|key| key != "kind");
        }
    }
}

/// `{ kind = "fixed" }` may be written `"fixed"`.
fn allow_bare_kinds(object: &mut Map<String, Value>) {
    let Some(Value::Array(members)) = object.get_mut("oneOf") else {
        return;
    };
    let bare: Vec<Value> = members
        .iter()
        .filter(|member| member["required"] == json!(["kind"]))
        .map(|member| member["properties"]["kind"]["const"].clone())
        .collect();
    if !bare.is_empty() {
        members.push(json!({
            "description": "A kind without further keys may be written as its bare name.",
            "enum": bare,
        }));
    }
}

/// `["1 ms", "2 ms"]` may be written `{ unit = "ms", values = [1, 2] }`.
fn allow_common_unit(object: &mut Map<String, Value>) {
    if object.get("type") != Some(&json!("array"))
        || object
            .get("items")
            .and_then(|items| items.get("x-dimension"))
            .is_none()
    {
        return;
    }
    let description = object.remove("description");
    let list = Value::Object(std::mem::take(object));
    let mut values = list.clone();
    values["items"] = json!({"type": "number"});
    if let Some(description) = description {
        object.insert("description".into(), description);
    }
    object.insert(
        "anyOf".into(),
        json!([list, {
            "type": "object",
            "properties": {"unit": {"type": "string"}, "values": values},
            "required": ["unit", "values"],
            "additionalProperties": false,
        }]),
    );
}
