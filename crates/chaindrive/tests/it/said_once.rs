//! Unit, range and default of a key: its sentence does not say what its schema says already, or says otherwise.

use chaindrive::scene::schema;
use serde_json::Value;

/// Words of a range. Sentences that have them speak of another key, or of a sign convention.
const RANGES: [&str; 7] = [
    "not negative",
    "positive",
    "zero or",
    "at least",
    "at most",
    "more than",
    "less than",
];

/// Sentences with such words that are no range: directions and other keys.
const OTHER: [&str; 4] = [
    "clockwise positive",
    "positive where it turns left",
    "at least μ_",
    "at least that of the roller",
];

fn problems(node: &Value, path: &str, found: &mut Vec<String>) {
    match node {
        Value::Object(entries) => {
            if let (Some(unit), Some(sentence)) = (
                node.get("x-unit").and_then(Value::as_str),
                node.get("description").and_then(Value::as_str),
            ) {
                found.extend(judge(node, unit, sentence).map(|it| format!("{path}: {it}")));
            }
            for (key, entry) in entries {
                problems(entry, &format!("{path}/{key}"), found);
            }
        }
        Value::Array(entries) => {
            for (index, entry) in entries.iter().enumerate() {
                problems(entry, &format!("{path}/{index}"), found);
            }
        }
        _ => {}
    }
}

fn judge(node: &Value, unit: &str, sentence: &str) -> Option<String> {
    let bracket = sentence
        .split_once('[')
        .and_then(|(_, rest)| rest.split_once(']'));
    if let Some((written, _)) = bracket {
        let plain = written.replace('²', "^2").replace('³', "^3");
        let plain = plain.replace('–', "1").replace('ⁿ', "^n");
        if plain != unit {
            return Some(format!(
                "the sentence has [{written}], the key is in {unit}"
            ));
        }
    }
    let ranged = RANGES.iter().find(|word| sentence.contains(**word));
    if let Some(word) = ranged
        && !OTHER.iter().any(|other| sentence.contains(other))
    {
        return Some(format!("`{word}` is the range: {sentence}"));
    }
    let default = node.get("x-defaults").is_some() || node.get("default").is_some();
    let absent = sentence.split_once("absent: ").map(|(_, rest)| rest);
    let number = absent.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    (default && number).then(|| format!("the default is said twice: {sentence}"))
}

#[test]
fn a_key_is_described_once() {
    let mut found = Vec::new();
    problems(&schema(), "", &mut found);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn what_is_said_twice_is_found() {
    let key = |sentence: &str| serde_json::json!({"x-unit": "N/m", "description": sentence, "default": 0.0, "minimum": 0});
    for (sentence, fine) in [
        ("Spring rate [N/m].", true),
        ("Spring rate.", true),
        ("Spring rate [N m/rad].", false),
        ("Spring rate [N/m], not negative.", false),
        ("Spring rate [N/m]; absent: 0.", false),
        ("Spring rate [N/m]; absent: that of a link.", true),
    ] {
        let mut found = Vec::new();
        problems(&key(sentence), "", &mut found);
        assert_eq!(found.is_empty(), fine, "{sentence}: {found:?}");
    }
}
