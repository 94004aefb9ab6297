//! A failure as JSON, for commands that are asked for JSON.

use chaindrive::scene::{Problem, SceneError};
use schemars::JsonSchema;
use serde::Serialize;

use crate::failure::Failure;

/// What stands on stderr, in one document, where a command with `--json` fails.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Complaint {
    /// The failure.
    pub(crate) error: Trouble,
}

/// Why a command did not do what was asked.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Trouble {
    /// File, scene, option or result; absent where the message names it.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    place: Option<String>,
    /// The message, as people read it.
    what: String,
    /// Exit code of the command.
    pub(crate) exit_code: u8,
    /// Mistakes in a scene or a value of it; empty for other failures.
    problems: Vec<Mistake>,
}

/// One thing to mend in a scene.
#[derive(Debug, Serialize, JsonSchema)]
struct Mistake {
    /// Place in the scene, such as `sprockets[1].teeth`; empty for the text as a whole.
    path: String,
    /// Line of the text, counted from 1; absent where an option gave the value.
    line: Option<usize>,
    /// Column, counted from 1 in characters; absent where the line is meant as a whole.
    column: Option<usize>,
    /// The mistake, with the offending value.
    what: String,
    /// The values that are allowed, or something to try.
    remedy: Option<String>,
}

impl Trouble {
    pub(crate) fn of(failure: &Failure) -> Self {
        Self {
            place: failure.place(),
            what: failure.to_string(),
            exit_code: failure.exit_code(),
            problems: failure.scene_error().map_or_else(Vec::new, mistakes),
        }
    }

    /// Arguments that the parser refuses.
    pub(crate) fn of_arguments(error: &clap::Error, exit_code: u8) -> Self {
        let text = error.to_string();
        let message = text.strip_prefix("error: ").unwrap_or(&text);
        Self {
            place: Some("arguments".to_owned()),
            what: message.trim_end().to_owned(),
            exit_code,
            problems: Vec::new(),
        }
    }
}

fn mistakes(error: &SceneError) -> Vec<Mistake> {
    let mistake = |problem: &Problem| Mistake {
        path: problem.path.clone(),
        line: problem.place.map(|place| place.line),
        column: problem
            .place
            .and_then(|place| place.columns)
            .map(|[first, _]| first),
        what: problem.message.clone(),
        remedy: problem.hint.clone(),
    };
    error.problems.iter().map(mistake).collect()
}

#[cfg(test)]
mod tests {
    use chaindrive::caught;

    use super::*;

    #[test]
    fn a_panic_is_told_as_any_failure() {
        let fault = caught(|| panic!("seven rollers")).unwrap_err();
        let trouble = Trouble::of(&Failure::Program(fault));
        assert_eq!(trouble.exit_code, 70);
        for part in [
            "please report this",
            "crates/cli/src/complaint.rs",
            "seven rollers",
        ] {
            assert!(trouble.what.contains(part), "{}", trouble.what);
        }
    }
}
