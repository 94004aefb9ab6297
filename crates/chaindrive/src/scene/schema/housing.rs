//! The housing that carries the sprockets.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{Temperature, ThermalExpansion};

/// A housing that is warmer than when the chain was fitted, as chain and sprockets are: the centres move apart by what it expands more than steel.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Housing {
    /// Thermal expansion of the housing [1/K], or "steel", "grey-iron", "aluminium": 11.5e-6, 10.5e-6, 23e-6.
    #[schemars(extend(
        "x-words" = {"steel": 11.5e-6, "grey-iron": 10.5e-6, "aluminium": 23e-6},
        "examples" = ["aluminium"],
        "minimum" = 0,
        "maximum" = 1e-4,
    ))]
    pub(crate) expansion: ThermalExpansion,
    /// Thermal expansion of chain and sprockets [1/K].
    #[schemars(extend("minimum" = 0, "maximum" = 1e-4))]
    pub(crate) chain_expansion: Option<ThermalExpansion>,
    /// Temperature [K], such as "90 degC".
    #[schemars(extend("minimum" = 173.15, "maximum" = 773.15))]
    pub(crate) temperature: Temperature,
    /// Temperature at which the chain was fitted, with its pretension, sag or slack [K].
    #[schemars(extend("minimum" = 173.15, "maximum" = 773.15))]
    pub(crate) assembled_at: Option<Temperature>,
}
