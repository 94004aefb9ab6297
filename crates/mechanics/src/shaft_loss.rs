//! Losses of a shaft: friction of its bearings, drag of oil and air.

use std::f64::consts::TAU;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Frictional torque M of a turning shaft.
    pub law: BearingLaw,
    /// Speed ω_c over which the torque reverses \[rad/s\], positive.
    pub creep_speed: f64,
}

/// Frictional torque M of a bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BearingLaw {
    /// A stated torque.
    Torque {
        /// Torque M \[N m\], not negative.
        torque: f64,
    },
    /// M = ½ μ F d.
    ///
    /// # Source
    /// SKF, *Rolling bearings*, 2013: an estimate for loads about a tenth of the dynamic rating, good lubrication, normal speeds.
    Coefficient {
        /// Coefficient μ \[–\], 0 to 1: 0.0015 of deep-groove ball bearings, 0.0011 of cylindrical and 0.0018 of spherical roller bearings.
        coefficient: f64,
        /// Bore d \[m\], positive.
        diameter: f64,
    },
    /// SKF's model for deep-groove ball bearings.
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkfBearing {
    /// Bore d \[m\], positive.
    pub bore: f64,
    /// Outside diameter D \[m\], more than the bore.
    pub outside_diameter: f64,
    /// Constants R₁ and S₁ of the [series](Self::series), positive.
    pub constants: [f64; 2],
    /// Kinematic viscosity ν of the oil, or of the base oil of the grease \[m²/s\], positive.
    pub viscosity: f64,
    /// Constant K_rs of replenishment: 3e-8 of an oil bath or jet, 6e-8 of grease or oil and air; not negative.
    pub replenishment: f64,
    /// Coefficient μ_bl of boundary lubrication \[–\], 0 to 1.
    pub boundary_coefficient: f64,
    /// Coefficient μ_EHL of a full film \[–\], 0 to 1.
    pub full_film_coefficient: f64,
}

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

impl SkfBearing {
    /// Constants R₁ and S₁ of a series of deep-groove ball bearings, such as `62`; none where it is not known.
    pub fn series(name: &str) -> Option<[f64; 2]> {
        let found = SERIES.iter().find(|(known, _)| *known == name);
        found.map(|(_, constants)| *constants)
    }

    /// Names of the known series.
    pub fn known_series() -> [&'static str; SERIES.len()] {
        SERIES.map(|(name, _)| name)
    }

    /// Torque \[N m\] under a radial force \[N\] at a speed \[rad/s\], not negative.
    fn torque(&self, force: f64, speed: f64) -> f64 {
        let [d, outside] = [self.bore, self.outside_diameter].map(|it| it * 1e3);
        let mean = 0.5 * (d + outside);
        let (n, viscosity) = (speed * 60.0 / TAU, self.viscosity * 1e6);
        let [rolling, sliding] = self.constants;
        // φ_ish = 1/(1 + 1.84e-9 (n d_m)^1.28 ν^0.64)
        let shear = 1.0 / (1.0 + 1.84e-9 * (n * mean).powf(1.28) * viscosity.powf(0.64));
        // φ_rs = exp(−K_rs ν n (d + D) √(K_z/(2 (D − d))))
        let narrow = (3.1 / (2.0 * (outside - d))).sqrt();
        let starved = (-self.replenishment * viscosity * n * (d + outside) * narrow).exp();
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftDrag {
    /// Torque M₀ \[N m\], not negative.
    pub torque: f64,
    /// Speed ω₀ at which it is stated \[rad/s\], positive.
    pub speed: f64,
    /// Exponent n \[–\], 1 to 3.
    pub exponent: f64,
}

impl BearingLaw {
    /// Frictional torque M \[N m\] under a radial force \[N\] at a speed \[rad/s\], both not negative.
    pub fn torque(&self, force: f64, speed: f64) -> f64 {
        match self {
            Self::Torque { torque } => *torque,
            // M = ½ μ F d
            Self::Coefficient {
                coefficient,
                diameter,
            } => 0.5 * coefficient * force * diameter,
            Self::Skf(bearing) => bearing.torque(force, speed),
        }
    }
}

impl Bearing {
    /// Torque \[N m\] on a shaft under a radial force \[N\] at a speed \[rad/s\], against the rotation, and its damping −∂T/∂ω at a
    /// held M \[N m s\].
    fn act(&self, force: f64, speed: f64) -> [f64; 2] {
        let torque = self.law.torque(force, speed.abs());
        let reach = speed.hypot(self.creep_speed);
        let share = self.creep_speed / reach;
        [-torque * speed / reach, torque * share * share / reach]
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

/// What a loss does to its shaft.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Resisting {
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
    pub(crate) fn act(&self, force: f64, speed: f64) -> Resisting {
        let [bearing, sticky] = self.bearing.map_or([0.0; 2], |it| it.act(force, speed));
        let [drag, viscous] = self.drag.map_or([0.0; 2], |it| it.act(speed));
        Resisting {
            torques: [bearing, drag],
            damping: sticky + viscous,
        }
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self, place: &str) -> Vec<DriveError> {
        let mut found = Vec::new();
        let mut need = |ok: bool, key: &str, value: f64, allowed: &'static str| {
            found.extend(DriveError::require(ok, &format!("{place}.{key}"), value, allowed).err());
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let not_negative = |value: f64| value >= 0.0 && value.is_finite();
        let share = |value: f64| (0.0..=1.0).contains(&value);
        if let Some(Bearing { law, creep_speed }) = self.bearing {
            let allowed = "positive [rad/s]";
            need(
                positive(creep_speed),
                "bearing.creep_speed",
                creep_speed,
                allowed,
            );
            match law {
                BearingLaw::Torque { torque } => {
                    need(
                        not_negative(torque),
                        "bearing.torque",
                        torque,
                        "not negative [N m]",
                    );
                }
                BearingLaw::Coefficient {
                    coefficient: it,
                    diameter,
                } => {
                    need(share(it), "bearing.coefficient", it, "between 0 and 1");
                    need(
                        positive(diameter),
                        "bearing.diameter",
                        diameter,
                        "positive [m]",
                    );
                }
                BearingLaw::Skf(it) => {
                    let [rolling, sliding] = it.constants;
                    let outside = it.outside_diameter;
                    let wide = outside > it.bore && outside.is_finite();
                    let [film, boundary] = [it.full_film_coefficient, it.boundary_coefficient];
                    need(positive(it.bore), "bearing.bore", it.bore, "positive [m]");
                    need(
                        wide,
                        "bearing.outside_diameter",
                        outside,
                        "more than the bore [m]",
                    );
                    need(
                        positive(rolling),
                        "bearing.constants[0]",
                        rolling,
                        "positive",
                    );
                    need(
                        positive(sliding),
                        "bearing.constants[1]",
                        sliding,
                        "positive",
                    );
                    let viscosity = it.viscosity;
                    need(
                        positive(viscosity),
                        "bearing.viscosity",
                        viscosity,
                        "positive [m²/s]",
                    );
                    let supply = it.replenishment;
                    need(
                        not_negative(supply),
                        "bearing.replenishment",
                        supply,
                        "not negative",
                    );
                    let place = "bearing.boundary_coefficient";
                    need(share(boundary), place, boundary, "between 0 and 1");
                    let place = "bearing.full_film_coefficient";
                    need(share(film), place, film, "between 0 and 1");
                }
            }
        }
        if let Some(drag) = self.drag {
            need(
                not_negative(drag.torque),
                "drag.torque",
                drag.torque,
                "not negative [N m]",
            );
            need(
                positive(drag.speed),
                "drag.speed",
                drag.speed,
                "positive [rad/s]",
            );
            let fits = (1.0..=3.0).contains(&drag.exponent);
            need(fits, "drag.exponent", drag.exponent, "between 1 and 3");
        }
        found
    }
}
