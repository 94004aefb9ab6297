//! Every number of a scene at its ends: a drive comes of it, or mistakes that are told, at once and without a panic.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::time::{Duration, Instant};

use chaindrive::scene::{Scene, SceneError, presets};
use chaindrive::{Drive, caught};
use serde_json::{Value, json};

/// Longest that anybody waits for a message.
const PATIENCE: Duration = Duration::from_secs(5);

/// Ends of counts, lengths, times and ratios.
const ENDS: [&str; 16] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2147483647",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "1e300",
    "-1e300",
    "1e-300",
    "5e-324",
    "nan",
    "inf",
    "-inf",
];

/// Paths of all numbers, those with a unit included.
fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(path.to_owned()),
        Value::String(text) if text.starts_with(|it: char| it.is_ascii_digit() || it == '-') => {
            found.push(path.to_owned());
        }
        Value::Array(items) => {
            // Tables of measured values are all alike.
            for (index, item) in items.iter().enumerate().take(3) {
                numbers(item, &format!("{path}[{index}]"), found);
            }
        }
        Value::Object(entries) => {
            let dot = if path.is_empty() { "" } else { "." };
            for (key, value) in entries {
                numbers(value, &format!("{path}{dot}{key}"), found);
            }
        }
        _ => {}
    }
}

fn drive_of(scene: Result<Scene, SceneError>) -> Result<Drive, SceneError> {
    scene?.drive()
}

/// What a scene comes to in time and without a panic; complaints otherwise.
fn judge<T>(about: &str, work: impl FnOnce() -> T, complaints: &mut Vec<String>) -> Option<T> {
    let begin = Instant::now();
    let done = caught(work);
    let taken = begin.elapsed();
    if taken > PATIENCE {
        complaints.push(format!("{about}: {:.1} s", taken.as_secs_f64()));
    }
    done.map_err(|fault| complaints.push(format!("{about}: {fault}")))
        .ok()
}

/// Of these scenes, every number at every `stride`-th of its ends; the drives are handed to `go_on`.
fn ends_of(names: &[&str], stride: usize, mut go_on: impl FnMut(&str, &Drive, &mut Vec<String>)) {
    let mut complaints = Vec::new();
    let (mut count, mut refused) = (0, 0);
    for name in names {
        let scene = Scene::preset(name).unwrap().resolved().unwrap();
        let mut paths = Vec::new();
        numbers(&scene.json(), "", &mut paths);
        for (at, path) in paths.iter().enumerate() {
            for end in ENDS.iter().skip(at % stride).step_by(stride) {
                let about = format!("{name} {path} = {end}");
                let changed = || drive_of(scene.replace(path, end));
                count += 1;
                match judge(&about, changed, &mut complaints) {
                    Some(Ok(drive)) => go_on(&about, &drive, &mut complaints),
                    Some(Err(_)) => refused += 1,
                    None => {}
                }
            }
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(refused > count / 3, "only {refused} of {count} are refused");
}

#[test]
fn a_number_at_its_end_is_told_or_taken() {
    let names = ["timing_drive", "industrial_16b", "chain_pendulum"];
    ends_of(&names, 4, |_, _, _| {});
}

/// All presets, assembled as well.
#[test]
#[ignore = "slow"]
fn every_number_at_every_end_is_told_or_taken() {
    let names: Vec<_> = presets().iter().map(|(name, _)| *name).collect();
    ends_of(&names, 1, |about, drive, complaints| {
        let stop = Instant::now() + PATIENCE;
        let assembled = || chaindrive::assemble(drive, &|| Instant::now() > stop);
        judge(about, || drop(assembled()), complaints);
    });
}

/// Two numbers of one scene at once: every pair of its counts, lengths, times and ratios, 19 329 of four scenes, each at one pair of ends.
#[test]
#[ignore = "slow"]
fn pairs_of_numbers_at_their_ends_are_told_or_taken() {
    let (mut complaints, mut count) = (Vec::new(), 0);
    for name in [
        "timing_drive",
        "two_stage_timing",
        "bicycle_derailleur",
        "marine_engine_oil",
    ] {
        let scene = Scene::preset(name).unwrap().resolved().unwrap();
        let mut paths = Vec::new();
        numbers(&scene.json(), "", &mut paths);
        for (at, first) in paths.iter().enumerate() {
            for (beside, second) in paths.iter().enumerate().skip(at + 1) {
                let ends = [at * 7 + beside, at + beside * 5].map(|it| ENDS[it % ENDS.len()]);
                let about = format!("{name} {first} = {}, {second} = {}", ends[0], ends[1]);
                let changed = || drive_of(scene.replace(first, ends[0])?.replace(second, ends[1]));
                judge(&about, changed, &mut complaints);
                count += 1;
            }
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(count > 19_000, "only {count}");
}

/// Defect: the counts of two spans were more than their type holds, and one link more than the greatest count.
#[test]
fn places_and_pitches_in_wrong_units_are_told() {
    let scene = Scene::preset("industrial_16b").unwrap();
    for far in ["1e5", "1e6", "6.1e6", "1e8", "1e12", "1e300"] {
        let drive = scene.replace_json(
            "sprockets[1].centre[0]",
            &json!(far.parse::<f64>().unwrap()),
        );
        let told = drive_of(drive).map(|drive| drive.assemble().unwrap_err().to_string());
        let told = told.unwrap_or_else(|error| error.to_string());
        assert!(
            told.contains("given in their units?") || told.contains("at most"),
            "{far}: {told}"
        );
    }
    let begin = Instant::now();
    let scene = Scene::preset("timing_drive").unwrap();
    for pitch in ["8 nm", "1.2 um", "8 um"] {
        let told = drive_of(scene.replace("chain.pitch", pitch))
            .unwrap_err()
            .to_string();
        assert!(told.contains("smaller than the pitch"), "{told}");
    }
    assert!(begin.elapsed() < Duration::from_secs(2));
}
