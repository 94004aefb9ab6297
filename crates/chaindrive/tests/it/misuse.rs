//! Presets with a random mistake in one line: whatever is written, the message is ours, with a place, and none of a library.

use chaindrive::scene::{Scene, SceneError, presets};

/// Mistakes that are made.
const MISTAKES: usize = 400;

/// Words of serde, serde_json and PyO3, which no user of a scene can do anything with.
const FOREIGN: [&str; 13] = [
    "invalid type",
    "invalid value",
    "invalid length",
    "missing field",
    "unknown field",
    "unknown variant",
    "duplicate field",
    "expected struct",
    "untagged",
    "did not match any variant",
    "PyErr",
    "TypeError",
    " at line ",
];

/// Numbers without a pattern, the same in every run: splitmix64.
struct Seeded(u64);

impl Seeded {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) >> 33).expect("31 bits") % bound
    }

    fn one_of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.below(choices.len())]
    }
}

/// Values of any type, one of which hardly suits.
const VALUES: [&str; 14] = [
    "3",
    "-3",
    "0",
    "1.5",
    "nan",
    "inf",
    "true",
    "\"\"",
    "\"many\"",
    "\"12 parsec\"",
    "[1, \"2\"]",
    "{}",
    "{ kind = \"none\" }",
    "1979-05-27",
];

const UNITS: [&str; 6] = ["mm", "rpm", "N m", "kg m^2", "1/s", "mmm"];

/// A line `key = value` with a mistake.
fn spoilt(line: &str, seeded: &mut Seeded) -> String {
    let Some((key, value)) = line.split_once('=') else {
        // A heading.
        return match seeded.below(3) {
            0 => line.replace('[', ""),
            1 => misspelt(line, seeded),
            _ => String::new(),
        };
    };
    match seeded.below(6) {
        0 => format!("{}={value}", misspelt(key, seeded)),
        1 => format!("{key}= {}", seeded.one_of(&VALUES)),
        2 => String::new(),
        3 => format!("{line}\n{line}"),
        4 => {
            // The unit, or what else stands after the first blank of a text.
            let unit = seeded.one_of(&UNITS);
            let quoted: Vec<&str> = value.splitn(3, '"').collect();
            match quoted.as_slice() {
                [before, text, after] => {
                    let number = text.split(' ').next().unwrap_or_default();
                    format!("{key}={before}\"{number} {unit}\"{after}")
                }
                _ => format!("{key}= \"{} {unit}\"", value.trim()),
            }
        }
        _ => format!("{key}={}", misspelt(value, seeded)),
    }
}

/// A text with a letter less, twice, or another one.
fn misspelt(text: &str, seeded: &mut Seeded) -> String {
    let letters: Vec<char> = text.chars().collect();
    let at = seeded.below(letters.len().max(1));
    let mut wrong: String = letters[..at].iter().collect();
    let rest = letters.get(at + 1..).unwrap_or_default();
    match (seeded.below(3), letters.get(at)) {
        (0, Some(letter)) => wrong.extend([*letter, *letter]),
        (1, _) => wrong.push('q'),
        _ => {}
    }
    wrong.extend(rest);
    wrong
}

/// Error of a text as a scene, or of the scene as a drive.
fn refused(text: &str) -> Option<SceneError> {
    match Scene::from_text(text, "spoilt.toml") {
        Ok(scene) => scene.drive().err(),
        Err(error) => Some(error),
    }
}

fn complaint(error: &SceneError) -> Option<String> {
    let told = format!("{error:#}");
    if let Some(word) = FOREIGN.iter().find(|word| told.contains(**word)) {
        return Some(format!("`{word}` in: {told}"));
    }
    let lost = |it: &&chaindrive::scene::Problem| it.path.is_empty() && it.place.is_none();
    let lost = error.problems.iter().find(lost);
    lost.map(|problem| format!("no place: {problem}"))
}

#[test]
fn no_message_about_a_scene_speaks_of_a_library() {
    let mut seeded = Seeded(20_261_127);
    let (mut wrong, mut complaints) = (0, Vec::new());
    for _ in 0..MISTAKES {
        let (name, _) = presets()[seeded.below(presets().len())];
        let sound = Scene::preset(name).unwrap();
        let mut lines: Vec<String> = sound.text().lines().map(str::to_owned).collect();
        let written: Vec<usize> = (0..lines.len())
            .filter(|&at| !lines[at].trim_start().starts_with('#') && !lines[at].trim().is_empty())
            .collect();
        let at = written[seeded.below(written.len())];
        lines[at] = spoilt(&lines[at], &mut seeded);
        let Some(error) = refused(&lines.join("\n")) else {
            continue;
        };
        wrong += 1;
        complaints.extend(complaint(&error).map(|it| format!("{name}: {}\n{it}", lines[at])));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n\n"));
    // Some keys can be missed, and other values will do as well.
    assert!(
        wrong > MISTAKES / 2,
        "only {wrong} of {MISTAKES} were mistakes"
    );
}

/// The same in JSON, whose parser has words of its own.
#[test]
fn no_message_about_json_speaks_of_a_library() {
    let mut seeded = Seeded(7);
    let json = r#"{"title": "x", "chain": {"type": "16B-1", "links": 78}, "sprockets": [{"name": "a", "teeth": 19, "centre": ["0 mm", 0]}]}"#;
    for _ in 0..MISTAKES {
        let text = misspelt(json, &mut seeded);
        if let Some(error) = refused(&text) {
            assert_eq!(complaint(&error), None, "{text}");
        }
    }
}
