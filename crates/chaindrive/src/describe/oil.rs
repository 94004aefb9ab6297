//! The oil of a drive.

use std::fmt;

use chaindrive_mechanics::{OilSupply, Parts};
use schemars::JsonSchema;
use serde::Serialize;

/// Properties of the oil at its temperature.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OilFacts {
    /// Temperature \[K\].
    pub temperature: f64,
    /// Kinematic viscosity \[m²/s\].
    pub kinematic_viscosity: f64,
    /// Dynamic viscosity \[Pa s\].
    pub dynamic_viscosity: f64,
    /// Density \[kg/m³\].
    pub density: f64,
    /// Places of the parameters that follow from it.
    pub used_by: Vec<String>,
}

impl fmt::Display for OilFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} mm²/s, {:.2} mPa s, {:.0} kg/m³ at {:.0} °C; ",
            self.kinematic_viscosity * 1e6,
            self.dynamic_viscosity * 1e3,
            self.density,
            self.temperature - 273.15
        )?;
        match self.used_by.as_slice() {
            [] => f.write_str("no part of the drive asks for it"),
            places => write!(f, "for {}", places.join(", ")),
        }
    }
}

/// The oil, where there is one.
pub(super) fn of(parts: &Parts) -> Option<OilFacts> {
    let OilSupply { lubricant, used_by } = parts.oil.as_ref()?;
    Some(OilFacts {
        temperature: lubricant.temperature,
        kinematic_viscosity: lubricant.kinematic_viscosity(),
        dynamic_viscosity: lubricant.dynamic_viscosity(),
        density: lubricant.density_there(),
        used_by: used_by.clone(),
    })
}
