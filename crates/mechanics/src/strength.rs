//! The strength of a chain, for those who judge a motion: nothing in the model yields or breaks.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::DriveError;

/// Strength of a chain, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Strength {
    /// Least breaking load \[N\], positive.
    pub breaking_load: Option<f64>,
    /// Power that it is rated for.
    pub rating: Option<Rating>,
}

impl Strength {
    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let load = self.breaking_load.map(|load| {
            let path = "chain.breaking_load";
            DriveError::require(positive(load), path, load, "positive [N]").err()
        });
        load.flatten().into_iter().collect()
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
/// of 0.004. The load is smooth and the chain 100 pitches long. Galling at high speed is not in it.
///
/// # Source
/// American Chain Association, *Chains for Power Transmission and Material Handling*, 1982, in the form of R. G. Budynas and
/// J. K. Nisbett, *Shigley's Mechanical Engineering Design*, 9th ed., 2011, eqs. 17–32 and 17–33: for chains of ASME B29.1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rating {
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

impl Rating {
    /// Power \[W\] at a number of teeth and a speed \[rad/s\] of the smaller sprocket; zero at rest.
    pub fn power(&self, teeth: u32, speed: f64) -> f64 {
        let teeth = f64::from(teeth);
        let turns = speed.abs() * 60.0 / TAU;
        if turns <= 0.0 {
            return 0.0;
        }
        let pitch = self.pitch / INCH;
        let plates =
            self.plates * teeth.powf(1.08) * turns.powf(0.9) * pitch.powf(3.0 - 0.07 * pitch);
        let rollers = 1e3 * self.rollers * (teeth / turns).powf(1.5) * pitch.powf(0.8);
        plates.min(rollers) * HORSEPOWER
    }
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
            let rating = Rating {
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
        let light = Rating {
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
        let rating = Rating {
            pitch: INCH,
            plates: 0.004,
            rollers: 17.0,
        };
        assert!(rating.power(17, 0.0).abs() < f64::MIN_POSITIVE);
    }
}
