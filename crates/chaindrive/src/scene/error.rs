//! What is wrong with a scene, and where.

use std::fmt;

/// One thing to mend in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Place in the scene, such as `sprockets[1].teeth`; empty for the text as a whole.
    pub path: String,
    /// Line of the text, counted from 1; absent in JSON, which carries no lines.
    pub line: Option<usize>,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What is allowed, or what to try.
    pub hint: Option<String>,
}

impl Problem {
    pub(crate) fn new(path: &str, line: Option<usize>, message: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            line,
            message: message.into(),
            hint: None,
        }
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
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

/// Why a text is not a scene, or a scene not a drive: every problem found, in the order of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// Name of the text: a file, a preset, or whatever the caller called it.
    pub source_name: String,
    /// The problems; at least one.
    pub problems: Vec<Problem>,
}

impl SceneError {
    pub(crate) fn new(source_name: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.line);
        Self {
            source_name: source_name.to_owned(),
            problems,
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
        Ok(())
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
