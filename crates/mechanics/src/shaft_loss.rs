//! Losses of a shaft: friction of its bearings, drag of oil and air.

use std::f64::consts::TAU;

use chaindrive_quantities::{
    AngularSpeed, JsonSchema, KinematicViscosity, Length, ParameterError, Ratio, Torque as Moment,
    check,
};
use serde::{Deserialize, Serialize};

use crate::DriveError;

/// Resistance of a shaft to its rotation, at one place on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaftLoss {
    /// Friction of the bearings.
    pub bearing: Option<Bearing>,
    /// Drag of oil and air.
    pub drag: Option<ShaftDrag>,
}

/// Friction of the bearings at one place of a shaft, smooth through rest.
///
/// ```text
/// T = −M(F, |ω|) ω/√(ω² + ω_c²)      F: radial force, ω: speed of the shaft against its frame
/// ```
///
/// At 10 ω_c the torque is 99.5 % of M. A shaft at rest holds nothing: it creeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(
    description = "Friction of the bearings of a shaft. Their torque opposes the rotation, M ω/√(ω² + ω_c²)."
)]
pub enum Bearing {
    /// A stated torque.
    Torque {
        /// Torque M \[N m\].
        #[schemars(with = "Moment", extend("minimum" = 0))]
        torque: f64,
        /// Speed ω_c over which the torque reverses \[rad/s\].
        #[schemars(with = "Option<AngularSpeed>", extend("exclusiveMinimum" = 0))]
        creep_speed: f64,
    },
    /// M = ½ μ F d with the force F of the chain and the weight of the sprocket.
    // SKF, Rolling bearings, 2013: an estimate for loads about a tenth of the dynamic rating, good lubrication, normal speeds.
    Coefficient {
        /// Coefficient μ \[–\], or "deep-groove", "cylindrical", "spherical": 0.0015, 0.0011, 0.0018 by SKF's catalogue.
        #[schemars(with = "Ratio", extend(
            "x-words" = {"deep-groove": 0.0015, "cylindrical": 0.0011, "spherical": 0.0018},
            "examples" = ["deep-groove"],
            "minimum" = 0,
            "maximum" = 1,
        ))]
        coefficient: f64,
        /// Bore d \[m\].
        #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
        diameter: f64,
        /// Speed ω_c over which the torque reverses \[rad/s\].
        #[schemars(with = "Option<AngularSpeed>", extend("exclusiveMinimum" = 0))]
        creep_speed: f64,
    },
    /// SKF's model of deep-groove ball bearings under the force of the chain and the weight of the sprocket.
    Skf(SkfBearing),
}

/// SKF's model of the frictional torque of a deep-groove ball bearing under a radial load, without seals and drag losses.
///
/// ```text
/// M = φ_ish φ_rs G_rr (ν n)^0.6 + G_sl μ_sl      [N mm, mm²/s, r/min, mm, N]
/// G_rr = R₁ d_m^1.96 F^0.54,   G_sl = S₁ d_m^−0.26 F^(5/3),   d_m = ½ (d + D)
/// φ_ish = 1/(1 + 1.84e-9 (n d_m)^1.28 ν^0.64),   φ_rs = exp(−K_rs ν n (d + D) √(K_z/(2 (D − d)))),   K_z = 3.1
/// μ_sl = φ μ_bl + (1 − φ) μ_EHL,   φ = exp(−2.6e-8 (n ν)^1.4 d_m)
/// ```
///
/// # Source
/// SKF, *Rolling bearings*, 2013, pages 99 to 111.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct SkfBearing {
    /// Series, such as "62".
    #[schemars(with = "String")]
    pub series: Series,
    /// Bore \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub bore: f64,
    /// Outside diameter \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub outside_diameter: f64,
    /// Kinematic viscosity of the oil, or of the base oil of the grease \[m²/s\]; absent: that of the `lubricant`.
    #[schemars(with = "Option<KinematicViscosity>", extend("exclusiveMinimum" = 0))]
    pub viscosity: f64,
    /// Supply of oil; absent: a bath.
    #[serde(default)]
    pub feed: BearingFeed,
    /// Coefficient of boundary lubrication \[–\].
    #[schemars(with = "Option<Ratio>", extend("minimum" = 0, "maximum" = 1))]
    pub boundary_coefficient: f64,
    /// Coefficient of a full film \[–\].
    #[schemars(with = "Option<Ratio>", extend("minimum" = 0, "maximum" = 1))]
    pub full_film_coefficient: f64,
    /// Speed ω_c over which the torque reverses \[rad/s\].
    #[schemars(with = "Option<AngularSpeed>", extend("exclusiveMinimum" = 0))]
    pub creep_speed: f64,
}

/// Supply of oil to a bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BearingFeed {
    /// A low bath, or a jet.
    #[default]
    Bath,
    /// Grease, or oil with air.
    Grease,
}

impl BearingFeed {
    /// Constant K_rs of replenishment.
    fn replenishment(self) -> f64 {
        match self {
            Self::Bath => 3e-8,
            Self::Grease => 6e-8,
        }
    }
}

/// A series of deep-groove ball bearings, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Series(usize);

/// Constants R₁ and S₁ by series: as a public program has them, not compared with the printed table.
const SERIES: [(&str, [f64; 2]); 16] = [
    ("60", [4.1e-7, 3.73e-3]),
    ("62", [3.9e-7, 3.23e-3]),
    ("63", [3.7e-7, 2.84e-3]),
    ("64", [3.6e-7, 2.43e-3]),
    ("160", [4.3e-7, 4.63e-3]),
    ("161", [4.3e-7, 4.63e-3]),
    ("617", [4.7e-7, 6.5e-3]),
    ("618", [4.7e-7, 6.5e-3]),
    ("619", [4.3e-7, 4.75e-3]),
    ("622", [3.9e-7, 3.23e-3]),
    ("623", [3.7e-7, 2.84e-3]),
    ("628", [4.7e-7, 6.5e-3]),
    ("630", [4.1e-7, 3.73e-3]),
    ("637", [4.7e-7, 6.5e-3]),
    ("638", [4.7e-7, 6.5e-3]),
    ("639", [4.3e-7, 4.75e-3]),
];

impl Series {
    /// The series of a name, such as `62`; none where it is not known.
    pub fn named(name: &str) -> Option<Self> {
        let found = SERIES.iter().position(|(known, _)| *known == name);
        found.map(Self)
    }

    /// Constants R₁ and S₁.
    fn constants(self) -> [f64; 2] {
        SERIES[self.0].1
    }

    /// Names of the known series.
    pub fn names() -> [&'static str; SERIES.len()] {
        SERIES.map(|(name, _)| name)
    }
}

impl TryFrom<String> for Series {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::named(&name).ok_or_else(|| format!("no deep-groove series is called `{name}`"))
    }
}

impl From<Series> for String {
    fn from(series: Series) -> Self {
        SERIES[series.0].0.to_owned()
    }
}

impl SkfBearing {
    /// Torque \[N m\] under a radial force \[N\] at a speed \[rad/s\], not negative.
    fn torque(&self, force: f64, speed: f64) -> f64 {
        let [d, outside] = [self.bore, self.outside_diameter].map(|it| it * 1e3);
        let mean = 0.5 * (d + outside);
        let (n, viscosity) = (speed * 60.0 / TAU, self.viscosity * 1e6);
        let [rolling, sliding] = self.series.constants();
        // φ_ish = 1/(1 + 1.84e-9 (n d_m)^1.28 ν^0.64)
        let shear = 1.0 / (1.0 + 1.84e-9 * (n * mean).powf(1.28) * viscosity.powf(0.64));
        // φ_rs = exp(−K_rs ν n (d + D) √(K_z/(2 (D − d))))
        let narrow = (3.1 / (2.0 * (outside - d))).sqrt();
        let starved = (-self.feed.replenishment() * viscosity * n * (d + outside) * narrow).exp();
        // M_rr = φ_ish φ_rs R₁ d_m^1.96 F^0.54 (ν n)^0.6
        let by_rolling = rolling * mean.powf(1.96) * force.powf(0.54) * (viscosity * n).powf(0.6);
        // φ = exp(−2.6e-8 (n ν)^1.4 d_m)
        let touching = (-2.6e-8 * (n * viscosity).powf(1.4) * mean).exp();
        let coefficient =
            touching * self.boundary_coefficient + (1.0 - touching) * self.full_film_coefficient;
        // M_sl = S₁ d_m^−0.26 F^(5/3) μ_sl
        let by_sliding = sliding * mean.powf(-0.26) * force.powf(5.0 / 3.0) * coefficient;
        (shear * starved * by_rolling + by_sliding) * 1e-3
    }
}

/// Drag of oil and air on a shaft.
///
/// ```text
/// T = −M₀ (|ω|/ω₀)ⁿ sgn ω
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(description = "Drag of oil and air on a shaft, M₀ (|ω|/ω₀)ⁿ against the rotation.")]
pub struct ShaftDrag {
    /// Torque M₀ \[N m\].
    #[schemars(with = "Moment", extend("minimum" = 0))]
    pub torque: f64,
    /// Speed ω₀ at which it is stated \[rad/s\].
    #[schemars(with = "AngularSpeed", extend("exclusiveMinimum" = 0))]
    pub speed: f64,
    /// Exponent n \[–\].
    #[schemars(with = "Option<Ratio>", extend("minimum" = 1, "maximum" = 3))]
    pub exponent: f64,
}

impl Bearing {
    /// Frictional torque M \[N m\] under a radial force \[N\] at a speed \[rad/s\], both not negative.
    pub fn torque(&self, force: f64, speed: f64) -> f64 {
        match self {
            Self::Torque { torque, .. } => *torque,
            // M = ½ μ F d
            Self::Coefficient {
                coefficient,
                diameter,
                ..
            } => 0.5 * coefficient * force * diameter,
            Self::Skf(bearing) => bearing.torque(force, speed),
        }
    }

    /// Speed ω_c over which the torque reverses \[rad/s\].
    fn creep_speed(&self) -> f64 {
        match self {
            Self::Torque { creep_speed, .. } | Self::Coefficient { creep_speed, .. } => {
                *creep_speed
            }
            Self::Skf(bearing) => bearing.creep_speed,
        }
    }

    /// Torque \[N m\] on a shaft under a radial force \[N\] at a speed \[rad/s\], against the rotation, and its damping −∂T/∂ω at a
    /// held M \[N m s\].
    fn act(&self, force: f64, speed: f64) -> [f64; 2] {
        let torque = self.torque(force, speed.abs());
        let reach = speed.hypot(self.creep_speed());
        let share = self.creep_speed() / reach;
        [-torque * speed / reach, torque * share * share / reach]
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the first parameter outside its range, or an outside diameter that is no more than the bore.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(self)?;
        match self {
            Self::Skf(it) if it.outside_diameter <= it.bore => Err(ParameterError {
                parameter: "outside_diameter".into(),
                value: it.outside_diameter,
                allowed: "more than the bore [m]".into(),
            }),
            _ => Ok(()),
        }
    }
}

impl ShaftDrag {
    /// Torque \[N m\] at a speed \[rad/s\], against the rotation, and its damping −∂T/∂ω \[N m s\].
    fn act(&self, speed: f64) -> [f64; 2] {
        // M₀ |ω|ⁿ⁻¹/ω₀ⁿ
        let over = (speed.abs() / self.speed).powf(self.exponent - 1.0) * self.torque / self.speed;
        [-over * speed, self.exponent * over]
    }
}

/// Torque and damping of a loss on its shaft.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LossTorque {
    /// Torques of the bearings, and of oil and air \[N m\], against the rotation.
    pub(crate) torques: [f64; 2],
    /// Damping of both \[N m s\].
    pub(crate) damping: f64,
}

impl ShaftLoss {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.bearing.is_none() && self.drag.is_none()
    }

    /// Torques under a radial force \[N\] at a speed \[rad/s\].
    pub(crate) fn act(&self, force: f64, speed: f64) -> LossTorque {
        let [bearing, sticky] = self.bearing.map_or([0.0; 2], |it| it.act(force, speed));
        let [drag, viscous] = self.drag.map_or([0.0; 2], |it| it.act(speed));
        LossTorque {
            torques: [bearing, drag],
            damping: sticky + viscous,
        }
    }

    /// Names the first parameter out of range of bearing and drag.
    pub(crate) fn problems(&self, place: &str) -> Vec<DriveError> {
        let bearing = self.bearing.and_then(|it| it.check().err());
        let drag = self.drag.and_then(|it| check(&it).err());
        let bearing = bearing.map(|error| DriveError::law(&format!("{place}.bearing"), error));
        let drag = drag.map(|error| DriveError::law(&format!("{place}.drag"), error));
        bearing.into_iter().chain(drag).collect()
    }
}
