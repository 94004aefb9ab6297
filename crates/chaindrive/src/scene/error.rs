//! Mistakes in a scene, and their places.

use std::fmt;

use super::text_span::TextSpan;
use crate::one_line;

/// One thing to mend in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Place in the scene, such as `sprockets[1].teeth`; empty for the text as a whole.
    pub path: String,
    /// Place in the text; absent where an option, an argument or a program gave the value.
    pub place: Option<TextSpan>,
    /// The mistake, with the offending value.
    pub message: String,
    /// The values that are allowed, or something to try.
    pub hint: Option<String>,
    /// The line of the text with a caret under the place, two lines; absent without a place.
    pub excerpt: Option<Box<str>>,
}

impl Problem {
    pub(crate) fn new(path: &str, place: Option<TextSpan>, message: impl Into<String>) -> Self {
        Self {
            path: one_line(path).into_owned(),
            place,
            message: one_line(&message.into()).into_owned(),
            hint: None,
            excerpt: None,
        }
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(one_line(&hint.into()).into_owned());
        self
    }
}

/// `12:9: sprockets[1].teeth: …; …`, without the name of the source; in the alternate form, `{:#}`, with the excerpt below.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.tell(f, self.hint.as_deref())
    }
}

impl Problem {
    fn tell(&self, f: &mut fmt::Formatter<'_>, hint: Option<&str>) -> fmt::Result {
        match self.place {
            Some(TextSpan {
                line,
                columns: Some([first, _]),
            }) => write!(f, "{line}:{first}: ")?,
            Some(TextSpan { line, .. }) => write!(f, "{line}: ")?,
            None => {}
        }
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)?;
        if let Some(hint) = hint {
            write!(f, "; {hint}")?;
        }
        match self.excerpt.as_ref().filter(|_| f.alternate()) {
            Some(excerpt) => write!(f, "\n{excerpt}"),
            None => Ok(()),
        }
    }
}

/// Problems that are kept: more than anybody mends at once.
const MOST: usize = 100;

/// Problems that a message tells: what fits on a screen.
const TOLD: usize = 10;

/// Hints from this length on are told once, such as all keys of a table \[bytes\].
const LONG: usize = 60;

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

    /// Whether a problem at this path is kept.
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
        problems.sort_by_key(|problem| problem.place);
        Self {
            source_name: one_line(source_name).into_owned(),
            problems,
            omitted: 0,
        }
    }

    /// With the excerpts of the text that the places belong to.
    pub(crate) fn within(mut self, text: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        for problem in &mut self.problems {
            let excerpt = problem.place.and_then(|place| place.excerpt(text));
            problem.excerpt = excerpt.map(String::into_boxed_str);
        }
        self
    }

    /// The same mistakes in a value that stands in no text, since an option or argument gave it.
    #[must_use]
    pub fn nowhere(mut self) -> Self {
        for problem in &mut self.problems {
            (problem.place, problem.excerpt) = (None, None);
        }
        self
    }
}

/// One line a problem: `marine.toml:12:9: sprockets[1].teeth: 2, must be at least 5`; in the alternate form, `{:#}`, with excerpts.
/// Ten of them, then the number of the others; a hint that stands above already is left out.
impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = &self.problems[..self.problems.len().min(TOLD)];
        for (i, problem) in told.iter().enumerate() {
            let end_of_last = if i == 0 { "" } else { "\n" };
            let gap = if problem.place.is_some() { "" } else { " " };
            write!(f, "{end_of_last}{}:{gap}", self.source_name)?;
            let given = |hint: &&str| told[..i].iter().any(|it| it.hint.as_deref() == Some(hint));
            let hint = problem.hint.as_deref();
            problem.tell(f, hint.filter(|it| it.len() < LONG || !given(it)))?;
        }
        match self.problems.len() - told.len() + self.omitted {
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
        let teeth = TextSpan {
            line: 2,
            columns: Some([9, 10]),
        };
        let error = SceneError::new(
            "marine.toml",
            vec![
                Problem::new("chain", None, "missing"),
                Problem::new("sprockets[1].teeth", Some(teeth), "2, must be at least 5")
                    .hint("try 6"),
            ],
        );
        let text = "marine.toml: chain: missing\n\
                    marine.toml:2:9: sprockets[1].teeth: 2, must be at least 5; try 6";
        assert_eq!(error.to_string(), text);
        let error = error.within("[[sprockets]]\nteeth = 2\n");
        assert_eq!(error.to_string(), text);
        let excerpt = "\n  2 | teeth = 2\n    |         ^";
        assert_eq!(format!("{error:#}"), format!("{text}{excerpt}"));
    }
}
