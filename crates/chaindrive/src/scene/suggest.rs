//! Guesses what a misspelt name was meant to be.

/// The known name closest to a written one, if it is close at all.
pub(crate) fn nearest<'k>(written: &str, known: &[&'k str]) -> Option<&'k str> {
    let plain = |text: &str| text.to_lowercase().replace(['_', '-', ' '], "");
    let wanted: String = plain(written).chars().take(60).collect();
    known
        .iter()
        .map(|name| (strsim::damerau_levenshtein(&wanted, &plain(name)), *name))
        .filter(|(distance, name)| {
            *distance <= name.len().min(wanted.len()) / 3 + 1 && *distance < name.len()
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
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
