//! Texts with units, read as quantities: the only place where millimetres become metres.

use std::borrow::Cow;

use crate::quantity::{DIMENSIONS, Dimension};
use crate::unit::{self, Powers, Unit, UnitProblem};

/// Name of the quantity whose unit depends on the exponent beside it.
pub const CONTACT_STIFFNESS: &str = "a contact stiffness";

/// Name of the quantity whose scale has a zero of its own in degrees Celsius.
const TEMPERATURE: &str = "a temperature";

/// Powers of a mass per length, as catalogues give that of a chain.
const MASS_PER_LENGTH: Powers = Powers([-1.0, 1.0, 0.0, 0.0, 0.0]);

/// Powers of a kinematic viscosity.
const KINEMATIC: Powers = Powers([2.0, 0.0, -1.0, 0.0, 0.0]);

/// Why a text is not the quantity that is needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Complaint {
    /// Problem of the text.
    pub message: String,
    /// Text to write instead.
    pub hint: String,
}

/// A time \[s\] from a number and a unit, such as `"0.1 s"`.
///
/// # Errors
/// The fault of the text, in words.
pub fn read_time(text: &str) -> Result<f64, String> {
    in_unit("s")
        .read(text, None)
        .map_err(|complaint| complaint.message)
}

/// A length \[m\] from a number and a unit, such as `"12.7 mm"`.
///
/// # Errors
/// The mistake in the text.
pub fn read_length(text: &str) -> Result<f64, String> {
    let bare = text.trim();
    if bare.parse::<f64>().is_ok() {
        return Err(format!(
            "`{bare}` has no unit; write \"{bare} mm\", or \"{bare} m\""
        ));
    }
    let read = in_unit("m").read(text, None);
    read.map_err(|complaint| format!("{}; {}", complaint.message, complaint.hint))
}

/// A unit in SI: x of it are `factor` x + `zero` of [`unit`](Self::unit).
#[derive(Clone, Debug, PartialEq)]
pub struct UnitInSi {
    /// Units of SI that one is.
    pub factor: f64,
    /// Zero of its scale, in units of SI: other than 0 for degrees Celsius only.
    pub zero: f64,
    /// Unit of SI.
    pub unit: &'static str,
    /// Quantity that it measures, with its article.
    pub quantity: &'static str,
}

/// A unit by itself, as the heading of a column has it, such as `"kN m"`; without one a pure number.
///
/// # Errors
/// The mistake in the text, or that no quantity has such a unit.
pub fn read_unit(text: &str) -> Result<UnitInSi, Complaint> {
    let exact = unit::parse(text).map(|unit| unit.powers);
    let fits = |it: &&Dimension| {
        it.name != CONTACT_STIFFNESS && it.read(&format!("1 {text}"), None).is_ok()
    };
    let known = || DIMENSIONS.iter().filter(fits);
    // A torque without its radian is a spring that turns, too.
    let same = |it: &&Dimension| {
        exact
            .as_ref()
            .is_ok_and(|powers| powers.matches(Powers(it.powers)))
    };
    let Some(dimension) = known().find(same).or_else(|| known().next()) else {
        return Err(match exact {
            Ok(powers) => Complaint {
                message: format!("no quantity of a drive is {}", name_of(powers)),
                hint: "write a unit such as \"kN m\", \"rpm\" or \"bar\"".into(),
            },
            Err(_) => in_unit("m")
                .read(&format!("1 {text}"), None)
                .expect_err("no quantity has this unit, and a length neither"),
        });
    };
    let zero = dimension.read(&format!("0 {text}"), None)?;
    let one = dimension.read(&format!("1 {text}"), None)?;
    Ok(UnitInSi {
        factor: one - zero,
        zero,
        unit: dimension.unit,
        quantity: dimension.name,
    })
}

/// Whether a text is a number, with a unit that a scene knows or without.
pub fn is_number(text: &str) -> bool {
    let text = text.trim();
    let mut dimensions = DIMENSIONS.iter();
    text.parse::<f64>().is_ok() || dimensions.any(|it| it.read(text, None).is_ok())
}

/// The dimension of an SI unit.
fn in_unit(unit: &str) -> &'static Dimension {
    let found = DIMENSIONS.iter().find(|dimension| dimension.unit == unit);
    found.expect("there is a quantity in this unit")
}

impl Dimension {
    /// Units of this dimension that a text may mean whose symbols stand side by side, or whose powers have no `^`: `N m` for `Nm`,
    /// `kg m^2` for `kgm2`.
    fn meant(&self, text: &str, problem: &UnitProblem, exponent: Option<f64>) -> Vec<String> {
        let ways = match problem {
            UnitProblem::Unknown(symbol) => unit::apart(text, symbol),
            UnitProblem::Grammar(_) => vec![unit::with_powers(text)],
        };
        let fitting = ways.into_iter().filter(|way| self.is_unit(way, exponent));
        fitting.collect()
    }

    fn is_unit(&self, text: &str, exponent: Option<f64>) -> bool {
        unit::parse(text).is_ok_and(|unit| self.fits(unit.powers, exponent))
    }

    /// Reads a number and a unit into SI; `exponent` is the n of a power law, where known.
    ///
    /// # Errors
    /// What is wrong with the text, and what to write.
    pub fn read(&self, text: &str, exponent: Option<f64>) -> Result<f64, Complaint> {
        let text = text.trim();
        let complain = |message: String, hint: String| Complaint { message, hint };
        let such_as = || format!("write {} such as \"{}\"", self.name, self.example);
        let Some((number, rest)) = split_fraction(text).or_else(|| {
            let (number, rest) = split_number(text)?;
            Some((number.into(), rest))
        }) else {
            return Err(complain(
                format!("`{text}` does not begin with a number"),
                such_as(),
            ));
        };
        let number = number.as_ref();
        let beyond = || {
            complain(
                format!("`{text}` is beyond what a double holds, 1.8e308"),
                such_as(),
            )
        };
        if number.parse().is_ok_and(f64::is_infinite) {
            return Err(beyond());
        }
        if rest.starts_with(',') {
            return Err(complain(
                format!("`{text}` has a comma"),
                "decimals are written with a point".into(),
            ));
        }
        if let Some(kelvin) = unit::celsius(shift_decimal(number, 0), rest) {
            return if self.name == TEMPERATURE {
                Ok(kelvin)
            } else {
                Err(complain(
                    format!("`{text}` is a temperature, needed is {}", self.name),
                    such_as(),
                ))
            };
        }
        let unit = if rest.trim().is_empty() {
            if !Powers(self.powers).matches(Powers::default()) {
                return Err(complain(
                    format!("`{text}` has no unit"),
                    format!("{}, or the bare number {number} [{}]", such_as(), self.unit),
                ));
            }
            // No unit at all is a pure number.
            Unit {
                decade: 0,
                factor: 1.0,
                powers: Powers::default(),
            }
        } else {
            unit::parse(rest).or_else(|problem| {
                let ways = self.meant(rest, &problem, exponent);
                let mut units = ways.iter().flat_map(|way| unit::parse(way));
                let size = |unit: Unit| unit.factor * 10_f64.powi(unit.decade);
                let same = |one: Unit, other: Unit| (size(one) / size(other) - 1.0).abs() < 1e-9;
                match (units.next(), problem) {
                    (Some(first), _) if units.all(|other| same(other, first)) => Ok(first),
                    (Some(_), _) => Err(complain(
                        format!("`{text}` can be read in several ways"),
                        format!("write {}", spelt(number, &ways)),
                    )),
                    (None, UnitProblem::Unknown(symbol)) => Err(complain(
                        format!("unknown unit `{symbol}` in `{text}`"),
                        unit::instead_of(&symbol).map_or_else(
                            || format!("{}; the units are {}", such_as(), unit::known()),
                            str::to_owned,
                        ),
                    )),
                    (None, UnitProblem::Grammar(reason)) => Err(complain(
                        format!("`{}` is not a unit: {reason}", rest.trim()),
                        such_as(),
                    )),
                }
            })?
        };
        if !self.fits(unit.powers, exponent) {
            let hint = self.hint_for(unit.powers, exponent);
            let name = name_of(unit.powers);
            return Err(complain(
                format!("`{text}` is {name}, needed is {}", self.name),
                hint,
            ));
        }
        let value = shift_decimal(number, unit.decade) * unit.factor;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(beyond())
        }
    }

    fn fits(&self, found: Powers, exponent: Option<f64>) -> bool {
        if self.name == CONTACT_STIFFNESS {
            // N/mⁿ = kg m^(1−n) s⁻²
            let n = exponent.unwrap_or(1.0 - found.0[0]);
            return found.matches(Powers([1.0 - n, 1.0, -2.0, 0.0, 0.0]));
        }
        let needed = Powers(self.powers);
        if self.strict_angle {
            found.matches(needed)
        } else {
            found.without_angle().matches(needed.without_angle())
        }
    }

    fn hint_for(&self, found: Powers, exponent: Option<f64>) -> String {
        let per_second = Powers([0.0, 0.0, -1.0, 0.0, 0.0]);
        let turning = Powers([0.0, 0.0, -1.0, 1.0, 0.0]);
        match self.name {
            "an angular speed" if found.matches(per_second) => {
                "1/s and Hz count events; write radians or turns, \"10 rad/s\" or \"1500 rpm\""
                    .into()
            }
            "a frequency" if found.matches(turning) => {
                "a speed of rotation is not a frequency; write \"25 Hz\" for 1500 rpm".into()
            }
            "a mass" if found.matches(MASS_PER_LENGTH) => {
                format!("that of a link is this times the pitch, such as \"{}\"", self.example)
            }
            "a viscosity" if found.matches(KINEMATIC) => {
                "times the density it is the dynamic one: 1 cSt of an oil of 870 kg/m^3 is \"0.87 mPa s\"".into()
            }
            "a torque" if found.matches(Powers([1.0, 1.0, 0.0, 0.0, 0.0])) => {
                "a torque is a force times a length: write \"10 lbf ft\" or \"10 N m\"".into()
            }
            CONTACT_STIFFNESS => match exponent {
                Some(n) => format!("with exponent = {n} the unit is N/m^{n}"),
                None => format!("such as \"{}\"", self.example),
            },
            _ => format!("such as \"{}\"", self.example),
        }
    }
}

/// Name of a dimension, or else its powers.
fn name_of(powers: Powers) -> String {
    let known = DIMENSIONS.iter().find(|d| powers.matches(Powers(d.powers)));
    match known {
        Some(dimension) => dimension.name.to_owned(),
        None if powers.matches(Powers([2.0, 1.0, -3.0, 0.0, 0.0])) => "a power".to_owned(),
        None if powers.matches(MASS_PER_LENGTH) => "a mass per length".to_owned(),
        None => format!("in {powers}"),
    }
}

/// The decimal number at the beginning of a text, and what follows it.
fn split_number(text: &str) -> Option<(&str, &str)> {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let start = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mut end = digits(start);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let after = digits(end + 1 + sign);
        if after > end + 1 + sign {
            end = after;
        }
    }
    let (number, rest) = text.split_at(end);
    number.parse::<f64>().ok()?;
    Some((number, rest))
}

/// The fraction at the beginning of a text, such as `1/2` or `1 1/4`, as a decimal number, and what follows it.
fn split_fraction(text: &str) -> Option<(Cow<'static, str>, &str)> {
    let (sign, unsigned) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text),
    };
    let whole = |text: &'_ str| {
        let end = text.find(|c: char| !c.is_ascii_digit());
        let end = end.unwrap_or(text.len());
        text[..end]
            .parse::<u32>()
            .ok()
            .map(|number| (f64::from(number), end))
    };
    let (mut first, mut at) = whole(unsigned)?;
    let mut before = 0.0;
    let behind = unsigned[at..].trim_start();
    if let Some((second, end)) = whole(behind)
        && behind.len() < unsigned.len() - at
    {
        at = unsigned.len() - behind.len() + end;
        (before, first) = (first, second);
    }
    let below = unsigned[at..].strip_prefix('/')?;
    let (below, end) = whole(below)?;
    let rest = &unsigned[at + 1 + end..];
    // `1/2.5` and `1/2e3` are none; `1 1/m` has a letter below, and ended above.
    if below == 0.0 || rest.starts_with(['.', ',', '/']) {
        return None;
    }
    let number = sign * (before + first / below);
    Some((format!("{number:?}").into(), rest))
}

/// A number in several units, for a message.
fn spelt(number: &str, units: &[String]) -> String {
    let ways = units.iter().map(|unit| format!("`{number} {unit}`"));
    ways.collect::<Vec<_>>().join(" or ")
}

/// The number with its decimal point moved, rounded once.
fn shift_decimal(number: &str, decade: i32) -> f64 {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(i32::MAX);
    let shifted = format!("{mantissa}e{}", exponent.saturating_add(decade));
    shifted.parse().unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<f64, Complaint> {
        Dimension::named(name).unwrap().read(text, None)
    }

    #[test]
    fn decimals_are_exact() {
        assert_eq!(read("a length", "88.9 mm"), Ok(0.0889));
        assert_eq!(read("a length", "88.9mm"), Ok(0.0889));
        assert_eq!(read("a stiffness", "815 MN/m"), Ok(815e6));
        assert_eq!(read("a mass", "8.89 g"), Ok(0.00889));
        assert_eq!(read("a mass", "3.01 kg"), Ok(3.01));
        assert_eq!(read("a pure number", "0.5 %"), Ok(0.005));
        assert_eq!(read("a pure number", "0.5"), Ok(0.5));
        assert_eq!(read("a length", "-1.5e2 µm"), Ok(-1.5e-4));
        assert_eq!(read("an acceleration", "-9.81 m/s^2"), Ok(-9.81));
        assert_eq!(read("a pressure", "0.3 MPa"), Ok(0.3e6));
        assert_eq!(read("a rotational damping", "2 N m s"), Ok(2.0));
        assert_eq!(read("a rotational damping", "2 N m s/rad"), Ok(2.0));
        assert_eq!(read("a contact stiffness", "6e11 N/m^1.5"), Ok(6e11));
    }

    #[test]
    fn units_may_stand_together() {
        for (name, text, value) in [
            ("a torque", "60 Nm", 60.0),
            ("a torque", "2 kNm", 2e3),
            ("a torque", "5 Nmm", 5e-3),
            ("a rotational stiffness", "40 Nm/rad", 40.0),
            ("a rotational damping", "2 Nms", 2.0),
            ("a damping", "3 Ns/m", 3.0),
            ("a moment of inertia", "3 kgm^2", 3.0),
            ("a moment of inertia", "0.4 kgm²", 0.4),
            ("a moment of inertia", "0.4 kgm2", 0.4),
            ("a moment of inertia", "0.4 kg m2", 0.4),
            ("an acceleration", "9.81 m/s2", 9.81),
        ] {
            assert_eq!(read(name, text), Ok(value), "{text}");
        }
    }

    #[test]
    fn fractions_are_numbers() {
        for (name, text, value) in [
            ("a length", "1/2 in", 0.0127),
            ("a length", "3/8in", 0.009_525),
            ("a length", "1 1/4 in", 0.031_75),
            ("a length", "-1 1/2 in", -0.038_1),
            ("a pure number", "1/3", 1.0 / 3.0),
            ("a pure number", "1/2 %", 0.005),
            // A unit below one is none.
            ("an inverse length", "5 1/m", 5.0),
            ("an inverse length", "1e5 1/m", 1e5),
            ("an inverse length", "2/m", 2.0),
        ] {
            let found = read(name, text).unwrap();
            assert!(
                (found - value).abs() <= 1e-15 * value.abs(),
                "{text}: {found}"
            );
        }
    }

    #[test]
    fn angles_and_turns() {
        let speed = read("an angular speed", "1500 rpm").unwrap();
        assert!((speed - 157.079_632_679_489_66).abs() < 1e-12);
        let angle = read("an angle", "180°").unwrap();
        assert!((angle - std::f64::consts::PI).abs() < 1e-15);
    }

    #[test]
    fn temperatures_have_a_zero_of_their_own_in_degrees() {
        for (text, kelvin) in [("60 degC", 333.15), ("-20 °C", 253.15), ("300 K", 300.0)] {
            let found = read("a temperature", text).unwrap();
            assert!((found - kelvin).abs() < 1e-12, "{text}: {found}");
        }
        assert_eq!(read("a temperature difference", "40 K"), Ok(40.0));
        let expansion = read("a thermal expansion", "11.5e-6 1/K");
        assert_eq!(expansion, Ok(11.5e-6));
    }

    #[test]
    fn complaints_say_what_to_write() {
        let table = [
            (
                "a temperature difference",
                "40 degC",
                "is a temperature, needed is a temperature difference",
                "40 K",
            ),
            ("a temperature", "60 deg", "is an angle", "60 degC"),
            ("a temperature", "60", "has no unit", "60 degC"),
            (
                "an angular speed",
                "12 mm",
                "`12 mm` is a length, needed is an angular speed",
                "1500 rpm",
            ),
            ("an angular speed", "10 1/s", "is a frequency", "10 rad/s"),
            ("an angular speed", "10 Hz", "is a frequency", "rad/s"),
            ("a frequency", "1500 rpm", "is an angular speed", "25 Hz"),
            (
                "a length",
                "12 furlong",
                "unknown unit `furlong`",
                "the units are m g s",
            ),
            (
                "a length",
                "60 Nm",
                "unknown unit `Nm`",
                "the units are m g s",
            ),
            (
                "a quadratic rotational damping",
                "2 Nmms^2",
                "can be read in several ways",
                "write `2 N m ms^2` or `2 N mm s^2`",
            ),
            ("a length", "1/0 in", "is not a unit", "88.9 mm"),
            ("a length", "1/2.5 in", "is not a unit", "88.9 mm"),
            ("a length", "12", "has no unit", "the bare number 12 [m]"),
            ("a length", "12,7 mm", "has a comma", "point"),
            ("a length", "mm", "does not begin with a number", "88.9 mm"),
            (
                "a length",
                "nan mm",
                "does not begin with a number",
                "88.9 mm",
            ),
            (
                "a length",
                "1e999 m",
                "`1e999 m` is beyond what a double holds, 1.8e308",
                "88.9 mm",
            ),
            ("a length", "1e400", "beyond what a double holds", "88.9 mm"),
            (
                "a length",
                "1e308 km",
                "beyond what a double holds",
                "88.9 mm",
            ),
            ("a length", "", "does not begin with a number", "88.9 mm"),
            ("a torque", "5 kW", "is a power", "5 kN m"),
            (
                "a damping",
                "5 N/m s",
                "what stands under `/`",
                "2.97 kN s/m",
            ),
            ("a mass", "2 kg m2", "write powers as `^2`", "3.01 kg"),
            ("a pure number", "3 mm", "is a length", "3 %"),
        ];
        for (name, text, message, hint) in table {
            let complaint = read(name, text).unwrap_err();
            assert!(complaint.message.contains(message), "{complaint:?}");
            assert!(complaint.hint.contains(hint), "{complaint:?}");
        }
    }

    #[test]
    fn units_of_columns_are_read_alone() {
        for (text, factor, zero, si) in [
            ("kN", 1e3, 0.0, "N"),
            ("Nm", 1.0, 0.0, "N m"),
            ("N m/rad", 1.0, 0.0, "N m/rad"),
            ("bar", 1e5, 0.0, "Pa"),
            ("1/min", 1.0 / 60.0, 0.0, "Hz"),
            ("%", 0.01, 0.0, "1"),
            ("", 1.0, 0.0, "1"),
            ("mm/s^2", 1e-3, 0.0, "m/s^2"),
        ] {
            let found = read_unit(text).unwrap();
            assert_eq!(
                (found.factor, found.zero, found.unit),
                (factor, zero, si),
                "{text}"
            );
        }
        let celsius = read_unit("degC").unwrap();
        assert_eq!((celsius.zero, celsius.unit), (273.15, "K"));
        assert!((celsius.factor - 1.0).abs() < 1e-12);
        let message = |text| read_unit(text).unwrap_err().message;
        assert!(message("furlong").contains("unknown unit `furlong`"));
        assert!(message("N/K").contains("no quantity of a drive is"));
    }

    #[test]
    fn the_unit_of_a_power_law_follows_its_exponent() {
        let stiffness = Dimension::named(CONTACT_STIFFNESS).unwrap();
        assert!(stiffness.read("6e11 N/m^1.5", Some(1.5)).is_ok());
        let complaint = stiffness.read("6e11 N/m", Some(1.5)).unwrap_err();
        assert!(complaint.hint.contains("N/m^1.5"), "{complaint:?}");
    }

    #[test]
    fn examples_are_valid() {
        for dimension in DIMENSIONS {
            assert!(
                dimension.read(dimension.example, None).is_ok(),
                "{}",
                dimension.name
            );
        }
    }
}
