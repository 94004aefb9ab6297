//! The scene format, as types: the one source of truth for parsing, messages and the shipped schema.
//!
//! Every comment on a key becomes its description in `chaindrive.schema.json`. A family of choices
//! is an enum whose members are told apart by `kind`; a member without further keys may be
//! written as its bare name, `support = "fixed"`.

mod chain;
mod contact;
mod force;
mod guide;
mod housing;
mod links;
mod lubricant;
mod motion;
mod route;
mod run;
mod shaft;
mod sprocket;
mod stack;
mod tensioner;
mod written;

pub(crate) use chain::{Chain, End, NamedChain, Start};
pub(crate) use contact::{Contact, Contacts, Flank};
pub(crate) use force::Force;
pub(crate) use guide::{Face, Guide, GuideSupport, TravelSide};
pub(crate) use housing::Housing;
pub(crate) use links::{ChainModel, Joint, Link, Roller, Rollers};
pub(crate) use lubricant::Lubricant;
pub(crate) use motion::{Motion, OrderTerm, StartSpeed, Torque};
pub(crate) use route::{Adjust, Route};
pub use run::RunDefaults;
pub(crate) use run::{EVERY, Run, STEPPING_KEYS, TOLERANCE, UNTIL};
pub(crate) use shaft::{Coupling, Gears, Shaft};
pub(crate) use sprocket::{
    GapErrors, GapWave, PathPiece, Seat, Side, Sprocket, Support, TipForm, Tooth,
};
pub(crate) use stack::Stack;
pub(crate) use tensioner::Tensioner;
pub(crate) use written::Written;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::Acceleration;

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
    /// Acceleration of gravity (x, y) [m/s²].
    pub(crate) gravity: Option<[Acceleration; 2]>,
    /// Whether the drive settles into static equilibrium under gravity and load before t = 0;
    /// absent: true.
    #[serde(default = "settle")]
    pub(crate) settle: bool,
    /// The chain, or the name of a chain of the catalogue, such as "16B-1".
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
    /// The oil; absent: parts that need a viscosity give their own.
    pub(crate) lubricant: Option<Lubricant>,
    /// The housing; absent: centres stay where they are.
    pub(crate) housing: Option<Housing>,
    /// Places of parameters that may be changed while the drive moves: `sprockets.NAME.load`, a factor on the loads of its shaft, also
    /// `shafts.NAME.load`; `tensioners.NAME.push.preload` and `tensioners.NAME.push.stiffness` of springs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("maxItems" = 100))]
    pub(crate) tunable: Vec<String>,
    /// How a closed chain lies around its sprockets; absent: around all sprockets, in file order.
    pub(crate) route: Option<Route>,
    /// Settings of a run and channels to record, unless the caller gives others.
    #[serde(default)]
    pub(crate) run: Run,
}

/// A version of chaindrive.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub(crate) enum Version {
    /// The present one.
    #[serde(rename = "0.3")]
    V0_3,
}

impl Version {
    /// The present one, as a scene writes it.
    pub(crate) const PRESENT: &str = "0.3";
}

fn settle() -> bool {
    true
}
