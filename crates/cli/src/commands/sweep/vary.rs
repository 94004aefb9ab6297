//! Syntax of `--vary`: `path=value,value,first..last/count`.

use chaindrive::Scene;
use chaindrive::sweep::Setting;

use crate::failure::Failure;

/// Reads a path and its values.
pub(super) fn read(scene: &Scene, text: &str) -> Result<(String, Vec<Setting>), Failure> {
    let refuse = |reason: &str| {
        let such_as =
            "such as \"route.pretension=10 kN,20 kN\" or \"route.pretension=10 kN..20 kN/5\"";
        Failure::Argument(format!("--vary {text}: {reason}, {such_as}"))
    };
    let Some((path, values)) = text.split_once('=') else {
        return Err(refuse("a path and its values are needed"));
    };
    let path = path.trim();
    let mut settings = Vec::new();
    for value in outside(values, ",") {
        let value = value.trim();
        if value.is_empty() {
            return Err(refuse("a value is missing"));
        }
        let ends = outside(value, "..");
        if let [first, rest] = ends.as_slice() {
            // After the last slash, for units have slashes too.
            let count = rest.rsplit_once('/');
            let count = count.and_then(|(last, count)| Some((last, count.trim().parse().ok()?)));
            let Some((last, count)) = count else {
                return Err(refuse(&format!(
                    "`{value}` does not say how many values; a range is FIRST..LAST/COUNT"
                )));
            };
            settings.extend(Setting::range(
                scene,
                path,
                first.trim(),
                last.trim(),
                count,
            )?);
        } else {
            settings.push(Setting::Text(value.to_owned()));
        }
    }
    Ok((path.to_owned(), settings))
}

/// Splits a text at a mark, but not within quotes or brackets.
fn outside<'t>(text: &'t str, mark: &str) -> Vec<&'t str> {
    let mut parts = Vec::new();
    let (mut begin, mut depth, mut quote, mut skip) = (0, 0_usize, None, 0);
    for (at, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(open), _) if open == letter => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(letter),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth = depth.saturating_sub(1),
            _ if depth == 0 && at >= skip && text[at..].starts_with(mark) => {
                parts.push(&text[begin..at]);
                begin = at + mark.len();
                skip = begin;
            }
            _ => {}
        }
    }
    parts.push(&text[begin..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marine(text: &str) -> Result<Vec<String>, String> {
        let scene = Scene::preset("marine_two_sprockets").map_err(|error| error.to_string())?;
        let (_, settings) = read(&scene, text).map_err(|error| error.to_string())?;
        let texts = settings.into_iter().map(|setting| match setting {
            Setting::Text(text) => text,
            Setting::Json(json) => json.to_string(),
        });
        Ok(texts.collect())
    }

    #[test]
    fn values_and_ranges() {
        let table = [
            ("route.pretension=10 kN, 20 kN", vec!["10 kN", "20 kN"]),
            (
                "route.pretension = 1 kN,2 kN..4 kN/3",
                vec!["1 kN", "2000.0", "3000.0", "4000.0"],
            ),
            ("gravity=[0, 0],[0, -9.81]", vec!["[0, 0]", "[0, -9.81]"]),
            ("title='a,b..c/2',d", vec!["'a,b..c/2'", "d"]),
            ("sprockets.crank.teeth=18..20/3", vec!["18", "19", "20"]),
            (
                "sprockets.crank.motion.speed=0..-1 r/s/2",
                vec!["0.0", "-6.283185307179586"],
            ),
            ("run.until=1 ms", vec!["1 ms"]),
        ];
        for (text, values) in table {
            assert_eq!(marine(text).unwrap(), values, "{text}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_refused_with_an_example() {
        for (text, words) in [
            ("route.pretension", "a path and its values"),
            ("route.pretension=1 kN,,2 kN", "a value is missing"),
            ("route.pretension=1 kN..2 kN", "how many values"),
            ("run.until=1 m/s..2 m/s", "how many values"),
            ("route.pretension=1 kN..2 kN/1", "2 to"),
        ] {
            let message = marine(text).unwrap_err();
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
