//! The chain and the places where a strand begins.

use chaindrive_mechanics::LateralRub;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ChainModel, Joint, Link, Motion, Roller, Rollers, Route, Written};
use chaindrive_quantities::{
    AngularSpeed, Damping, Drag, Force, Length, Mass, Power, Ratio, Speed, Stiffness,
};

/// The chain. Written as a text, `chain = "16B-1"`, it is a chain of the catalogue in which
/// nothing is changed.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("x-required-unless" = {"type": ["pitch"]}))]
pub(crate) struct Chain {
    /// Name in the catalogue, such as "16B-1"; whatever is absent below comes from there.
    #[serde(default, rename = "type")]
    pub(crate) of_type: Option<String>,
    /// Model of the chain; absent: particles. The keys from `rollers` to `roller`, but for friction and damping in `joint`, are for
    /// rigid links and free rollers only; bush strands know `outer_first`, `joint.clearance` and `roller.length` too.
    #[serde(default)]
    pub(crate) model: ChainModel,
    /// Nominal pitch [m]: what the sprockets are cut for.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pitch: Option<Length>,
    /// Number of links; absent, around sprockets: the even number nearest to the taut route.
    #[schemars(extend("minimum" = 1, "maximum" = 100_000))]
    pub(crate) links: Option<u32>,
    /// Mass of one link [kg], at its roller.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Stiffness of one link [N/m]. Rigid links are laid and settled with it, nothing else; absent
    /// there: that of a joint under the pretension, or ten times that of a tooth.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) stiffness: Option<Stiffness>,
    /// Damping of one link [N s/m].
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: Option<Damping>,
    /// Damping ratio ζ of one link [–], c = 2 ζ √(k m), unless `damping` is given.
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping_ratio: Option<Ratio>,
    /// Drag of oil or air across every link, per length and speed [N s/m²]; absent: none.
    #[schemars(extend("minimum" = 0))]
    pub(crate) drag: Option<Drag>,
    /// Roller (or bush) diameter [m]. A strand that touches nothing may leave it out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) roller_diameter: Option<Length>,
    /// Height of the link plates [m]: what a guide for plates touches.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) plate_height: Option<Length>,
    /// Least breaking load [N]: the verdict says where a link bears more. Nothing yields or breaks for it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) breaking_load: Option<Force>,
    /// Strands side by side: the factor of its power in the rating is 1, 1.7, 2.5, 3.3, 3.9 or 4.6. Bush strands share loads in motion, and
    /// mass, stiffness, damping and breaking load are then those of one of them. The motion of other models is that of one chain: the values
    /// are those written, and from the catalogue those of a single strand. Absent: 1.
    #[schemars(extend("minimum" = 1, "maximum" = 6))]
    pub(crate) strands: Option<u32>,
    /// By how much the links of every strand are longer than those of the chain as written [–], one value for each; for bush strands. Absent:
    /// all are alike.
    pub(crate) strand_elongations: Option<Vec<Elongation>>,
    /// Stiffness of every strand, in that which is written [–], one value for each; for bush strands. Absent: 1 for all.
    pub(crate) strand_stiffnesses: Option<Vec<Share>>,
    /// Service factor [–], for the rating only: the power that is carried counts so many times. ISO 10823 has 1 for smooth running, 1.4 for
    /// moderate and 1.8 for heavy shocks of the driven machine, more with those of an engine.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) service_factor: Option<Ratio>,
    /// Power that its maker rates the chain for [W], for the rating only: all strands together, at the speed of this drive and the teeth of its
    /// smallest sprocket; absent: by formula, where one could be read for the type.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) rated_power: Option<Power>,
    /// Unstressed length of the inner links, every second one [m]; absent: the pitch.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inner_pitch: Option<Length>,
    /// Unstressed length of the outer links [m]; absent: the pitch.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) outer_pitch: Option<Length>,
    /// Wear: by how much every link is longer than new [–].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -0.5, "maximum" = 0.5))]
    pub(crate) elongation: Ratio,
    /// Random differences between the links; the same seed gives the same chain.
    pub(crate) scatter: Option<Scatter>,
    /// Unstressed length of every link [m], instead of `inner_pitch` and `outer_pitch`.
    pub(crate) pitches: Option<Vec<Length>>,
    /// Mass at every roller [kg], instead of `mass`. A strand has one roller more than links.
    pub(crate) masses: Option<Vec<Mass>>,
    /// Stiffness of every link [N/m], instead of `stiffness`.
    pub(crate) stiffnesses: Option<Vec<Stiffness>>,
    /// Rollers on the teeth; absent: lumped, or none for a bush chain of the catalogue. On particles `free` makes roller, bush and
    /// pin of every joint points of their own, with play between them.
    pub(crate) rollers: Option<Rollers>,
    /// Whether the first link is an outer one, with pins; absent: an inner one, with bushes.
    #[serde(default)]
    pub(crate) outer_first: bool,
    /// Links with bushes.
    pub(crate) inner: Option<Link>,
    /// Links with pins.
    pub(crate) outer: Option<Link>,
    /// Pins in their bushes.
    pub(crate) joint: Option<Joint>,
    /// Plates that rub where the chain runs out of line.
    #[serde(default)]
    pub(crate) lateral: Written<LateralRub>,
    /// Rollers on their bushes.
    pub(crate) roller: Option<Roller>,
    /// Conditions at the first and last roller: they make the chain an open strand.
    pub(crate) ends: Option<[End; 2]>,
    /// Where the chain lies at the start; absent: along the route.
    pub(crate) start: Option<Start>,
}

impl Chain {
    /// True for chains whose inner and outer links are not alike.
    pub(crate) fn alternates(&self) -> bool {
        !self.model.has_springs() || self.model.has_strands() || self.is_of_points()
    }

    /// True for chains with roller, bush and pin of every joint as points of their own.
    pub(crate) fn is_of_points(&self) -> bool {
        self.model.has_springs() && self.rollers == Some(Rollers::Free)
    }
}

/// One of several chains: all that a chain has, a name, and a route of its own.
///
/// Chains run in planes of their own. A sprocket or guide belongs to the chain whose route passes it, or that its `chain` names.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
pub(crate) struct NamedChain {
    /// Name, unique among the chains.
    pub(crate) name: String,
    /// How it lies around its sprockets; absent: around all that belong to it, in file order.
    pub(crate) route: Option<Route>,
    /// The chain.
    #[serde(flatten)]
    pub(crate) chain: Chain,
}

/// Random differences between links: normal, each with a relative standard deviation.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Scatter {
    /// Standard deviation of the link length over the pitch [–].
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) pitch: Ratio,
    /// Standard deviation of the mass over its mean [–].
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) mass: Ratio,
    /// Standard deviation of the stiffness over its mean [–].
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) stiffness: Ratio,
    /// Standard deviation of the roller diameter over its mean [–].
    #[schemars(extend("minimum" = 0, "maximum" = 0.05))]
    pub(crate) roller_diameter: Ratio,
    /// Which of the possible chains it is.
    #[schemars(extend("minimum" = 0))]
    pub(crate) seed: u32,
}

/// Condition at one end of an open strand.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum End {
    /// The end roller moves freely.
    Free,
    /// The end roller stays where it was laid.
    Fixed,
    /// The end roller follows a motion from where it was laid.
    Driven {
        /// Displacement along x; absent: none.
        #[serde(default)]
        x: Motion<Length, Speed>,
        /// Displacement along y; absent: none.
        #[serde(default)]
        y: Motion<Length, Speed>,
    },
    /// A constant force pulls at the end roller.
    Pulled {
        /// Force (x, y) [N].
        force: [Force; 2],
    },
}

/// Where the chain lies at the start, if not along a route.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Start {
    /// A strand drawn straight from one point to another, stretched or slack as the distance asks.
    Line {
        /// Place of the first roller (x, y) [m].
        from: [Length; 2],
        /// Place of the last roller (x, y) [m].
        to: [Length; 2],
    },
    /// A strand that hangs in an arc of its own length between two points.
    Hang {
        /// Place of the first roller (x, y) [m].
        from: [Length; 2],
        /// Place of the last roller (x, y) [m].
        to: [Length; 2],
    },
    /// A closed chain as a ring, stretched by its rotation.
    Ring {
        /// Centre of the ring (x, y) [m]; absent: the origin.
        #[serde(default)]
        centre: [Length; 2],
        /// Speed of rotation [rad/s].
        #[serde(default)]
        speed: AngularSpeed,
    },
    /// Every roller at a place of its own.
    Points {
        /// Places (x, y) of all rollers [m].
        positions: Vec<[Length; 2]>,
        /// Velocities (x, y) of all rollers [m/s]; absent: at rest.
        velocities: Option<Vec<[Speed; 2]>>,
    },
}

/// Elongation of a strand [–].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("exclusiveMinimum" = -0.5, "maximum" = 0.5))]
pub(crate) struct Elongation(Ratio);

impl From<Elongation> for f64 {
    fn from(value: Elongation) -> Self {
        value.0.0
    }
}

/// Stiffness of a strand, in that which is written [–].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("exclusiveMinimum" = 0))]
pub(crate) struct Share(Ratio);

impl From<Share> for f64 {
    fn from(value: Share) -> Self {
        value.0.0
    }
}
