//! Scenes with one mistake each: what is replaced, and the problem that must be told.

use chaindrive::scene::{Problem, Scene, SceneError};

/// The text that is replaced, its replacement, and the path, line and message of the problem that must follow.
pub(crate) type Mistake = (
    &'static str,
    &'static str,
    &'static str,
    usize,
    &'static str,
);

/// The problems of a text that is no drive.
#[track_caller]
pub(crate) fn fails(text: &str) -> SceneError {
    match Scene::from_text(text, "test.toml").and_then(|scene| scene.drive()) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error,
    }
}

/// Makes every mistake in a good scene. Its problem must be among those told, its path being one that `is_at` takes for the
/// expected one, and there must be no more than `most` of them.
#[track_caller]
pub(crate) fn all_found(
    good: &str,
    mistakes: &[Mistake],
    is_at: fn(&str, &str) -> bool,
    most: usize,
) {
    let mut wrong = Vec::new();
    for (old, new, path, line, fragment) in mistakes {
        assert!(good.contains(old), "{old} is not in the scene");
        let error = fails(&good.replacen(old, new, 1));
        let hit = |problem: &Problem| {
            is_at(&problem.path, path)
                && problem.place.map(|place| place.line) == Some(*line)
                && problem.to_string().contains(fragment)
        };
        if !error.problems.iter().any(hit) || error.problems.len() > most {
            wrong.push(format!(
                "{new}: expected {line}: {path}: {fragment}\n{error}"
            ));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {}:\n{}",
        wrong.len(),
        mistakes.len(),
        wrong.join("\n\n")
    );
}
