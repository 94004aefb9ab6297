//! The chain and the places where a strand begins.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Motion;
use crate::scene::quantity::{AngularSpeed, Damping, Force, Length, Mass, Ratio, Speed, Stiffness};

/// The chain: point masses at the rollers, joined by links that are springs with dampers.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Chain {
    /// Nominal pitch [m]: what the sprockets are cut for.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pitch: Length,
    /// Number of links.
    #[schemars(extend("minimum" = 1, "maximum" = 100_000))]
    pub(crate) links: u32,
    /// Mass of one link [kg], at its roller.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Stiffness of one link [N/m].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) stiffness: Option<Stiffness>,
    /// Damping of one link [N s/m].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: Option<Damping>,
    /// Damping ratio ζ of one link [–], c = 2 ζ √(k m); absent, without `damping`: 0.03.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping_ratio: Option<Ratio>,
    /// Roller (or bush) diameter [m]. A strand that touches nothing may leave it out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) roller_diameter: Option<Length>,
    /// Height of the link plates [m]: what a guide for plates touches; absent: 1.4 roller
    /// diameters, as in the catalogues.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) plate_height: Option<Length>,
    /// Unstressed length of the inner links, the first link and every second one [m]; absent:
    /// the pitch.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inner_pitch: Option<Length>,
    /// Unstressed length of the outer links [m]; absent: the pitch.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) outer_pitch: Option<Length>,
    /// Wear: by how much every link is longer than new [–].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -0.5, "maximum" = 0.5))]
    pub(crate) elongation: Ratio,
    /// Random differences between the links; the same seed gives the same chain.
    #[serde(default)]
    pub(crate) scatter: Option<Scatter>,
    /// Unstressed length of every link [m], instead of `inner_pitch` and `outer_pitch`.
    #[serde(default)]
    pub(crate) pitches: Option<Vec<Length>>,
    /// Mass at every roller [kg], instead of `mass`. A strand has one roller more than links.
    #[serde(default)]
    pub(crate) masses: Option<Vec<Mass>>,
    /// Stiffness of every link [N/m], instead of `stiffness`.
    #[serde(default)]
    pub(crate) stiffnesses: Option<Vec<Stiffness>>,
    /// What happens at the first and last roller: this makes the chain an open strand.
    #[serde(default)]
    pub(crate) ends: Option<[End; 2]>,
    /// Where the chain lies at the start; absent: along the route.
    #[serde(default)]
    pub(crate) start: Option<Start>,
}

/// Random differences between links: normal, each with a relative standard deviation.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scatter {
    /// Standard deviation of the link length over the pitch [–].
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) pitch: Ratio,
    /// Standard deviation of the mass over its mean [–].
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) mass: Ratio,
    /// Standard deviation of the stiffness over its mean [–].
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub(crate) stiffness: Ratio,
    /// Which of the possible chains it is.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) seed: u32,
}

/// What happens at one end of an open strand.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
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
        #[serde(default)]
        velocities: Option<Vec<[Speed; 2]>>,
    },
}
