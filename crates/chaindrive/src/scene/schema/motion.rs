//! Prescribed motions and shaft torques.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{
    Angle, AngularDamping, AngularSpeed, Frequency, QuadraticDamping, Ratio, Time, Torque as Moment,
};

/// A coordinate given in time, counted from the assembled position.
///
/// Times are those of the record, which begins at t = 0 after the run-in. Angles and turns count from where the simulation
/// began, before the run-in.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(rename = "Motion_of_{Position}")]
pub(crate) enum Motion<Position, Rate> {
    /// Held where it was assembled.
    #[default]
    Held,
    /// A constant speed.
    Constant {
        /// Speed.
        speed: Rate,
    },
    /// A speed that goes from one value to another without a jump of acceleration.
    Ramp {
        /// Speed before.
        from: Rate,
        /// Speed after.
        to: Rate,
        /// Time at which the change begins [s].
        #[serde(default)]
        start: Time,
        /// Duration of the change [s].
        #[schemars(extend("exclusiveMinimum" = 0))]
        duration: Time,
    },
    /// A mean speed with sine terms, amplitude × (sin(2π f t + phase) − sin(phase)).
    Harmonics {
        /// Mean speed.
        speed: Option<Rate>,
        /// The sine terms.
        terms: Vec<Term<Position>>,
    },
    /// A mean speed with sine terms that repeat with the turns of a shaft,
    /// amplitude × (sin(order α + phase) − sin(phase)), α its angle at its mean speed since the simulation began.
    Orders {
        /// Mean speed.
        speed: Option<Rate>,
        /// Name of the shaft, or of a sprocket on it, whose turns count: its motion is given, with a mean speed, or gears join it with
        /// such a shaft. Absent: the shaft that this motion turns.
        of: Option<String>,
        /// The orders.
        terms: Vec<OrderTerm<Position>>,
    },
    /// Values at given times, joined by a natural cubic spline: smooth, and between them it may run beyond them.
    Table {
        /// Times [s], increasing.
        times: Vec<Time>,
        /// Position (an angle, or a length) at each of them.
        values: Vec<Position>,
    },
    /// Speeds at given times, joined by straight lines and held beyond the ends; the position follows from them. What stands between two
    /// speeds of zero stands still.
    SpeedTable {
        /// Times [s], increasing.
        times: Vec<Time>,
        /// Speed at each of them.
        speeds: Vec<Rate>,
    },
}

/// One sine term of a motion.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Term_of_{Position}")]
pub(crate) struct Term<Position> {
    /// Amplitude (an angle, or a length).
    pub(crate) amplitude: Position,
    /// Frequency [Hz].
    #[schemars(extend("minimum" = 0))]
    pub(crate) frequency: Frequency,
    /// Phase at t = 0, where the record begins [rad].
    #[serde(default)]
    pub(crate) phase: Angle,
}

/// One order of a motion, a torque or a force: what repeats so many times a turn.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Order_of_{Amplitude}")]
pub(crate) struct OrderTerm<Amplitude> {
    /// Periods per turn [–]: 0.5 repeats every second turn. The mean is no order.
    #[schemars(extend(
        "exclusiveMinimum" = 0,
        "examples" = [0.5, 2, 7],
        "x-remedy" = "the mean is no order: give that of a motion as its `speed`, that of a torque or force as one of the kind `constant` in the same list, that of a centre or guide as its place",
    ))]
    pub(crate) order: Ratio,
    /// Amplitude (an angle, a length, a torque or a force).
    pub(crate) amplitude: Amplitude,
    /// Phase where the simulation began, before the run-in [rad].
    #[serde(default)]
    pub(crate) phase: Angle,
}

/// Speed of a free shaft where the simulation begins.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged)]
pub(crate) enum StartSpeed {
    /// A speed.
    Given(AngularSpeed),
    /// A word in its place.
    Word(WorkingPoint),
}

/// The word for the speed at which torques balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum WorkingPoint {
    WorkingPoint,
}

/// Turns after which a table of torques or forces repeats: 1, or 2 for engines of four strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 1, "maximum" = 2))]
pub(crate) struct Turns(pub(crate) u32);

impl Default for Turns {
    fn default() -> Self {
        Self(1)
    }
}

/// A torque on a shaft, counter-clockwise positive.
///
/// Times are those of the record, which begins at t = 0 after the run-in. Angles count from where the simulation began, before
/// the run-in.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Torque {
    /// A constant torque.
    Constant {
        /// Torque [N m].
        torque: Moment,
    },
    /// A torque switched on softly, along a cubic.
    Ramp {
        /// Final torque [N m].
        torque: Moment,
        /// Time at which it begins [s].
        #[serde(default)]
        start: Time,
        /// Duration of the rise [s].
        #[schemars(extend("exclusiveMinimum" = 0))]
        duration: Time,
    },
    /// A resistance that opposes the rotation, −linear ω − quadratic ω |ω|.
    Resistance {
        /// Linear coefficient [N m s].
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        linear: AngularDamping,
        /// Quadratic coefficient [N m s²].
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        quadratic: QuadraticDamping,
    },
    /// A torque that repeats with the angle of its shaft, amplitude × sin(order θ + phase): one of `orders`.
    Harmonic {
        /// Amplitude [N m].
        amplitude: Moment,
        /// Periods per turn [–].
        #[schemars(extend("examples" = [0.5, 2, 7]))]
        order: Ratio,
        /// Phase where the simulation began, before the run-in [rad].
        #[serde(default)]
        phase: Angle,
    },
    /// Torques that repeat with the angle of a shaft, Σ amplitude × sin(order θ + phase), θ counted from where the simulation began.
    Orders {
        /// Name of the shaft, or of a sprocket on it, that θ belongs to; absent: the one that the torque acts on.
        of: Option<String>,
        /// The orders.
        terms: Vec<OrderTerm<Moment>>,
    },
    /// A torque over time, along straight lines, held beyond the ends.
    TimeTable {
        /// Times [s], increasing.
        times: Vec<Time>,
        /// Torque at each of them [N m].
        torques: Vec<Moment>,
    },
    /// A torque over the angle of a shaft within one turn or two, along straight lines; the last point joins the first.
    AngleTable {
        /// Name of the shaft, or of a sprocket on it, that the angle belongs to; absent: the one that the torque acts on.
        of: Option<String>,
        /// Turns after which it repeats.
        #[serde(default)]
        turns: Turns,
        /// Angles [rad], increasing from 0 to the end of the last turn.
        angles: Vec<Angle>,
        /// Torque at each of them [N m], the same at both ends.
        torques: Vec<Moment>,
    },
    /// A torque over the speed, along straight lines, held beyond the ends.
    SpeedTable {
        /// Speeds [rad/s], increasing.
        speeds: Vec<AngularSpeed>,
        /// Torque at each of them [N m].
        torques: Vec<Moment>,
    },
}
