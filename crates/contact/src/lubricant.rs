//! Mineral oil: viscosity and density over temperature, from the grade and the viscosity index.

use chaindrive_quantities::{
    Density, JsonSchema, KinematicViscosity, ParameterError, Ratio, Temperature, check,
};
use serde::Serialize;

use crate::error::require;

/// Mid-points of the viscosity grades \[mm²/s at 40 °C\].
///
/// # Source
/// ISO 3448:1992, *Industrial liquid lubricants — ISO viscosity classification*; a grade reaches 10 % to either side.
const GRADES: [(&str, f64); 20] = [
    ("VG 2", 2.2),
    ("VG 3", 3.2),
    ("VG 5", 4.6),
    ("VG 7", 6.8),
    ("VG 10", 10.0),
    ("VG 15", 15.0),
    ("VG 22", 22.0),
    ("VG 32", 32.0),
    ("VG 46", 46.0),
    ("VG 68", 68.0),
    ("VG 100", 100.0),
    ("VG 150", 150.0),
    ("VG 220", 220.0),
    ("VG 320", 320.0),
    ("VG 460", 460.0),
    ("VG 680", 680.0),
    ("VG 1000", 1000.0),
    ("VG 1500", 1500.0),
    ("VG 2200", 2200.0),
    ("VG 3200", 3200.0),
];

/// Temperature at which a grade is defined \[K\].
const FORTY: f64 = 313.15;
/// Second temperature of the viscosity index \[K\].
const HUNDRED: f64 = 373.15;
/// Temperature at which the density is stated \[K\].
const FIFTEEN: f64 = 288.15;
/// Least kinematic viscosity at 100 °C that has a viscosity index \[mm²/s\].
const THINNEST: f64 = 2.0;
/// Greatest one that is looked for \[mm²/s\]: far beyond the thickest grade.
const THICKEST: f64 = 1e4;

/// An oil.
///
/// ```text
/// log₁₀ log₁₀(ν + 0.7) = A − B log₁₀ T                 ν [mm²/s], T [K], through 40 and 100 °C
/// ρ = ρ₁₅ exp(−α ΔT (1 + 0.8 α ΔT)),   α = 0.6278/ρ₁₅     ΔT = T − 288.15 K, ρ [kg/m³]
/// η = ρ ν
/// ```
///
/// The viscosity at 100 °C follows from the viscosity index. Greases flow otherwise: what counts in them is their base oil.
///
/// # Source
/// Viscosity: C. Walther's equation as ASTM D341 has it, for ν > 2 mm²/s. Viscosity index: ISO 2909, ASTM D2270. Density:
/// ASTM D1250, API MPMS 11.1, constants of lubricating oils.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Lubricant {
    /// Kinematic viscosity at 40 °C \[m²/s\], 2 to 5000 mm²/s.
    #[schemars(with = "KinematicViscosity", extend("minimum" = 2e-6, "maximum" = 5e-3))]
    pub viscosity_40: f64,
    /// Viscosity index \[–\], 0 to 250.
    #[schemars(with = "Ratio", extend("minimum" = 0, "maximum" = 250))]
    pub viscosity_index: f64,
    /// Density at 15 °C \[kg/m³\], 700 to 1100.
    #[schemars(with = "Density", extend("minimum" = 700, "maximum" = 1100))]
    pub density: f64,
    /// Temperature \[K\], 233.15 to 473.15.
    // From −40 to 200 °C. Assumed: beyond, oils of the trade are solid or burn.
    #[schemars(with = "Temperature", extend("minimum" = 233.15, "maximum" = 473.15))]
    pub temperature: f64,
}

impl Lubricant {
    /// Kinematic viscosity at 40 °C \[m²/s\] in the middle of a grade such as `VG 150`; none where there is no such grade.
    pub fn grade(name: &str) -> Option<f64> {
        let found = GRADES.iter().find(|(known, _)| *known == name);
        found.map(|(_, viscosity)| viscosity * 1e-6)
    }

    /// Names of all grades.
    pub fn grades() -> impl Iterator<Item = &'static str> {
        GRADES.iter().map(|(name, _)| *name)
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the first parameter outside its range, or a viscosity index with which the oil would be thinner at 100 °C than the index is
    /// defined for.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(self)?;
        let (viscosity_40, viscosity_index) = (self.viscosity_40, self.viscosity_index);
        require(
            viscosity_at_40(THINNEST, viscosity_index) <= viscosity_40 * 1e6,
            "viscosity_40",
            viscosity_40,
            "large enough for 2e-6 [m^2/s] at 100 °C, below which there is no viscosity index",
        )
    }

    /// Kinematic viscosity at 100 °C \[m²/s\]: the one that has the viscosity index.
    pub fn viscosity_100(&self) -> f64 {
        let wanted = self.viscosity_40 * 1e6;
        let mut between = [THINNEST, THICKEST];
        // Halved until nothing is between: the viscosity at 40 °C grows with that at 100 °C.
        for _ in 0..100 {
            let middle = 0.5 * (between[0] + between[1]);
            let beyond = viscosity_at_40(middle, self.viscosity_index) > wanted;
            between[usize::from(beyond)] = middle;
        }
        between[1] * 1e-6
    }

    /// Kinematic viscosity ν \[m²/s\].
    pub fn kinematic_viscosity(&self) -> f64 {
        // W(ν) = log₁₀ log₁₀(ν + 0.7)
        let height = |viscosity: f64| (viscosity * 1e6 + 0.7).log10().log10();
        let [low, high] = [self.viscosity_40, self.viscosity_100()].map(height);
        // B = (W₄₀ − W₁₀₀)/(log₁₀ T₁₀₀ − log₁₀ T₄₀)
        let slope = (low - high) / (HUNDRED / FORTY).log10();
        let at = low - slope * (self.temperature / FORTY).log10();
        (10_f64.powf(10_f64.powf(at)) - 0.7) * 1e-6
    }

    /// Density ρ \[kg/m³\] at its temperature.
    pub fn density_there(&self) -> f64 {
        // α = K₁/ρ₁₅, K₁ of lubricating oils [kg/m³/K]
        let stretch = 0.6278 / self.density * (self.temperature - FIFTEEN);
        self.density * (-stretch * (1.0 + 0.8 * stretch)).exp()
    }

    /// Dynamic viscosity η \[Pa s\].
    pub fn dynamic_viscosity(&self) -> f64 {
        // η = ρ ν
        self.density_there() * self.kinematic_viscosity()
    }
}

/// Viscosity index \[–\] of an oil with these kinematic viscosities at 40 and 100 °C \[m²/s\].
///
/// ```text
/// VI = 100 (L − U)/(L − H)                     U ≥ H      U, Y: viscosity at 40 and 100 °C [mm²/s]
/// VI = 100 + (10^N − 1)/0.00715,  Y^N = H/U    U < H      L, H: at 40 °C of oils with VI 0 and 100 and the same Y
/// ```
///
/// None where the oil is thinner than 2 mm²/s at 100 °C.
///
/// # Source
/// ISO 2909:2002, ASTM D2270-10, procedures A and B.
pub fn viscosity_index(viscosity_40: f64, viscosity_100: f64) -> Option<f64> {
    let (u, y) = (viscosity_40 * 1e6, viscosity_100 * 1e6);
    if !(y >= THINNEST && u > y) {
        return None;
    }
    let [low, high] = reference_oils(y);
    Some(if u >= high {
        100.0 * (low - u) / (low - high)
    } else {
        let n = (high / u).log10() / y.log10();
        100.0 + (10_f64.powf(n) - 1.0) / 0.00715
    })
}

/// Kinematic viscosity at 40 °C of an oil with viscosity `y` at 100 °C and a viscosity index, all viscosities in mm²/s.
fn viscosity_at_40(y: f64, index: f64) -> f64 {
    let [low, high] = reference_oils(y);
    if index <= 100.0 {
        // U = L − VI (L − H)/100
        low - index / 100.0 * (low - high)
    } else {
        // U = H Y^−N,  10^N = 1 + 0.00715 (VI − 100)
        let n = (1.0 + 0.00715 * (index - 100.0)).log10();
        high * y.powf(-n)
    }
}

/// L and H, the viscosities at 40 °C of the oils of index 0 and 100 that have `y` at 100 °C, all in mm²/s.
///
/// ```text
/// L = a Y² + b Y + c,   H = d Y² + e Y + f
/// ```
///
/// # Source
/// ASTM D2270-10, table X2.1, not compared with the printed table: within 0.12 % of the values of its table 1.
fn reference_oils(y: f64) -> [f64; 2] {
    // Greatest Y; a, b, c; d, e, f
    const PIECES: [(f64, [f64; 3], [f64; 3]); 16] = [
        (3.8, [1.14673, 1.7576, -0.109], [0.84155, 1.5521, -0.077]),
        (4.4, [3.38095, -15.4952, 33.196], [0.78571, 1.7929, -0.183]),
        (5.0, [2.5, -7.2143, 13.812], [0.82143, 1.5679, 0.119]),
        (6.4, [0.101, 16.635, -45.469], [0.04985, 9.1613, -18.557]),
        (7.0, [3.35714, -23.5643, 78.466], [0.22619, 7.7369, -16.656]),
        (7.7, [0.01191, 21.475, -72.87], [0.79762, -0.7321, 14.61]),
        (9.0, [0.41858, 16.1558, -56.04], [0.05794, 10.5156, -28.24]),
        (12.0, [0.88779, 7.5527, -16.6], [0.26665, 6.7015, -10.81]),
        (15.0, [0.7672, 10.7972, -38.18], [0.20073, 8.4658, -22.49]),
        (18.0, [0.97305, 5.3135, -2.2], [0.28889, 5.9741, -4.93]),
        (22.0, [0.97256, 5.25, -0.98], [0.24504, 7.416, -16.73]),
        (28.0, [0.91413, 7.4759, -21.82], [0.20323, 9.1267, -34.23]),
        (40.0, [0.87031, 9.7157, -50.77], [0.18411, 10.1015, -46.75]),
        (
            55.0,
            [0.84703, 12.6752, -133.31],
            [0.17029, 11.4866, -80.62],
        ),
        (70.0, [0.85921, 11.1009, -83.19], [0.1713, 11.368, -76.94]),
        (
            f64::INFINITY,
            [0.83531, 14.6731, -216.246],
            [0.16841, 11.8493, -96.947],
        ),
    ];
    let piece = PIECES.iter().find(|(most, ..)| y <= *most);
    let (_, low, high) = piece.unwrap_or(&PIECES[15]);
    [low, high].map(|[a, b, c]| (a * y + b) * y + c)
}
