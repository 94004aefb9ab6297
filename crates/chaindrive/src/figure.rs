//! Numbers as the trade writes them: four digits, no powers of ten, the unit that suits them.

use std::f64::consts::TAU;

/// Significant digits of a figure.
const DIGITS: i32 = 4;

/// Magnitudes that are written without a power of ten: all that drives have.
const PLAIN: std::ops::Range<f64> = 1e-10..1e15;

/// A number with four digits and no power of ten: `254.6`, `38663`, `0.0021`.
///
/// ```
/// use chaindrive::figure::figure;
///
/// assert_eq!(figure(254.63), "254.6");
/// assert_eq!(figure(-38663.2), "-38663");
/// assert_eq!(figure(0.002_134_9), "0.002135");
/// assert_eq!(figure(0.0), "0");
/// ```
pub fn figure(value: f64) -> String {
    with_digits(value, DIGITS)
}

/// The same with another number of digits, such as those that a table of dimensions has.
pub fn with_digits(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "–".to_owned();
    }
    if !PLAIN.contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.*}", decimals(value, digits));
    if text.contains('.') {
        let text = text.trim_end_matches('0');
        return text.trim_end_matches('.').to_owned();
    }
    text
}

/// Digits after the point of a value of this magnitude.
fn decimals(value: f64, digits: i32) -> usize {
    let before = value.abs().log10().floor();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a power of ten of a number"
    )]
    let wanted = digits - 1 - before as i32;
    // Beyond twelve nothing is left but zeros.
    usize::try_from(wanted.clamp(0, 12)).unwrap_or(0)
}

/// A unit and how much of SI it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Its name.
    pub unit: &'static str,
    /// SI units in one of it.
    pub per: f64,
    /// Digits after the point, alike in a whole column.
    decimals: usize,
}

/// Units of a quantity, the largest first; the last is taken for what is less than all.
type Units = &'static [(&'static str, f64)];

/// A quantity of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A force.
    Force,
    /// A torque.
    Torque,
    /// A power.
    Power,
    /// A stiffness.
    Stiffness,
    /// A speed of rotation.
    Turning,
    /// A length.
    Length,
    /// A depth of contact.
    Depth,
    /// An angle.
    Angle,
    /// An impulse.
    Impulse,
    /// A speed.
    Speed,
    /// An energy.
    Energy,
    /// A pressure.
    Pressure,
    /// A time.
    Time,
}

impl Measure {
    fn units(self) -> Units {
        match self {
            Self::Force => &[("MN", 1e6), ("kN", 1e3), ("N", 1.0)],
            Self::Torque => &[("kN m", 1e3), ("N m", 1.0)],
            Self::Power => &[("MW", 1e6), ("kW", 1e3), ("W", 1.0)],
            Self::Stiffness => &[("GN/m", 1e9), ("MN/m", 1e6), ("kN/m", 1e3), ("N/m", 1.0)],
            Self::Turning => &[("rpm", TAU / 60.0)],
            Self::Length => &[("mm", 1e-3)],
            Self::Depth => &[("µm", 1e-6)],
            Self::Angle => &[("deg", TAU / 360.0)],
            Self::Impulse => &[("N s", 1.0), ("mN s", 1e-3)],
            Self::Speed => &[("m/s", 1.0)],
            Self::Energy => &[("MJ", 1e6), ("kJ", 1e3), ("J", 1.0), ("mJ", 1e-3)],
            Self::Pressure => &[("GPa", 1e9), ("N/mm²", 1e6), ("kPa", 1e3), ("Pa", 1.0)],
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)],
        }
    }

    /// The quantity of an SI unit of scenes; none where the trade writes the unit as it is.
    pub fn of_unit(unit: &str) -> Option<Self> {
        Some(match unit {
            "N" => Self::Force,
            "N m" => Self::Torque,
            "W" => Self::Power,
            "N/m" => Self::Stiffness,
            "rad/s" => Self::Turning,
            "m" => Self::Length,
            "rad" => Self::Angle,
            "Pa" => Self::Pressure,
            _ => return None,
        })
    }

    /// The value from which on a unit is taken: forces and the like stay in N and W to ten thousand.
    fn least_in_a_unit(self) -> f64 {
        match self {
            Self::Force | Self::Torque | Self::Power => 10.0,
            _ => 1.0,
        }
    }

    /// The unit for some values in SI: the largest in which the greatest has digits before the point as the trade has them, or else the least unit.
    pub fn scale(self, values: impl IntoIterator<Item = f64>) -> Scale {
        let finite = values.into_iter().map(f64::abs).filter(|it| it.is_finite());
        let greatest = finite.fold(0.0, f64::max);
        let units = self.units();
        let least = self.least_in_a_unit();
        let fits = units
            .iter()
            .find(|(_, per)| greatest >= 0.99995 * least * per);
        let (unit, per) = *fits.unwrap_or(&units[units.len() - 1]);
        let decimals = match greatest / per {
            0.0 => 0,
            // One more, for what is less than the greatest.
            shown => decimals(shown, DIGITS + 1).min(6),
        };
        Scale {
            unit,
            per,
            decimals,
        }
    }

    /// A value in SI with its unit: `12.4 kN`.
    pub fn told(self, value: f64) -> String {
        self.told_with(value, DIGITS)
    }

    /// The same with another number of digits.
    pub fn told_with(self, value: f64, digits: i32) -> String {
        let scale = self.scale([value]);
        format!("{} {}", with_digits(value / scale.per, digits), scale.unit)
    }
}

impl Scale {
    /// A value in SI, in this unit, with as many digits after the point as all of the column.
    pub fn cell(&self, value: f64) -> String {
        let value = value / self.per;
        if !value.is_finite() {
            return "–".to_owned();
        }
        let text = format!("{value:.*}", self.decimals);
        // Nothing is less than nothing.
        let is_zero = text
            .trim_start_matches('-')
            .chars()
            .all(|it| matches!(it, '0' | '.'));
        if is_zero {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        }
    }

    /// A value in SI, in this unit, with three digits of its own: a half width, or what is far less than the rest of its column.
    pub fn small(&self, value: f64) -> String {
        let value = value / self.per;
        if !value.is_finite() {
            return "–".to_owned();
        }
        if value == 0.0 {
            return "0".to_owned();
        }
        format!("{value:.*}", decimals(value, 3))
    }
}

/// Per cent, with the digits that mean something.
pub(crate) fn percent(value: f64) -> String {
    let value = 100.0 * value;
    if value.is_nan() {
        "none".to_owned()
    } else if value.is_infinite() {
        "without bound".to_owned()
    } else if value >= 0.1 {
        format!("{value:.1} %")
    } else if value >= 1e-3 || value == 0.0 {
        format!("{value:.3} %")
    } else {
        "below 0.001 %".to_owned()
    }
}

/// A time with two to three digits, in the unit that suits it.
pub(crate) fn duration(seconds: f64) -> String {
    // Ordered from the largest; what is shorter than a nanosecond stays in nanoseconds.
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")];
    let fits = |(unit, _): &&(f64, &str)| seconds.abs() >= 0.9995 * unit;
    let (unit, name) = units.iter().find(fits).unwrap_or(&units[3]);
    let value = seconds / unit;
    if value.abs() >= 9.95 {
        format!("{value:.0} {name}")
    } else {
        let text = format!("{value:.1}");
        format!("{} {name}", text.trim_end_matches(".0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_suit_the_values() {
        assert_eq!(Measure::Force.told(254.6), "254.6 N");
        assert_eq!(Measure::Force.told(9_100.0), "9100 N");
        assert_eq!(Measure::Force.told(38_663.0), "38.66 kN");
        assert_eq!(Measure::Power.told(0.2), "0.2 W");
        assert_eq!(Measure::Stiffness.told(4.37e9), "4.37 GN/m");
        assert_eq!(Measure::Turning.told(157.08), "1500 rpm");
        let scale = Measure::Force.scale([5.8262, 38_663.1, f64::NAN]);
        assert_eq!(scale.unit, "kN");
        assert_eq!(scale.cell(5826.2), "5.826");
        assert_eq!(scale.cell(-0.001), "0.000");
        assert_eq!(scale.cell(f64::NAN), "–");
    }

    /// Whatever the magnitude.
    #[test]
    fn no_figure_has_a_power_of_ten() {
        for exponent in -10..14 {
            let text = figure(3.254_3 * 10_f64.powi(exponent));
            assert!(!text.contains('e'), "{text}");
        }
    }

    #[test]
    fn times_are_told_in_the_unit_that_suits_them() {
        let told = [0.0932, 1.184e-3, 2.7e-4, 0.99999, 12.0, 2e-3, 5e-9, 0.0];
        let told = told.map(duration);
        let wanted = [
            "93 ms", "1.2 ms", "270 µs", "1 s", "12 s", "2 ms", "5 ns", "0 ns",
        ];
        assert_eq!(told, wanted);
    }

    #[test]
    fn shares_keep_the_digits_that_mean_something() {
        let told = [0.117, 2.3e-4, 4e-9, f64::INFINITY, f64::NAN].map(percent);
        let wanted = [
            "11.7 %",
            "0.023 %",
            "below 0.001 %",
            "without bound",
            "none",
        ];
        assert_eq!(told, wanted);
    }
}
