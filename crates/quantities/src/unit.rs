//! Units as they are written: `kN s/m`, `N/m^1.5`, `kg m²`, `rpm`.
//!
//! A unit is a factor to SI and the powers of metre, kilogram, second, radian and kelvin. The radian is
//! kept apart from pure numbers: that is what tells a speed of rotation from a frequency.

use std::f64::consts::{PI, TAU};

/// Powers of the base units m, kg, s, rad and K.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Powers(pub(crate) [f64; 5]);

impl Powers {
    /// Whether both have the same powers, up to rounding of fractional ones.
    pub(crate) fn matches(self, other: Self) -> bool {
        self.0
            .iter()
            .zip(other.0)
            .all(|(a, b)| (a - b).abs() < 1e-9)
    }

    /// The powers without the radian.
    pub(crate) fn without_angle(self) -> Self {
        let [length, mass, time, _, temperature] = self.0;
        Self([length, mass, time, 0.0, temperature])
    }
}

impl std::fmt::Display for Powers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut separator = "";
        for (power, symbol) in self.0.iter().zip(["m", "kg", "s", "rad", "K"]) {
            if power.abs() < 1e-9 {
                continue;
            }
            if (power - 1.0).abs() < 1e-9 {
                write!(f, "{separator}{symbol}")?;
            } else {
                write!(f, "{separator}{symbol}^{power}")?;
            }
            separator = " ";
        }
        if separator.is_empty() {
            f.write_str("a pure number")?;
        }
        Ok(())
    }
}

/// A unit: its value in SI is 10^decade × factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    /// Decimal prefixes, kept apart so that `88.9 mm` becomes exactly the number 0.0889.
    pub(crate) decade: i32,
    /// The rest of the factor.
    pub(crate) factor: f64,
    /// Its dimension.
    pub(crate) powers: Powers,
}

/// Why a text is not a unit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum UnitProblem {
    /// A symbol that stands for nothing.
    Unknown(String),
    /// The symbols are known, but do not form a unit.
    Grammar(&'static str),
}

struct Symbol {
    name: &'static str,
    decade: i32,
    factor: f64,
    powers: [f64; 5],
    prefixed: bool,
}

const fn symbol(
    name: &'static str,
    decade: i32,
    factor: f64,
    powers: [f64; 5],
    prefixed: bool,
) -> Symbol {
    Symbol {
        name,
        decade,
        factor,
        powers,
        prefixed,
    }
}

const SYMBOLS: [Symbol; 30] = [
    symbol("m", 0, 1.0, [1.0, 0.0, 0.0, 0.0, 0.0], true),
    symbol("g", -3, 1.0, [0.0, 1.0, 0.0, 0.0, 0.0], true),
    symbol("s", 0, 1.0, [0.0, 0.0, 1.0, 0.0, 0.0], true),
    symbol("rad", 0, 1.0, [0.0, 0.0, 0.0, 1.0, 0.0], true),
    symbol("N", 0, 1.0, [1.0, 1.0, -2.0, 0.0, 0.0], true),
    symbol("Pa", 0, 1.0, [-1.0, 1.0, -2.0, 0.0, 0.0], true),
    symbol("W", 0, 1.0, [2.0, 1.0, -3.0, 0.0, 0.0], true),
    symbol("Hz", 0, 1.0, [0.0, 0.0, -1.0, 0.0, 0.0], true),
    symbol("bar", 5, 1.0, [-1.0, 1.0, -2.0, 0.0, 0.0], false),
    symbol("t", 3, 1.0, [0.0, 1.0, 0.0, 0.0, 0.0], false),
    symbol("min", 0, 60.0, [0.0, 0.0, 1.0, 0.0, 0.0], false),
    symbol("h", 0, 3600.0, [0.0, 0.0, 1.0, 0.0, 0.0], false),
    symbol("deg", 0, PI / 180.0, [0.0, 0.0, 0.0, 1.0, 0.0], false),
    symbol("°", 0, PI / 180.0, [0.0, 0.0, 0.0, 1.0, 0.0], false),
    symbol("r", 0, TAU, [0.0, 0.0, 0.0, 1.0, 0.0], false),
    symbol("rev", 0, TAU, [0.0, 0.0, 0.0, 1.0, 0.0], false),
    symbol("rpm", 0, TAU / 60.0, [0.0, 0.0, -1.0, 1.0, 0.0], false),
    symbol("in", 0, 0.0254, [1.0, 0.0, 0.0, 0.0, 0.0], false),
    symbol("inch", 0, 0.0254, [1.0, 0.0, 0.0, 0.0, 0.0], false),
    symbol("ft", 0, 0.3048, [1.0, 0.0, 0.0, 0.0, 0.0], false),
    symbol("lb", 0, 0.453_592_37, [0.0, 1.0, 0.0, 0.0, 0.0], false),
    symbol(
        "lbf",
        0,
        4.448_221_615_260_5,
        [1.0, 1.0, -2.0, 0.0, 0.0],
        false,
    ),
    symbol("kgf", 0, 9.806_65, [1.0, 1.0, -2.0, 0.0, 0.0], false),
    // lbf/in²
    symbol(
        "psi",
        0,
        4.448_221_615_260_5 / (0.0254 * 0.0254),
        [-1.0, 1.0, -2.0, 0.0, 0.0],
        false,
    ),
    symbol(
        "ksi",
        3,
        4.448_221_615_260_5 / (0.0254 * 0.0254),
        [-1.0, 1.0, -2.0, 0.0, 0.0],
        false,
    ),
    symbol("cP", -3, 1.0, [-1.0, 1.0, -1.0, 0.0, 0.0], false),
    symbol("cSt", -6, 1.0, [2.0, 0.0, -1.0, 0.0, 0.0], false),
    symbol("L", -3, 1.0, [3.0, 0.0, 0.0, 0.0, 0.0], true),
    symbol("K", 0, 1.0, [0.0, 0.0, 0.0, 0.0, 1.0], false),
    symbol("%", -2, 1.0, [0.0, 0.0, 0.0, 0.0, 0.0], false),
];

const PREFIXES: [(&str, i32); 10] = [
    ("n", -9),
    ("µ", -6),
    ("μ", -6),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

/// Zero of the Celsius scale \[K\].
const CELSIUS: f64 = 273.15;

/// The temperature \[K\] of a number of degrees Celsius; none where the unit is another one.
pub(crate) fn celsius(number: f64, unit: &str) -> Option<f64> {
    matches!(unit.trim(), "degC" | "°C").then_some(number + CELSIUS)
}

/// Units of the trade that mean several things, or no multiple of any, and what to write in their place.
const REFUSED: [(&[&str], &str); 6] = [
    (
        &["hp", "HP", "bhp", "PS", "ps", "CV", "cv"],
        "horsepowers differ: write \"0.7457 kW\" for one of 550 ft lbf/s, \"0.7355 kW\" for a metric one",
    ),
    (
        &["SUS", "SSU", "SUV"],
        "seconds of a viscometer are no multiple of a viscosity; write what a table gives for them in cSt",
    ),
    (
        &["oz", "ounce", "ounces"],
        "ounces are masses, forces or volumes; write \"28.35 g\" for the mass, \"0.278 N\" for the force",
    ),
    (
        &["ton", "tons"],
        "tons differ: write \"1 t\" for 1000 kg, \"2000 lb\" for a short ton, \"2240 lb\" for a long one",
    ),
    (
        &["mil", "mils", "thou"],
        "write \"0.0254 mm\" for a thousandth of an inch",
    ),
    (
        &["degF", "°F", "F"],
        "write degrees Celsius, (F − 32)/1.8: \"60 degC\" for 140 °F",
    ),
];

/// What to write in place of a unit that is not taken.
pub(crate) fn instead_of(symbol: &str) -> Option<&'static str> {
    let found = REFUSED.iter().find(|(names, _)| names.contains(&symbol));
    found.map(|(_, hint)| *hint)
}

/// The known symbols, for messages.
pub(crate) fn known() -> String {
    let names: Vec<_> = SYMBOLS.iter().map(|s| s.name).chain(["degC"]).collect();
    format!("{}; prefixes n µ u m c d k M G", names.join(" "))
}

/// Reads a unit such as `kN s/m`.
///
/// Factors stand side by side, or with `*` or `·`; `/` divides by the one factor that follows,
/// or by several in round brackets; powers are written `^2`, `^1.5`, `^-1`, `²`, `³`.
pub(crate) fn parse(text: &str) -> Result<Unit, UnitProblem> {
    let mut reader = Reader { rest: text.trim() };
    if let Some(rest) = reader.rest.strip_prefix('1') {
        reader.rest = rest.trim_start();
        if !reader.rest.starts_with('/') {
            return Err(UnitProblem::Grammar("only `1/…` may begin with a number"));
        }
    }
    let unit = reader.product(0)?;
    match reader.rest.chars().next() {
        None => Ok(unit),
        Some(_) => Err(UnitProblem::Grammar("a bracket closes that was not opened")),
    }
}

const NUMBER: Unit = Unit {
    decade: 0,
    factor: 1.0,
    powers: Powers([0.0; 5]),
};

struct Reader<'t> {
    rest: &'t str,
}

impl Reader<'_> {
    fn product(&mut self, depth: usize) -> Result<Unit, UnitProblem> {
        let mut product = NUMBER;
        let mut divided = false;
        loop {
            self.rest = self.rest.trim_start();
            let sign = match self.rest.chars().next() {
                None | Some(')') => return Ok(product),
                Some('/') => {
                    self.rest = self.rest[1..].trim_start();
                    divided = true;
                    -1.0
                }
                Some(c) => {
                    if divided {
                        return Err(UnitProblem::Grammar(
                            "what stands under `/`? write the divisor last, or in round brackets",
                        ));
                    }
                    if matches!(c, '*' | '·' | '⋅') {
                        self.rest = self.rest[c.len_utf8()..].trim_start();
                    }
                    1.0
                }
            };
            let factor = self.factor(depth)?;
            let power = sign * self.power()?;
            product = multiply(product, raise(factor, power));
        }
    }

    fn factor(&mut self, depth: usize) -> Result<Unit, UnitProblem> {
        if let Some(inner) = self.rest.strip_prefix('(') {
            if depth > 3 {
                return Err(UnitProblem::Grammar("too many brackets"));
            }
            self.rest = inner;
            let unit = self.product(depth + 1)?;
            self.rest = self
                .rest
                .strip_prefix(')')
                .ok_or(UnitProblem::Grammar("a bracket is not closed"))?;
            return Ok(unit);
        }
        let end = self
            .rest
            .find(|c: char| !(c.is_alphabetic() || matches!(c, '°' | '%' | '_')))
            .unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        if name.is_empty() {
            return Err(UnitProblem::Grammar("a unit symbol is missing"));
        }
        self.rest = rest;
        lookup(name).ok_or_else(|| {
            // `m2` reads as an unknown symbol, not as m followed by a stray digit.
            UnitProblem::Unknown(name.to_owned())
        })
    }

    /// The power after a factor; 1 when there is none.
    fn power(&mut self) -> Result<f64, UnitProblem> {
        for (mark, power) in [("²", 2.0), ("³", 3.0), ("⁻¹", -1.0), ("⁻²", -2.0)] {
            if let Some(rest) = self.rest.strip_prefix(mark) {
                self.rest = rest;
                return Ok(power);
            }
        }
        let Some(rest) = self.rest.strip_prefix('^') else {
            return if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
                Err(UnitProblem::Grammar("write powers as `^2`"))
            } else {
                Ok(1.0)
            };
        };
        let end = rest
            .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')))
            .unwrap_or(rest.len());
        let (number, rest) = rest.split_at(end);
        self.rest = rest;
        match number.parse::<f64>() {
            Ok(power) if power.abs() <= 9.0 => Ok(power),
            _ => Err(UnitProblem::Grammar("a number up to 9 must follow `^`")),
        }
    }
}

/// Ways of writing a unit with its unknown symbol taken apart into known ones: `N m` for `Nm`, `kg m^2` for `kgm2`.
pub(crate) fn apart(text: &str, symbol: &str) -> Vec<String> {
    let written = |parts: String| with_powers(&text.trim().replacen(symbol, &parts, 1));
    known_parts(symbol).into_iter().map(written).collect()
}

/// A unit with its powers marked: `kg m^2` for `kg m2`.
pub(crate) fn with_powers(text: &str) -> String {
    let mut marked = String::with_capacity(text.len() + 2);
    for letter in text.trim().chars() {
        if letter.is_ascii_digit() && marked.ends_with(char::is_alphabetic) {
            marked.push('^');
        }
        marked.push(letter);
    }
    marked
}

/// Letters of the longest text that is cut into symbols: each more multiplies the ways.
const LONGEST: usize = 12;

/// Ways of writing a text as known symbols side by side; none for a long one.
fn known_parts(text: &str) -> Vec<String> {
    if text.chars().nth(LONGEST).is_some() {
        return Vec::new();
    }
    let cuts = text.char_indices().map(|(at, _)| at).skip(1);
    let mut ways: Vec<String> = cuts
        .map(|at| text.split_at(at))
        .filter(|(first, _)| lookup(first).is_some())
        .flat_map(|(first, rest)| {
            let rest = known_parts(rest);
            rest.into_iter().map(move |rest| format!("{first} {rest}"))
        })
        .collect();
    if lookup(text).is_some() {
        ways.push(text.to_owned());
    }
    ways
}

fn lookup(name: &str) -> Option<Unit> {
    let unit = |symbol: &Symbol, decade: i32| Unit {
        decade: symbol.decade + decade,
        factor: symbol.factor,
        powers: Powers(symbol.powers),
    };
    if let Some(symbol) = SYMBOLS.iter().find(|s| s.name == name) {
        return Some(unit(symbol, 0));
    }
    PREFIXES.iter().find_map(|(prefix, decade)| {
        let base = name.strip_prefix(prefix)?;
        let symbol = SYMBOLS.iter().find(|s| s.prefixed && s.name == base)?;
        Some(unit(symbol, *decade))
    })
}

fn multiply(a: Unit, b: Unit) -> Unit {
    Unit {
        decade: a.decade + b.decade,
        factor: a.factor * b.factor,
        powers: Powers(std::array::from_fn(|i| a.powers.0[i] + b.powers.0[i])),
    }
}

fn raise(unit: Unit, power: f64) -> Unit {
    let powers = Powers(unit.powers.0.map(|p| p * power));
    let decade = f64::from(unit.decade) * power;
    // Half powers of ten (kN/mm^1.5) go into the factor.
    let whole = decade.trunc();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "prefixes and powers are small"
    )]
    Unit {
        decade: whole as i32,
        factor: unit.factor.powf(power) * 10_f64.powf(decade - whole),
        powers,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> (f64, [f64; 5]) {
        let unit = parse(text).unwrap_or_else(|problem| panic!("{text}: {problem:?}"));
        (unit.factor * 10_f64.powi(unit.decade), unit.powers.0)
    }

    #[test]
    fn units_of_the_trade() {
        let table = [
            ("mm", 1e-3, [1.0, 0.0, 0.0, 0.0, 0.0]),
            ("µm", 1e-6, [1.0, 0.0, 0.0, 0.0, 0.0]),
            ("um", 1e-6, [1.0, 0.0, 0.0, 0.0, 0.0]),
            ("kg", 1.0, [0.0, 1.0, 0.0, 0.0, 0.0]),
            ("g", 1e-3, [0.0, 1.0, 0.0, 0.0, 0.0]),
            ("MN/m", 1e6, [0.0, 1.0, -2.0, 0.0, 0.0]),
            ("N/mm", 1e3, [0.0, 1.0, -2.0, 0.0, 0.0]),
            ("kN s/m", 1e3, [0.0, 1.0, -1.0, 0.0, 0.0]),
            ("kN*s/m", 1e3, [0.0, 1.0, -1.0, 0.0, 0.0]),
            ("N·s/m", 1.0, [0.0, 1.0, -1.0, 0.0, 0.0]),
            ("N/m^1.5", 1.0, [-0.5, 1.0, -2.0, 0.0, 0.0]),
            ("kN/mm^1.5", 10_f64.powf(7.5), [-0.5, 1.0, -2.0, 0.0, 0.0]),
            ("kg m^2", 1.0, [2.0, 1.0, 0.0, 0.0, 0.0]),
            ("kg m²", 1.0, [2.0, 1.0, 0.0, 0.0, 0.0]),
            ("g mm^2", 1e-9, [2.0, 1.0, 0.0, 0.0, 0.0]),
            ("m/s^2", 1.0, [1.0, 0.0, -2.0, 0.0, 0.0]),
            ("m/s/s", 1.0, [1.0, 0.0, -2.0, 0.0, 0.0]),
            ("m s^-2", 1.0, [1.0, 0.0, -2.0, 0.0, 0.0]),
            ("N/(m s)", 1.0, [0.0, 1.0, -3.0, 0.0, 0.0]),
            ("1/s", 1.0, [0.0, 0.0, -1.0, 0.0, 0.0]),
            ("kHz", 1e3, [0.0, 0.0, -1.0, 0.0, 0.0]),
            ("rpm", TAU / 60.0, [0.0, 0.0, -1.0, 1.0, 0.0]),
            ("r/min", TAU / 60.0, [0.0, 0.0, -1.0, 1.0, 0.0]),
            ("rev/min", TAU / 60.0, [0.0, 0.0, -1.0, 1.0, 0.0]),
            ("deg", PI / 180.0, [0.0, 0.0, 0.0, 1.0, 0.0]),
            ("°", PI / 180.0, [0.0, 0.0, 0.0, 1.0, 0.0]),
            ("mrad", 1e-3, [0.0, 0.0, 0.0, 1.0, 0.0]),
            ("%", 1e-2, [0.0, 0.0, 0.0, 0.0, 0.0]),
            ("bar", 1e5, [-1.0, 1.0, -2.0, 0.0, 0.0]),
            ("MPa", 1e6, [-1.0, 1.0, -2.0, 0.0, 0.0]),
            ("mPa s", 1e-3, [-1.0, 1.0, -1.0, 0.0, 0.0]),
            ("N m/rad", 1.0, [2.0, 1.0, -2.0, -1.0, 0.0]),
            ("in", 0.0254, [1.0, 0.0, 0.0, 0.0, 0.0]),
            ("mm²/s", 1e-6, [2.0, 0.0, -1.0, 0.0, 0.0]),
            ("K", 1.0, [0.0, 0.0, 0.0, 0.0, 1.0]),
            ("1/K", 1.0, [0.0, 0.0, 0.0, 0.0, -1.0]),
            ("min", 60.0, [0.0, 0.0, 1.0, 0.0, 0.0]),
        ];
        for (text, factor, powers) in table {
            let (found, found_powers) = value(text);
            assert!((found / factor - 1.0).abs() < 1e-12, "{text}: {found}");
            assert!(Powers(found_powers).matches(Powers(powers)), "{text}");
        }
    }

    #[test]
    fn long_texts_are_not_cut_into_symbols() {
        assert_eq!(known_parts("Nmm"), ["N m m", "N mm"]);
        assert_eq!(known_parts(&"m".repeat(LONGEST)).len(), 233);
        assert!(known_parts(&"m".repeat(77)).is_empty());
    }

    #[test]
    fn what_is_no_unit() {
        for text in ["mn", "furlong", "kmm", "Kg", "mrpm", "n"] {
            assert!(
                matches!(parse(text), Err(UnitProblem::Unknown(_))),
                "{text}"
            );
        }
        for text in [
            "N/m s",
            "m^",
            "m^x",
            "(N",
            "N)",
            "m2",
            "1",
            "1 m",
            "/",
            "N//m",
            "((((((m))))))",
            "m^99",
        ] {
            assert!(
                matches!(parse(text), Err(UnitProblem::Grammar(_))),
                "{text}"
            );
        }
    }
}
