//! Numbers as a reader wants them: per cent and times with the digits that mean something.

/// Per cent, with the digits that mean something.
pub(crate) fn percent(value: f64) -> String {
    let value = 100.0 * value;
    if value.is_nan() {
        "none".to_owned()
    } else if value.is_infinite() {
        "without bound".to_owned()
    } else if value >= 0.1 {
        format!("{value:.1} %")
    } else if value >= 1e-3 {
        format!("{value:.3} %")
    } else {
        format!("{value:.0e} %")
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
        let wanted = ["11.7 %", "0.023 %", "4e-7 %", "without bound", "none"];
        assert_eq!(told, wanted);
    }
}
