//! Rails on which the chain slides.

use chaindrive_mechanics::Touches;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Contact, Motion};
use chaindrive_quantities::{Angle, Length, Ratio, Speed};

/// A rail.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Guide {
    /// Name, unique among sprockets and guides.
    pub(crate) name: String,
    /// Name of the chain that it belongs to, where there are several and no route passes it.
    pub(crate) chain: Option<String>,
    /// Working face.
    pub(crate) face: Face,
    /// Which part of the chain touches it; absent: the rollers.
    #[serde(default)]
    pub(crate) touches: Touches,
    /// Its support; absent: bolted to the frame.
    pub(crate) support: Option<GuideSupport>,
    /// Contact with the chain, where it differs from `contact.guides`.
    #[serde(default)]
    pub(crate) contact: Contact,
}

/// The working face of a guide.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Face {
    /// A straight bar whose ends curve away from the chain.
    Bar {
        /// Where the straight part begins (x, y) [m].
        start: [Length; 2],
        /// Where the straight part ends (x, y) [m].
        end: [Length; 2],
        /// Radius of the curved ends [m]; absent: a quarter of the straight length.
        #[schemars(extend("exclusiveMinimum" = 0))]
        end_radius: Option<Length>,
        /// Angle of the curved ends [rad].
        #[schemars(extend("exclusiveMinimum" = 0))]
        end_angle: Option<Angle>,
        /// Side of the line from `start` to `end` on which the material lies; absent: right,
        /// which is the outside when the line runs with a counter-clockwise chain.
        #[serde(default)]
        material: TravelSide,
    },
    /// A polygon with rounded corners.
    Points {
        /// Corners (x, y) [m].
        points: Vec<[Length; 2]>,
        /// Radii at the inner corners [m], two fewer than points.
        #[serde(default)]
        radii: Vec<Length>,
        /// Side of the path on which the material lies; absent: right.
        #[serde(default)]
        material: TravelSide,
    },
    /// A convex circular arc of up to a full turn, with a sharp edge at either end.
    Arc {
        /// Centre (x, y) [m].
        centre: [Length; 2],
        /// Radius [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// Angle at which the face begins [rad].
        from: Angle,
        /// Angle at which it ends [rad], counter-clockwise from `from`.
        to: Angle,
    },
    /// On the straight span between two sprockets, placed by shares of its length: convex by a radius, or a straight bar.
    OnSpan {
        /// Names of the sprockets before and behind, in the order of travel; absent: those beside it among the stops of the route.
        between: Option<[String; 2]>,
        /// Share of the span at which the face begins, from 0 where the chain leaves the sprocket before [–].
        from: Ratio,
        /// Share of the span at which it ends [–].
        to: Ratio,
        /// Radius of the face [m]; absent: straight, with ends that curve away from the chain.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Option<Length>,
        /// Share of the span at which a convex face bends the chain most, as where a shoe touches; absent: half-way from `from` to `to` [–].
        crest: Option<Ratio>,
        /// How far the face pushes the chain across the straight span [m], negative where it keeps clear; absent: as far
        /// as makes the links close without stress where the first sprocket stands symmetric, for one convex face that is a stop.
        bow: Option<Length>,
        /// Radius of the ends of a straight face [m]; absent: a quarter of its length, or where such ends would cut into the teeth of the sprockets beside it,
        /// so much less that they clear them.
        #[schemars(extend("exclusiveMinimum" = 0))]
        end_radius: Option<Length>,
        /// Angle of the ends of a straight face [rad].
        #[schemars(extend("exclusiveMinimum" = 0))]
        end_angle: Option<Angle>,
        /// Side of the chain on which the material lies; absent: right, which is the outside of a counter-clockwise chain.
        #[serde(default)]
        material: TravelSide,
    },
}

/// Side of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TravelSide {
    /// On the left of travel.
    Left,
    /// On the right of travel.
    #[default]
    Right,
}

/// Support of a guide.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum GuideSupport {
    /// Bolted to the frame.
    Fixed,
    /// Moved in time.
    Prescribed {
        /// Displacement along x; absent: none.
        #[serde(default)]
        x: Motion<Length, Speed>,
        /// Displacement along y; absent: none.
        #[serde(default)]
        y: Motion<Length, Speed>,
    },
    /// Carried by a tensioner.
    Tensioner {
        /// Name of the tensioner.
        name: String,
    },
}
