//! Sprockets, their teeth and what holds them.

use chaindrive_mechanics::{Bearing, ShaftDrag};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Contact, Flank, Force, Motion, StartSpeed, Torque, Written};
use chaindrive_quantities::{
    Angle, AngularSpeed, Damping, Inertia, Length, Mass, Ratio, Speed, Stiffness,
};

/// A toothed wheel.
///
/// With `motion` its angle is given in time; without, it turns freely with `inertia` under the
/// chain, `drive` and `load`. One that sits on one of the `shafts` turns with that.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sprocket {
    /// Name, unique among sprockets and guides.
    pub(crate) name: String,
    /// Name of the chain that it belongs to, where there are several and no route passes it.
    pub(crate) chain: Option<String>,
    /// Number of teeth.
    #[schemars(extend("minimum" = 5, "maximum" = 600))]
    pub(crate) teeth: u32,
    /// Centre (x, y) [m].
    pub(crate) centre: [Length; 2],
    /// Side of the travelling chain on which the wheel lies; absent: left, where all wheels
    /// inside a counter-clockwise loop are.
    #[serde(default)]
    pub(crate) side: Side,
    /// Depth of the steel below the tooth gaps [m], down to the bore or the inner edge of the rim, for the `stack` of its contact; absent:
    /// a solid body, which does not yield.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) rim: Option<Length>,
    /// Tooth form; absent: ISO 606 half-way between the extreme forms.
    pub(crate) tooth: Option<Tooth>,
    /// Rotation given in time. Excludes `drive`, `load` and `speed`.
    pub(crate) motion: Option<Motion<Angle, AngularSpeed>>,
    /// Moment of inertia about the centre, shaft included [kg m²]; needed without `motion`. Of one that sits on one of the
    /// `shafts`: its own, and none if absent.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) inertia: Option<Inertia>,
    /// Speed of a shaft without `motion` where the simulation begins, before the run-in [rad/s]: a number, or "working-point", at which
    /// all torques on what it is joined with balance. Absent: the speed of what it is joined with, or rest.
    #[schemars(
        with = "Option<AngularSpeed>",
        extend("x-words" = {"working-point": "working-point"}, "examples" = ["1450 rpm", "working-point"]),
    )]
    pub(crate) speed: Option<StartSpeed>,
    /// Torques that drive the shaft.
    #[serde(default)]
    pub(crate) drive: Vec<Torque>,
    /// Torques that load the shaft.
    #[serde(default)]
    pub(crate) load: Vec<Torque>,
    /// Friction of the bearings of its shaft; absent: none.
    pub(crate) bearing: Option<Written<Bearing>>,
    /// Drag of oil and air on its shaft; absent: none.
    pub(crate) drag: Option<Written<ShaftDrag>>,
    /// Mass [kg]; needed where the centre can move under forces.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) mass: Option<Mass>,
    /// Support of the centre; absent: a fixed bearing.
    pub(crate) support: Option<Support>,
    /// Forces on the centre along x, beside those of the chain: a fixed bearing bears them, a prescribed motion works against them, on springs or a
    /// tensioner they move the centre.
    #[serde(default)]
    pub(crate) force_x: Vec<Force>,
    /// Forces on the centre along y.
    #[serde(default)]
    pub(crate) force_y: Vec<Force>,
    /// Contact with the rollers, where it differs from `contact.teeth`.
    #[serde(default)]
    pub(crate) contact: Contact,
    /// Differences on the flanks of the teeth, instead of `contact.flanks`.
    pub(crate) flank: Option<Flank>,
    /// Distance of the centre of the teeth from the axis [m]: half of the run-out that a dial shows. Absent: none.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) eccentricity: Length,
    /// Direction of the centre of the teeth from the axis [rad], counter-clockwise from the axis of the first gap: along a route, the gap of the
    /// first roller that the wheel takes up.
    #[serde(default)]
    pub(crate) eccentricity_angle: Angle,
    /// Place of the middle of the teeth along the shaft [m]: where that of two sprockets differs, the chain between them runs out of line, see
    /// `chain.lateral`. It moves in the plane all the same.
    #[serde(default)]
    pub(crate) lateral: Length,
    /// Errors of the places of the tooth gaps; absent: none.
    pub(crate) gap_errors: Option<GapErrors>,
    /// Angle of one tooth gap [rad], for a wheel that no route passes.
    pub(crate) gap_angle: Option<Angle>,
}

/// Errors of the places of the tooth gaps, along the pitch circle, counter-clockwise. The first gap is that of `eccentricity_angle`,
/// and the others follow counter-clockwise.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum GapErrors {
    /// One value for every gap.
    List {
        /// Displacement of every gap [m].
        displacements: Vec<Length>,
    },
    /// Waves around the sprocket: Δᵢ = Σ a cos(n 2π i/z − φ).
    Orders {
        /// The waves.
        waves: Vec<GapWave>,
    },
    /// Normally distributed, every gap by itself.
    Random {
        /// Standard deviation [m].
        #[schemars(extend("minimum" = 0))]
        deviation: Length,
        /// Which of the possible sprockets it is.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        seed: u32,
    },
}

/// One wave of the places of tooth gaps around a sprocket.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GapWave {
    /// Periods n per turn.
    #[schemars(extend("minimum" = 1, "maximum" = 300))]
    pub(crate) order: u32,
    /// Amplitude a [m].
    pub(crate) amplitude: Length,
    /// Phase φ [rad].
    #[serde(default)]
    pub(crate) phase: Angle,
}

/// Side of the travelling chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Side {
    /// On the left: the chain turns counter-clockwise around the wheel.
    #[default]
    Left,
    /// On the right: the chain turns clockwise around the wheel.
    Right,
}

/// The profile of the teeth.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Tooth {
    /// The form of ISO 606, anywhere between its two extremes.
    Iso606 {
        /// Gap form between the minimum (0) and the maximum (1) [–], or "min", "mid", "max";
        /// absent: mid.
        #[serde(default = "mid")]
        #[schemars(extend(
            "x-words" = {"min": 0.0, "mid": 0.5, "max": 1.0},
            "examples" = ["mid"],
            "minimum" = 0,
            "maximum" = 1,
        ))]
        gap: Ratio,
        /// Tip diameter; absent: mid.
        #[serde(default)]
        tip: TipForm,
        /// Tip diameter [m], instead of `tip`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tip_diameter: Option<Length>,
        /// Where the seat is centred; absent: bottom.
        #[serde(default)]
        seat: Seat,
    },
    /// Type II of ASME B29.1.
    AsaTypeIi {
        /// Tip diameter; absent: mid, the standard turned diameter.
        #[serde(default)]
        tip: TipForm,
        /// Tip diameter [m], instead of `tip`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tip_diameter: Option<Length>,
    },
    /// A circular seat with straight flanks.
    Circular {
        /// Radius of the seat [m], at least that of the roller.
        #[schemars(extend("exclusiveMinimum" = 0))]
        seat_radius: Option<Length>,
        /// Tip diameter; absent: mid.
        #[serde(default)]
        tip: TipForm,
        /// Tip diameter [m], instead of `tip`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        tip_diameter: Option<Length>,
        /// Where the seat is centred; absent: bottom.
        #[serde(default)]
        seat: Seat,
    },
    /// A gap of lines and arcs, from the centre line of the tooth on the right through the seat to
    /// that of the tooth on the left. The wheel's centre is (0, 0), the gap lies on the +y axis.
    Path {
        /// First point (x, y) [m].
        from: [Length; 2],
        /// Pieces, each from the end of the one before.
        pieces: Vec<PathPiece>,
    },
    /// A measured gap, fitted by arcs; its frame and order are those of `path`.
    Points {
        /// Points (x, y) [m].
        points: Vec<[Length; 2]>,
        /// How far the arcs may stray from the points [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: Option<Length>,
    },
}

/// Half-way between the extremes.
fn mid() -> Ratio {
    Ratio(0.5)
}

/// Tip diameter within the limits of ISO 606.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TipForm {
    /// The smallest.
    Min,
    /// Half-way.
    #[default]
    Mid,
    /// The largest.
    Max,
}

/// Where the seat of a roller is centred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Seat {
    /// Rollers touch the bottom of the gap when they lie on the pitch circle.
    #[default]
    Bottom,
    /// On the pitch circle: a tight chain sinks below it by the clearance.
    Pitch,
}

/// One piece of a tooth gap.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum PathPiece {
    /// A straight line.
    Line {
        /// Its end (x, y) [m].
        to: [Length; 2],
    },
    /// A circular arc of less than a half turn.
    Arc {
        /// Its end (x, y) [m].
        to: [Length; 2],
        /// Its radius [m], positive where it turns left (counter-clockwise).
        radius: Length,
    },
}

/// Support of the centre of a sprocket.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Support {
    /// A fixed bearing.
    Fixed,
    /// A centre moved in time.
    Prescribed {
        /// Displacement along x; absent: none.
        #[serde(default)]
        x: Motion<Length, Speed>,
        /// Displacement along y; absent: none.
        #[serde(default)]
        y: Motion<Length, Speed>,
    },
    /// Bearing springs and dampers, unstressed at the assembled centre. Needs `mass`.
    Springs {
        /// Stiffness along x and y [N/m].
        stiffness: [Stiffness; 2],
        /// Damping along x and y [N s/m]; absent: none.
        #[serde(default)]
        damping: [Damping; 2],
    },
    /// Carried by a tensioner. Needs `mass`.
    Tensioner {
        /// Name of the tensioner.
        name: String,
    },
}
