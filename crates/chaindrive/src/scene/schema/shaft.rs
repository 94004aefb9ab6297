//! Shafts, couplings and gears.

use chaindrive_mechanics::{Bearing, ShaftDrag};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Motion, StartSpeed, Torque, Written};
use chaindrive_quantities::{Angle, AngularDamping, AngularSpeed, AngularStiffness, Inertia};

/// A body that turns about one axis: it carries sprockets of any chains, rigidly, or none, such as a wheel behind a coupling.
///
/// A sprocket that no shaft names has a shaft of its own, which its `motion`, `drive`, `load` and `inertia` mean.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shaft {
    /// Name, unique among shafts and sprockets.
    pub(crate) name: String,
    /// Names of the sprockets that it carries, all about the same centre; absent: none.
    #[serde(default)]
    #[schemars(extend("maxItems" = 1000))]
    pub(crate) sprockets: Vec<String>,
    /// Rotation given in time. Excludes `drive`, `load` and `speed`.
    pub(crate) motion: Option<Motion<Angle, AngularSpeed>>,
    /// Moment of inertia [kg m²] beside those of its sprockets; absent: none.
    #[schemars(extend("minimum" = 0))]
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
    /// Friction of the bearings beside those at its sprockets, a stated torque; absent: none.
    pub(crate) bearing: Option<Written<Bearing>>,
    /// Drag of oil and air on it beside that at its sprockets; absent: none.
    pub(crate) drag: Option<Written<ShaftDrag>>,
}

/// A torsional spring and damper between two shafts, without stress as assembled.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Coupling {
    /// Name, unique among couplings.
    pub(crate) name: String,
    /// Names of the two shafts, or of sprockets on them.
    pub(crate) between: [String; 2],
    /// Stiffness [N m/rad]; absent: none.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) stiffness: AngularStiffness,
    /// Damping [N m s]; absent: none.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) damping: AngularDamping,
}

/// A pair of gears between two shafts, without play or loss.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Gears {
    /// Name, unique among the pairs.
    pub(crate) name: String,
    /// Names of the two shafts, or of sprockets on them.
    pub(crate) between: [String; 2],
    /// Numbers of teeth, in the same order.
    pub(crate) teeth: [Teeth; 2],
    /// Whether one gear runs within the other; absent: external.
    #[serde(default)]
    pub(crate) mesh: Mesh,
}

impl Gears {
    /// Speed of the second shaft for that of the first.
    pub(crate) fn ratio(&self) -> f64 {
        let [first, second] = self.teeth.map(|teeth| f64::from(teeth.0));
        // i = ∓ z₀/z₁
        match self.mesh {
            Mesh::External => -first / second,
            Mesh::Internal => first / second,
        }
    }
}

/// Number of teeth of a gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minimum" = 1, "maximum" = 10_000))]
pub(crate) struct Teeth(pub(crate) u32);

/// How two gears mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Mesh {
    /// Side by side: they turn against each other.
    #[default]
    External,
    /// One within the other: they turn the same way.
    Internal,
}
