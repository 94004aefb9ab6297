//! Losses of shafts, and the oil.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{
    AngularSpeed, Density, KinematicViscosity, Length, Ratio, Temperature, Torque,
};

/// Friction of the bearings of a shaft. Their torque opposes the rotation, M ω/√(ω² + ω_c²).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Bearing {
    /// A stated torque.
    Torque {
        /// Torque M [N m].
        #[schemars(extend("minimum" = 0))]
        torque: Torque,
        /// Speed ω_c over which the torque reverses [rad/s].
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        creep_speed: Option<AngularSpeed>,
    },
    /// M = ½ μ F d with the force F of the chain and the weight of the sprocket.
    Coefficient {
        /// Coefficient μ [–], or "deep-groove", "cylindrical", "spherical": 0.0015, 0.0011, 0.0018 by SKF's catalogue.
        coefficient: BearingCoefficient,
        /// Bore d [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        diameter: Length,
        /// Speed ω_c over which the torque reverses [rad/s].
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        creep_speed: Option<AngularSpeed>,
    },
    /// SKF's model of deep-groove ball bearings under the force of the chain and the weight of the sprocket.
    Skf {
        /// Series, such as "62".
        series: String,
        /// Bore [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        bore: Length,
        /// Outside diameter [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        outside_diameter: Length,
        /// Kinematic viscosity of the oil, or of the base oil of the grease [m²/s]; absent: that of the `lubricant`.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        viscosity: Option<KinematicViscosity>,
        /// Supply of oil; absent: a bath.
        #[serde(default)]
        feed: BearingFeed,
        /// Coefficient of boundary lubrication [–].
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        boundary_coefficient: Option<Ratio>,
        /// Coefficient of a full film [–].
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        full_film_coefficient: Option<Ratio>,
        /// Speed ω_c over which the torque reverses [rad/s].
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        creep_speed: Option<AngularSpeed>,
    },
}

/// Supply of oil to a bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum BearingFeed {
    /// A low bath, or a jet.
    #[default]
    Bath,
    /// Grease, or oil with air.
    Grease,
}

/// Coefficient of friction of a rolling bearing.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(transparent)]
pub(crate) struct BearingCoefficient(pub(crate) f64);

impl JsonSchema for BearingCoefficient {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "BearingCoefficient".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": ["number", "string"],
            "x-dimension": "a pure number",
            "x-unit": "1",
            "x-words": {"deep-groove": 0.0015, "cylindrical": 0.0011, "spherical": 0.0018},
            "examples": ["deep-groove"],
            "minimum": 0,
            "maximum": 1,
        })
    }
}

/// Drag of oil and air on a shaft, M₀ (|ω|/ω₀)ⁿ against the rotation.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShaftDrag {
    /// Torque M₀ [N m].
    #[schemars(extend("minimum" = 0))]
    pub(crate) torque: Torque,
    /// Speed ω₀ at which it is stated [rad/s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) speed: AngularSpeed,
    /// Exponent n [–].
    #[serde(default)]
    #[schemars(extend("minimum" = 1, "maximum" = 3))]
    pub(crate) exponent: Option<Ratio>,
}

/// The oil, whose viscosity holds wherever a part needs one and has none of its own.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lubricant {
    /// Viscosity grade of ISO 3448, such as "VG 150".
    #[serde(default)]
    pub(crate) grade: Option<String>,
    /// Kinematic viscosity at 40 °C [m²/s], instead of `grade`.
    #[serde(default)]
    #[schemars(extend("minimum" = 2e-6, "maximum" = 5e-3))]
    pub(crate) viscosity_40: Option<KinematicViscosity>,
    /// Viscosity index by ISO 2909 [–].
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 250))]
    pub(crate) viscosity_index: Option<Ratio>,
    /// Density at 15 °C [kg/m³].
    #[serde(default)]
    #[schemars(extend("minimum" = 700, "maximum" = 1100))]
    pub(crate) density: Option<Density>,
    /// Temperature [K], such as "60 degC".
    #[schemars(extend("minimum" = 233.15, "maximum" = 473.15))]
    pub(crate) temperature: Temperature,
}
