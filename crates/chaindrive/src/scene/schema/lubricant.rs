//! The oil.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{Density, KinematicViscosity, Ratio, Temperature};

/// The oil, whose viscosity holds wherever a part needs one and has none of its own.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lubricant {
    /// Viscosity grade of ISO 3448, such as "VG 150".
    pub(crate) grade: Option<String>,
    /// Kinematic viscosity at 40 °C [m²/s], instead of `grade`.
    #[schemars(extend("minimum" = 2e-6, "maximum" = 5e-3))]
    pub(crate) viscosity_40: Option<KinematicViscosity>,
    /// Viscosity index by ISO 2909 [–].
    #[schemars(extend("minimum" = 0, "maximum" = 250))]
    pub(crate) viscosity_index: Option<Ratio>,
    /// Density at 15 °C [kg/m³].
    #[schemars(extend("minimum" = 700, "maximum" = 1100))]
    pub(crate) density: Option<Density>,
    /// Temperature [K], such as "60 degC".
    #[schemars(extend("minimum" = 233.15, "maximum" = 473.15))]
    pub(crate) temperature: Temperature,
}
