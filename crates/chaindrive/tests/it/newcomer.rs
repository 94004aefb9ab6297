//! Forty wrong scenes of a newcomer: each is told with its cause and a remedy, within a second, and a scene mended so is sound.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::time::{Duration, Instant};

use chaindrive::describe::warnings;
use chaindrive::{Run, Scene};
use toml_edit::{DocumentMut, Item};

/// Scenes, what is wrong in them, what is told and what mends it.
const TABLE: &str = include_str!("newcomer/scenes.toml");

/// Longest that a mistake takes to be told. Tests run beside others: it is the shortest of three that counts.
const MOST: Duration = Duration::from_secs(1);

struct Case {
    name: String,
    wrong: String,
    mended: String,
    says: Vec<String>,
    /// Whether it is told as a warning: it runs, and hardly as was meant.
    warns: bool,
}

fn texts(item: &Item) -> Vec<String> {
    let list = item.as_array().unwrap().iter();
    list.map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// A scene in which texts are replaced, each where it stands first.
fn replaced(scene: &str, changes: &Item, name: &str) -> String {
    let mut scene = scene.to_owned();
    for pair in changes.as_array().unwrap() {
        let [old, new] =
            [0, 1].map(|at| pair.as_array().unwrap().get(at).unwrap().as_str().unwrap());
        assert!(scene.contains(old), "{name}: `{old}` is not in\n{scene}");
        scene = scene.replacen(old, new, 1);
    }
    scene
}

fn cases() -> Vec<Case> {
    let table: DocumentMut = TABLE.parse().unwrap();
    let cases = table["case"].as_array_of_tables().unwrap().iter();
    let case = |case: &toml_edit::Table| {
        let [name, base] = ["name", "base"].map(|key| case[key].as_str().unwrap().to_owned());
        let own = table["base"].get(&base).and_then(Item::as_str);
        let base = own.map_or_else(
            || Scene::preset(&base).unwrap().text().to_owned(),
            str::to_owned,
        );
        let wrong = replaced(&base, &case["wrong"], &name);
        Case {
            mended: replaced(&wrong, &case["mend"], &name),
            says: texts(&case["says"]),
            warns: case.contains_key("warns"),
            wrong,
            name,
        }
    };
    cases.map(case).collect()
}

/// What `check` has to say about a scene: why it cannot run, or else what speaks against it.
fn told(text: &str) -> Result<String, String> {
    let scene = Scene::from_text(text, "scene.toml").map_err(|error| error.to_string())?;
    let drive = scene.drive().map_err(|error| error.to_string())?;
    let assembled = drive.assemble().map_err(|error| error.to_string())?;
    let run = Run::suggested(&scene.run_defaults());
    Ok(warnings(&assembled, run.until).join("\n"))
}

/// The same, and how long it takes at best.
fn told_in_time(text: &str) -> (Result<String, String>, Duration) {
    let mut best = Duration::MAX;
    loop {
        let begin = Instant::now();
        let answer = told(text);
        let took = begin.elapsed();
        if took < MOST || best < Duration::MAX {
            return (answer, best.min(took));
        }
        best = took;
    }
}

#[test]
fn forty_mistakes_are_told_with_a_remedy() {
    let cases = cases();
    assert_eq!(cases.len(), 40);
    let wrong = cases.iter().filter_map(|case| {
        let (answer, took) = told_in_time(&case.wrong);
        let (refused, answer) = match answer {
            Ok(warned) => (false, warned),
            Err(error) => (true, error),
        };
        let missing: Vec<_> = case
            .says
            .iter()
            .filter(|it| !answer.contains(*it))
            .collect();
        let good = missing.is_empty() && refused != case.warns && took < MOST;
        (!good).then(|| format!("{}: {took:?}, missing {missing:?}\n{answer}", case.name))
    });
    let wrong: Vec<_> = wrong.collect();
    assert!(
        wrong.is_empty(),
        "{} of 40:\n{}",
        wrong.len(),
        wrong.join("\n\n")
    );
}

#[test]
fn a_scene_mended_as_it_was_told_is_sound() {
    for case in cases() {
        let answer = told(&case.mended);
        assert!(answer.is_ok(), "{}: {answer:?}\n{}", case.name, case.mended);
    }
}
