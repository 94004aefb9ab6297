//! The way of a closed chain, and what a front end runs by default.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::quantity::{Angle, Force, Length, Ratio, Time};

/// How a closed chain lies around its sprockets.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Route {
    /// Names of sprockets and curved guides in the order in which the chain passes them, a
    /// sprocket first; absent: all sprockets, in file order.
    #[serde(default)]
    pub(crate) stops: Option<Vec<String>>,
    /// Where the first sprocket stands within a tooth, 0 to 1 [–]; absent: 0.5, symmetric.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub(crate) phase: Option<Ratio>,
    /// Tension of every link before gravity and load [N]; absent: 0.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) pretension: Force,
    /// How the pretension is made; absent: by shorter links.
    #[serde(default)]
    pub(crate) tighten: Tighten,
    /// What is moved until the links close without stress; absent: nothing.
    #[serde(default)]
    pub(crate) adjust: Option<Adjust>,
}

/// How the pretension is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Tighten {
    /// The links are made shorter by the strain of the pretension.
    #[default]
    RestLength,
    /// The adjusted body moves on until the chain carries the pretension.
    Travel,
}

/// What is moved until the given number of links closes without stress.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Adjust {
    /// Nothing: a small misfit becomes strain, an excess of length becomes sag.
    Nothing,
    /// A sprocket, along a direction.
    Sprocket {
        /// Its name.
        name: String,
        /// Direction (x, y), of any length.
        direction: [Ratio; 2],
        /// How far it may move either way [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        within: Length,
    },
    /// A tensioner that travels, like a slider.
    Slider {
        /// Its name.
        name: String,
        /// How far it may move either way [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        within: Length,
    },
    /// A tensioner that turns, like an arm.
    Arm {
        /// Its name.
        name: String,
        /// How far it may turn either way [rad].
        #[schemars(extend("exclusiveMinimum" = 0))]
        within: Angle,
    },
}

/// What a front end runs and records unless told otherwise.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Run {
    /// Duration of the run [s].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) until: Option<Time>,
    /// Time between two samples of the recording [s].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) every: Option<Time>,
    /// Time stepping.
    #[serde(default)]
    pub(crate) method: Option<Method>,
    /// Step of a method with a fixed step [s].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) step: Option<Time>,
    /// Relative tolerance of a method under error control [–].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub(crate) tolerance: Option<Ratio>,
    /// Deepest penetration at which a contact may begin [m]: deeper steps are shortened; absent:
    /// contacts begin wherever the step lands, but with implicit damping no deeper than an approach at 1 m/s takes them
    /// in a step.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) onset_depth: Option<Length>,
    /// Relative error of the tension that method, step and onset depth are chosen for, 0 to 1; it takes the
    /// place of what is said about them. Absent: 0.01, unless one of them or a tolerance is given.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub(crate) accuracy: Option<Ratio>,
    /// Channels to record.
    #[serde(default)]
    pub(crate) record: Option<Vec<String>>,
    /// Contacts to log, each from touch to parting; absent: none.
    #[serde(default)]
    pub(crate) events: Vec<Events>,
}

/// Contacts that can be logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Events {
    /// Rollers on teeth.
    Teeth,
    /// Rollers and plates on guides.
    Guides,
    /// Pins in bushes, and bushes in free rollers.
    Joints,
}

/// A method of time stepping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Method {
    /// What suits the chain: implicit damping for rigid links, Verlet for particles.
    Auto,
    /// Velocity Verlet, fixed step: fast and without energy drift.
    Verlet,
    /// The classical Runge–Kutta method of order 4, fixed step.
    Rk4,
    /// The Dormand–Prince pair of order 5(4), step under error control.
    DormandPrince,
    /// Damping implicit and stiffness explicit, order 1, fixed step; for rigid links only.
    ImplicitDamping,
    /// The implicit generalized-α method of order 2, fixed step; for rigid links only.
    GeneralizedAlpha,
}

impl Method {
    /// Its name, as a scene writes it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Verlet => "verlet",
            Self::Rk4 => "rk4",
            Self::DormandPrince => "dormand-prince",
            Self::ImplicitDamping => "implicit-damping",
            Self::GeneralizedAlpha => "generalized-alpha",
        }
    }
}
