//! Forces on centres and carriers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::{OrderTerm, Turns};
use chaindrive_quantities::{Angle, Force as Push, Ratio, Time};

/// A force along an axis, towards greater coordinates positive.
///
/// Times are those of the record, which begins at t = 0 after the run-in. Angles count from where the simulation began, before
/// the run-in.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Force {
    /// A constant force.
    Constant {
        /// Force [N].
        force: Push,
    },
    /// A force switched on softly, along a cubic.
    Ramp {
        /// Final force [N].
        force: Push,
        /// Time at which it begins [s].
        #[serde(default)]
        start: Time,
        /// Duration of the rise [s].
        #[schemars(extend("exclusiveMinimum" = 0))]
        duration: Time,
    },
    /// A force that repeats with the angle of the shaft of its sprocket, amplitude × sin(order θ + phase): one of `orders`.
    Harmonic {
        /// Amplitude [N].
        amplitude: Push,
        /// Periods per turn [–].
        #[schemars(extend("examples" = [0.5, 2, 7]))]
        order: Ratio,
        /// Phase where the simulation began, before the run-in [rad].
        #[serde(default)]
        phase: Angle,
    },
    /// Forces that repeat with the angle of a shaft, Σ amplitude × sin(order θ + phase), θ counted from where the simulation began.
    Orders {
        /// Name of the shaft, or of a sprocket on it, that θ belongs to; absent: that of the sprocket on which the force acts.
        of: Option<String>,
        /// The orders.
        terms: Vec<OrderTerm<Push>>,
    },
    /// A force over time, along straight lines, held beyond the ends.
    TimeTable {
        /// Times [s], increasing.
        times: Vec<Time>,
        /// Force at each of them [N].
        forces: Vec<Push>,
    },
    /// A force over the angle of a shaft within one turn or two, along straight lines; the last point joins the first.
    AngleTable {
        /// Name of the shaft, or of a sprocket on it, that the angle belongs to; absent: that of the sprocket on which the force acts.
        of: Option<String>,
        /// Turns after which it repeats.
        #[serde(default)]
        turns: Turns,
        /// Angles [rad], increasing from 0 to the end of the last turn.
        angles: Vec<Angle>,
        /// Force at each of them [N], the same at both ends.
        forces: Vec<Push>,
    },
}
