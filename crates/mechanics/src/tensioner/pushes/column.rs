//! Oil in the chamber of a plunger, with the air in it.

use chaindrive_quantities::{Area, JsonSchema, Pressure, Ratio, Volume};
use serde::{Deserialize, Serialize};

/// Pressure of the air around a drive \[Pa\].
const AMBIENT: f64 = 101_325.0;

/// Oil that can be compressed, in the chamber behind a plunger.
///
/// ```text
/// V = V₀ + A x             chamber
/// V_s = V₀ + A z           its oil, as large as it would be under the pressure of the supply
/// V/V_s = w(p)/w(p_s),     w(p) = (1 − α)(1 − (p − p₀)/K) + α p₀/p
/// K_eff = w/(−∂w/∂p),      ṗ = (K_eff/V) (A ż V/V_s − A ẋ)
/// ```
///
/// The state is the length z \[m\] by which the column of oil has grown since assembly, rather than its pressure: it changes by
/// what flows and by nothing else, and what the oil stores is a function of x and z. The pressure is that of liquid with bulk
/// modulus K and a share α of free air, which is compressed without warming, so it falls towards zero when the plunger runs
/// away from the oil and never below: the oil boils or foams.
///
/// # Source
/// N. D. Manring, *Hydraulic Control Systems*, Wiley, 2005: the bulk modulus of oil with free air, here without warming, and the
/// balance of a chamber, ṗ = (K/V)(Σ Q − V̇).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OilColumn {
    /// Cross-section of the plunger A \[m²\].
    #[schemars(with = "Area", extend("exclusiveMinimum" = 0))]
    pub area: f64,
    /// Volume of the chamber at assembly V₀ \[m³\].
    #[schemars(with = "Volume", extend("exclusiveMinimum" = 0))]
    pub volume: f64,
    /// Bulk modulus of the oil without air K \[Pa\].
    #[schemars(with = "Pressure", extend("exclusiveMinimum" = 0))]
    pub bulk_modulus: f64,
    /// Share of its volume that is free air under the pressure around α \[–\].
    #[schemars(with = "Ratio", extend("exclusiveMinimum" = 0, "maximum" = 0.5))]
    pub air: f64,
}

/// The oil at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    /// Push on the plunger against the air outside \[N\].
    pub(super) force: f64,
    /// Energy that a metre of column from the supply takes \[N\].
    pub(super) effort: f64,
    /// Energy stored, the supply counted as a weight \[J\].
    pub(super) energy: f64,
    /// −∂F/∂x with the oil trapped \[N/m\], here, and at the highest pressures.
    pub(super) stiffness: [f64; 2],
    /// V/V_s
    pub(super) ratio: f64,
    /// Pressure above that of the air \[Pa\].
    pub(super) pressure: f64,
}

impl OilColumn {
    /// The oil at extension x and column z; `supply` is the push of the supply pressure \[N\].
    pub(super) fn at(&self, x: f64, z: f64, supply: f64) -> Column {
        let Self {
            area,
            volume,
            bulk_modulus,
            air,
        } = *self;
        let liquid = (1.0 - air) / bulk_modulus;
        let gas = air * AMBIENT;
        let supplied = AMBIENT + supply / area;
        // w(p_s)
        let reference = 1.0 - air - liquid * (supplied - AMBIENT) + gas / supplied;
        let oil = volume + area * z;
        let ratio = (volume + area * x) / oil;
        // l p² + B p − α p₀ = 0,   B = w − (1 − α) − l p₀,   from w(p) = w(p_s) V/V_s
        let b = ratio * reference - (1.0 - air) - liquid * AMBIENT;
        let root = (b * b + 4.0 * liquid * gas).sqrt();
        let pressure = if b > 0.0 {
            2.0 * gas / (b + root)
        } else {
            (root - b) / (2.0 * liquid)
        };
        // u = −∫ p dw/w_s from p_s,   U = V_s u + p₀ A x − p_s A z,   ∂U/∂z = A (u + p V/V_s − p_s)
        let stretched = pressure.mul_add(pressure, -(supplied * supplied));
        let inner = (0.5 * liquid * stretched + gas * (pressure / supplied).ln()) / reference;
        // −∂p/∂(V/V_s) = w_s/(l + α p₀/p²)
        let modulus = |softness: f64| reference / (liquid + softness);
        let stiffness =
            [gas / (pressure * pressure), 0.0].map(|gas| area * area * modulus(gas) / oil);
        Column {
            force: area * (pressure - AMBIENT),
            effort: area * (inner + pressure * ratio - supplied),
            energy: oil * inner + area * (AMBIENT * x - supplied * z),
            stiffness,
            ratio,
            pressure: pressure - AMBIENT,
        }
    }
}
