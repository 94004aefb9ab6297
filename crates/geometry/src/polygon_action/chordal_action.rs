//! Action of one sprocket on a long span: chordal action, meeting angle, mesh frequency.

use std::f64::consts::{PI, TAU};

use crate::GeometryError;
use crate::route::check_teeth;

/// Chordal action of one sprocket at constant speed on a long span along its line of pull.
///
/// ```text
/// v_max = R ω,   v_min = R ω cos(π/z),   rise = R (1 − cos(π/z)),   v_mean = z p ω / 2π
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordalAction {
    /// Pitch diameter D \[m\].
    pub pitch_diameter: f64,
    /// Least over greatest chain speed \[–\].
    pub speed_ratio: f64,
    /// Rise and fall of the span \[m\].
    pub rise: f64,
    /// Mean over greatest chain speed \[–\].
    pub mean_speed_ratio: f64,
}

impl ChordalAction {
    /// A sprocket of z teeth for a pitch p \[m\].
    ///
    /// # Errors
    /// Fewer than three teeth; a pitch that is not positive and finite.
    pub fn new(teeth: u32, pitch: f64) -> Result<Self, GeometryError> {
        check_teeth(teeth)?;
        GeometryError::positive("pitch [m]", pitch)?;
        let half = PI / f64::from(teeth);
        // D = p / sin(π/z)
        let pitch_diameter = pitch / half.sin();
        Ok(Self {
            pitch_diameter,
            speed_ratio: half.cos(),
            // R (1 − cos(π/z)) = D sin²(π/2z)
            rise: pitch_diameter * (0.5 * half).sin().powi(2),
            // z p ω/2π / (R ω) = sin(π/z) / (π/z)
            mean_speed_ratio: half.sin() / half,
        })
    }

    /// Non-uniformity of the chain speed, (v_max − v_min)/v_max \[–\].
    pub fn nonuniformity(&self) -> f64 {
        1.0 - self.speed_ratio
    }
}

/// Pressure angles of the ANSI tooth form \[rad\], from the outer to the inner end of the working face.
///
/// ```text
/// γ_min = 17° − 64°/z,   γ_mean = 26° − 92°/z,   γ_max = 35° − 120°/z
/// ```
///
/// # Source
/// ASME B29.1, tooth form of type II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureAngles {
    /// At the outer end of the working face \[rad\].
    pub least: f64,
    /// Mean of both ends \[rad\].
    pub mean: f64,
    /// Where the working face meets the seat \[rad\].
    pub most: f64,
}

impl PressureAngles {
    /// Pressure angles of a sprocket of z teeth.
    ///
    /// # Errors
    /// Fewer than five teeth, for which the form is not defined.
    pub fn ansi(teeth: u32) -> Result<Self, GeometryError> {
        let z = f64::from(teeth);
        if teeth < 5 {
            return Err(GeometryError::OutOfRange {
                what: "number of teeth",
                value: z,
                allowed: "at least 5",
            });
        }
        // γ_min = 17° − 64°/z,   γ_mean = 26° − 92°/z,   γ_max = 35° − 120°/z
        Ok(Self {
            least: (17.0 - 64.0 / z).to_radians(),
            mean: (26.0 - 92.0 / z).to_radians(),
            most: (35.0 - 120.0 / z).to_radians(),
        })
    }

    /// Normal speed at which a roller of a long span meets a face of pressure angle γ \[rad\], divided by p ω \[–\].
    ///
    /// ```text
    /// V / (p ω) = sin(2π/z + γ)
    /// ```
    ///
    /// The span is taken not to rotate; [`PolygonAction::seating_velocity`](super::PolygonAction::seating_velocity)
    /// has the correction.
    pub fn normal_speed(teeth: u32, pressure_angle: f64) -> f64 {
        // V / (p ω) = sin(2π/z + γ)
        (TAU / f64::from(teeth) + pressure_angle).sin()
    }
}

/// Frequency at which rollers seat \[Hz\] on a sprocket of z teeth at a speed ω \[rad/s\].
///
/// ```text
/// f = z |ω| / 2π
/// ```
pub fn mesh_frequency(teeth: u32, speed: f64) -> f64 {
    // f = z |ω| / 2π
    f64::from(teeth) * speed.abs() / TAU
}
