//! Units in base units, and as people read them.

use std::f64::consts::PI;

/// Exponents of base units; empty for an unknown unit.
pub(super) fn base(unit: &str) -> &'static [(&'static str, i32)] {
    match unit {
        "s" => &[("s", 1)],
        "m" => &[("m", 1)],
        "m/s" => &[("m", 1), ("s", -1)],
        "rad" => &[("rad", 1)],
        "rad/s" => &[("s", -1), ("rad", 1)],
        "N" => &[("kg", 1), ("m", 1), ("s", -2)],
        "N/m" => &[("kg", 1), ("s", -2)],
        "N m" | "J" => &[("kg", 1), ("m", 2), ("s", -2)],
        "N m/rad" => &[("kg", 1), ("m", 2), ("s", -2), ("rad", -1)],
        "Pa" => &[("kg", 1), ("m", -1), ("s", -2)],
        _ => &[],
    }
}

/// Unit that people read, and its factor: shown = factor × value.
pub(super) fn shown(unit: &str) -> Option<(&'static str, f64)> {
    match unit {
        "m" => Some(("mm", 1e3)),
        "rad" => Some(("deg", 180.0 / PI)),
        "rad/s" => Some(("rpm", 30.0 / PI)),
        "N" => Some(("kN", 1e-3)),
        "Pa" => Some(("bar", 1e-5)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use chaindrive::Channel;

    use super::base;

    #[test]
    fn every_unit_of_a_channel_has_base_units() {
        let units = Channel::ALL.iter().map(|channel| channel.unit());
        let unknown: Vec<_> = units
            .filter(|unit| *unit != "1" && base(unit).is_empty())
            .collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
}
