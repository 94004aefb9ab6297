//! Guesses what a misspelt name was meant to be.

/// Typing errors between a written name and a known one, as long as they are few. Case and hyphens do not count.
pub(crate) fn distance(written: &str, known: &str) -> Option<usize> {
    let plain = |text: &str| text.to_lowercase().replace(['_', '-', ' '], "");
    let wanted: String = plain(written).chars().take(60).collect();
    let distance = strsim::damerau_levenshtein(&wanted, &plain(known));
    let few = distance <= known.len().min(wanted.len()) / 3 + 1 && distance < known.len();
    few.then_some(distance)
}

/// The known name closest to a written one, if it is close at all.
pub(crate) fn nearest<'k>(written: &str, known: &[&'k str]) -> Option<&'k str> {
    known
        .iter()
        .filter_map(|name| Some((distance(written, name)?, *name)))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// A hint that asks whether one of some names was meant.
pub(crate) fn did_you_mean(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => format!("did you mean {last}?"),
        Some((last, rest)) => format!("did you mean {} or {last}?", rest.join(", ")),
        None => String::new(),
    }
}

/// A hint: the nearest name, or all of them.
pub(crate) fn one_of(written: &str, known: &[&str]) -> String {
    match nearest(written, known) {
        Some(name) => format!("did you mean `{name}`?"),
        None if known.is_empty() => "there are none".to_owned(),
        None => format!("known are {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_are_recognised() {
        let known = ["teeth", "centre", "motion", "inertia", "name"];
        for (written, meant) in [
            ("teth", "teeth"),
            ("center", "centre"),
            ("Motion", "motion"),
            ("intertia", "inertia"),
        ] {
            assert_eq!(nearest(written, &known), Some(meant));
        }
        assert_eq!(nearest("xyzzy", &known), None);
        assert_eq!(nearest("", &["x"]), None);
        assert!(one_of("xyzzy", &known).contains("teeth, centre"));
    }
}
