//! Mistakes in a scene, and their places.

use std::fmt;

use crate::plain;

/// One thing to mend in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Place in the scene, such as `sprockets[1].teeth`; empty for the text as a whole.
    pub path: String,
    /// Line of the text, counted from 1; absent in JSON, which carries no lines.
    pub line: Option<usize>,
    /// The mistake, with the offending value.
    pub message: String,
    /// The values that are allowed, or something to try.
    pub hint: Option<String>,
}

impl Problem {
    pub(crate) fn new(path: &str, line: Option<usize>, message: impl Into<String>) -> Self {
        Self {
            path: plain(path).into_owned(),
            line,
            message: plain(&message.into()).into_owned(),
            hint: None,
        }
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(plain(&hint.into()).into_owned());
        self
    }
}

/// `12: sprockets[1].teeth: …; …`, without the name of the source.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "{line}: ")?;
        }
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)?;
        match &self.hint {
            Some(hint) => write!(f, "; {hint}"),
            None => Ok(()),
        }
    }
}

/// Problems that are kept: more than anybody mends at once.
const MOST: usize = 100;

/// Problems as they are found: the first ones, and the number of the rest.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    kept: Vec<Problem>,
    found: usize,
}

impl Problems {
    pub(crate) fn push(&mut self, problem: Problem) {
        self.push_with(|| problem);
    }

    /// Counts a problem, and makes it only if it will be kept.
    pub(crate) fn push_with(&mut self, problem: impl FnOnce() -> Problem) {
        self.found += 1;
        if self.kept.len() < MOST {
            self.kept.push(problem());
        }
    }

    /// Number of problems found.
    pub(crate) fn count(&self) -> usize {
        self.found
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.found == 0
    }

    /// Whether a problem of this place is kept.
    pub(crate) fn speak_of(&self, path: &str) -> bool {
        self.kept.iter().any(|problem| problem.path == path)
    }

    /// The error of a text of this name.
    pub(crate) fn of(self, source_name: &str) -> SceneError {
        let omitted = self.found - self.kept.len();
        SceneError {
            omitted,
            ..SceneError::new(source_name, self.kept)
        }
    }
}

/// Why a text is not a scene, or a scene not a drive: every problem found, in the order of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// Name of the text: a file, a preset, or whatever the caller called it.
    pub source_name: String,
    /// The problems; at least one, and at most a hundred.
    pub problems: Vec<Problem>,
    /// Number of further problems.
    pub omitted: usize,
}

impl SceneError {
    pub(crate) fn new(source_name: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.line);
        Self {
            source_name: plain(source_name).into_owned(),
            problems,
            omitted: 0,
        }
    }
}

/// One line a problem: `marine.toml:12: sprockets[1].teeth: 2, must be at least 5`.
impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            let end_of_last = if i == 0 { "" } else { "\n" };
            let gap = if problem.line.is_some() { "" } else { " " };
            write!(f, "{end_of_last}{}:{gap}{problem}", self.source_name)?;
        }
        match self.omitted {
            0 => Ok(()),
            1 => write!(f, "\n{}: and 1 more problem", self.source_name),
            more => write!(f, "\n{}: and {more} more problems", self.source_name),
        }
    }
}

impl std::error::Error for SceneError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_like_a_compiler() {
        let error = SceneError::new(
            "marine.toml",
            vec![
                Problem::new("chain", None, "missing"),
                Problem::new("sprockets[1].teeth", Some(12), "2, must be at least 5").hint("try 6"),
            ],
        );
        let text = "marine.toml: chain: missing\n\
                    marine.toml:12: sprockets[1].teeth: 2, must be at least 5; try 6";
        assert_eq!(error.to_string(), text);
    }
}
