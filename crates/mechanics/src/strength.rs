//! The strength of a chain, for those who judge a motion: nothing in the model yields or breaks.

use std::f64::consts::TAU;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::DriveError;

/// Strength of a chain, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strength {
    /// Least breaking load \[N\], positive.
    pub breaking_load: Option<f64>,
    /// Area on which a pin bears on its bush, of one strand \[m²\], positive: diameter of the pin times length of the bush.
    pub bearing_area: Option<f64>,
    /// Radius of the pin, on which it slides in its bush \[m\], positive.
    pub pin_radius: Option<f64>,
    /// Strands side by side, from 1 on.
    pub strands: u32,
    /// Service factor \[–\], positive: by how much the duty is harder than a smooth load.
    pub service_factor: f64,
    /// Limit of its power.
    pub capacity: Capacity,
}

impl Default for Strength {
    fn default() -> Self {
        Self {
            breaking_load: None,
            bearing_area: None,
            pin_radius: None,
            strands: 1,
            service_factor: 1.0,
            capacity: Capacity::default(),
        }
    }
}

/// Limit of the power of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Capacity {
    /// By the formula for the chains of ASME B29.1.
    American(PowerLimits),
    /// By what its maker says \[W\], positive, all strands together.
    Given(f64),
    /// Nobody knows.
    Unknown(MissingRating),
}

impl Default for Capacity {
    fn default() -> Self {
        Self::Unknown(MissingRating::NoType)
    }
}

/// Why a chain has no rated power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum MissingRating {
    /// The chain is none of the catalogue.
    NoType,
    /// The pitch is not that of its type.
    OtherPitch,
    /// There is no formula for its type whose source could be read.
    SourceMissing {
        /// The chain of ASME B29.1 that has its pitch: an orientation, and no rating of this chain.
        twin: Option<PowerLimits>,
    },
}

impl fmt::Display for MissingRating {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoType => "not rated: the chain has no type of the catalogue",
            Self::OtherPitch => "not rated: the pitch is not that of its type",
            Self::SourceMissing { .. } => "not rated: source missing",
        })
    }
}

impl Strength {
    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let given = match self.capacity {
            Capacity::Given(power) => Some(power),
            Capacity::American(_) | Capacity::Unknown(_) => None,
        };
        let numbers = [
            ("chain.breaking_load", self.breaking_load, "positive [N]"),
            ("chain.bearing_area", self.bearing_area, "positive [m²]"),
            ("chain.rated_power", given, "positive [W]"),
            (
                "chain.service_factor",
                Some(self.service_factor),
                "positive [–]",
            ),
            ("chain.strands", Some(f64::from(self.strands)), "positive"),
        ];
        let of = |(path, value, allowed): (&'static str, Option<f64>, &'static str)| {
            let value = value?;
            DriveError::require(positive(value), path, value, allowed).err()
        };
        numbers.into_iter().filter_map(of).collect()
    }
}

/// The power that a single strand of a roller chain carries for 15 000 hours, oiled as its speed asks.
///
/// ```text
/// P₁ = 0.004 Z^1.08 n^0.9 p^(3 − 0.07 p)       fatigue of the plates
/// P₂ = 1000 K (Z/n)^1.5 p^0.8                   impacts of rollers and bushes
/// P = min(P₁, P₂) · 745.7 W                     p in inches, n in rpm
/// ```
///
/// Z and n are those of the smaller sprocket; K is 17, for the smallest chains 29 and for number 41 3.4, whose plates bear 0.0022 in place
/// of 0.004. The load is smooth and the chain 100 pitches long. Galling of pins in bushes at high speed is not in it.
///
/// Over the teeth two public sources disagree: (Z/17)^1.08 here, as (Z/19)^1.08 in ISO 10823:2004, against the older table of tooth
/// factors. The former lies above the latter by 4, 6, 15 and 28 % at 25, 30, 40 and 60 teeth.
///
/// # Source
/// American Chain Association, *Chains for Power Transmission and Material Handling*, 1982, in the form of R. G. Budynas and
/// J. K. Nisbett, *Shigley's Mechanical Engineering Design*, 9th ed., 2011, eqs. 17–32 and 17–33: for chains of ASME B29.1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PowerLimits {
    /// Pitch \[m\].
    pub pitch: f64,
    /// Factor of the plates: 0.004 or 0.0022.
    pub plates: f64,
    /// Factor K of rollers and bushes.
    pub rollers: f64,
}

/// Inch \[m\].
const INCH: f64 = 0.0254;
/// Horsepower \[W\].
const HORSEPOWER: f64 = 745.7;

impl PowerLimits {
    /// Power \[W\] at which plates tire, at a number of teeth and a speed \[rad/s\] of the smaller sprocket; zero at rest.
    pub fn of_plates(&self, teeth: u32, speed: f64) -> f64 {
        let (teeth, turns, pitch) = (f64::from(teeth), turns(speed), self.pitch / INCH);
        // P₁ = 0.004 Z^1.08 n^0.9 p^(3 − 0.07 p)
        let power =
            self.plates * teeth.powf(1.08) * turns.powf(0.9) * pitch.powf(3.0 - 0.07 * pitch);
        power * HORSEPOWER
    }

    /// Power \[W\] that the impacts of rollers and bushes leave; infinite at rest.
    pub fn of_rollers(&self, teeth: u32, speed: f64) -> f64 {
        let (teeth, turns, pitch) = (f64::from(teeth), turns(speed), self.pitch / INCH);
        // P₂ = 1000 K (Z/n)^1.5 p^0.8
        1e3 * self.rollers * (teeth / turns).powf(1.5) * pitch.powf(0.8) * HORSEPOWER
    }

    /// The lesser of the two \[W\]; zero at rest.
    pub fn power(&self, teeth: u32, speed: f64) -> f64 {
        let plates = self.of_plates(teeth, speed);
        plates.min(self.of_rollers(teeth, speed))
    }
}

/// Revolutions a minute.
fn turns(speed: f64) -> f64 {
    speed.abs() * 60.0 / TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shigley, table 17–20, and the tables of the association for numbers 40 and 41 (*Machinery's Handbook*): single strands.
    #[test]
    fn published_ratings_are_met() {
        for (pitch, teeth, rpm, horsepower) in [
            (0.5, 17, 50.0, 0.37),
            (0.625, 17, 50.0, 0.72),
            (0.75, 17, 50.0, 1.24),
            (0.5, 11, 50.0, 0.23),
            (0.5, 11, 1600.0, 5.22),
            (0.5, 16, 500.0, 2.75),
            (0.5, 16, 1000.0, 5.13),
            // Impacts limit it.
            (0.5, 11, 1800.0, 4.66),
            (0.5, 17, 1800.0, 8.96),
        ] {
            let rating = PowerLimits {
                pitch: pitch * INCH,
                plates: 0.004,
                rollers: 17.0,
            };
            let found = rating.power(teeth, -rpm * TAU / 60.0) / HORSEPOWER;
            assert!(
                (found - horsepower).abs() < 0.006,
                "{pitch}, {teeth}, {rpm}: {found}"
            );
        }
        let light = PowerLimits {
            pitch: 0.5 * INCH,
            plates: 0.0022,
            rollers: 3.4,
        };
        for (teeth, rpm, horsepower) in [(11, 500.0, 1.01), (15, 1000.0, 2.63), (18, 1400.0, 2.85)]
        {
            let found = light.power(teeth, rpm * TAU / 60.0) / HORSEPOWER;
            assert!(
                (found - horsepower).abs() < 0.006,
                "41, {teeth}, {rpm}: {found}"
            );
        }
    }

    #[test]
    fn nothing_is_carried_at_rest() {
        let rating = PowerLimits {
            pitch: INCH,
            plates: 0.004,
            rollers: 17.0,
        };
        assert!(rating.power(17, 0.0).abs() < f64::MIN_POSITIVE);
    }
}
