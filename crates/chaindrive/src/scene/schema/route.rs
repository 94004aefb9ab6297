//! The way of a closed chain.

use chaindrive_mechanics::{PretensionAt, SpanStart, Tighten};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{Angle, Force, Length, Ratio};

/// How a closed chain lies around its sprockets.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Route {
    /// Names of sprockets and curved guides in the order in which the chain passes them, a
    /// sprocket first; absent: all sprockets, in file order.
    pub(crate) stops: Option<Vec<String>>,
    /// Where the first sprocket stands within a tooth, 0 to 1 [–].
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub(crate) phase: Option<Ratio>,
    /// Tension of every link before gravity and load [N].
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) pretension: Force,
    /// Where the chain carries the pretension; absent: in the mean over a tooth that passes.
    pub(crate) pretension_at: Option<PretensionAt>,
    /// How the pretension is made; absent: by shorter links.
    #[serde(default)]
    pub(crate) tighten: Tighten,
    /// Sag of the slack span in its middle [m] under its own weight with the other spans pulled straight, made by what `adjust` moves, instead of
    /// a pretension; where nothing pulls, the spans share the slack, and two equal ones sag 0.71 times as deep. Absent: none is asked for.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) sag: Option<Length>,
    /// Name of the span, "from-to", that hangs where the chain is longer than its way; absent: the one that runs to the first stop,
    /// or the longest without a guide where a guide lies along that.
    pub(crate) slack_span: Option<String>,
    /// How the spans set off; absent: quiet.
    pub(crate) start: Option<SpanStart>,
    /// The body that is moved until the links close without stress; absent: none.
    pub(crate) adjust: Option<Adjust>,
}

/// The body that is moved until the given number of links closes without stress.
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
