//! A plunger in oil, by its measures: what a drawing has in place of forces.

use std::f64::consts::PI;

use chaindrive_quantities::{JsonSchema, Length, Pressure, Ratio, Viscosity, Volume};
use serde::{Deserialize, Serialize};

use super::OilColumn;

/// A plunger that leaks through an annular gap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Oil {
    /// Plunger diameter d \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub diameter: f64,
    /// Length of the gap L \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Radial width of the gap h \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub gap: f64,
    /// Dynamic viscosity of the oil μ \[Pa s\].
    #[schemars(with = "Viscosity", extend("exclusiveMinimum" = 0))]
    pub viscosity: f64,
    /// Supply pressure p_s \[Pa\].
    #[serde(default)]
    #[schemars(with = "Pressure", extend("minimum" = 0))]
    pub supply: f64,
    /// Pressure at which the relief valve opens p_r \[Pa\].
    #[schemars(with = "Pressure", extend("exclusiveMinimum" = 0))]
    pub relief: f64,
    /// Bulk modulus of the oil without air K \[Pa\]: with it the oil can be compressed and has a pressure of its own, and
    /// `volume`, `air`, `extending` and `relieving` are needed; absent: the oil is stiff.
    #[schemars(with = "Option<Pressure>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bulk_modulus: Option<f64>,
    /// Volume of the chamber in the assembled position V₀ \[m³\].
    #[schemars(with = "Option<Volume>", extend("exclusiveMinimum" = 0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<f64>,
    /// Share of free air in the oil, under the pressure around the drive α \[–\].
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = 0, "maximum" = 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air: Option<f64>,
}

impl Oil {
    /// Cross-section of the plunger A \[m²\].
    ///
    /// ```text
    /// A = π d²/4
    /// ```
    pub fn area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }

    /// Damping by the leak \[N s/m\].
    ///
    /// ```text
    /// c_leak = 12 μ L A² / (π d h³)
    /// ```
    ///
    /// # Source
    /// Poiseuille's flow between plates, the annular gap unrolled.
    pub fn leak_damping(&self) -> f64 {
        let area = self.area();
        // c_leak = 12 μ L A² / (π d h³)
        12.0 * self.viscosity * self.length * area * area / (PI * self.diameter * self.gap.powi(3))
    }

    /// Oil that can be compressed; none where one of its three parameters is absent.
    pub fn column(&self) -> Option<OilColumn> {
        Some(OilColumn {
            area: self.area(),
            volume: self.volume?,
            bulk_modulus: self.bulk_modulus?,
            air: self.air?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published example: d = 12 mm, L = 25 mm, μ = 10 mPa s give 302, 65, 15.9 and
    /// 4.7 kN s/m at gaps of 15, 25, 40 and 60 µm (theory: annular leak flow).
    #[test]
    fn leak_damping_follows_the_gap_cubed() {
        for (gap, expected) in [
            (15e-6, 302e3),
            (25e-6, 65e3),
            (40e-6, 15.9e3),
            (60e-6, 4.7e3),
        ] {
            let oil = Oil {
                diameter: 0.012,
                length: 0.025,
                gap,
                viscosity: 0.01,
                supply: 0.0,
                relief: 1.0,
                bulk_modulus: None,
                volume: None,
                air: None,
            };
            let damping = oil.leak_damping();
            assert!(
                (damping / expected - 1.0).abs() < 0.01,
                "{damping} at {gap}"
            );
        }
    }
}
