//! Places in a text: lines and columns, and the excerpt that shows one.

use std::fmt::Write as _;
use std::ops::Range;

use crate::plain;

/// Part of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextSpan {
    /// Line, counted from 1.
    pub line: usize,
    /// First column and the one after the last, in characters counted from 1; absent where the line is meant as a whole.
    pub columns: Option<[usize; 2]>,
}

impl TextSpan {
    /// A whole line.
    pub(crate) fn line(line: usize) -> Self {
        Self {
            line,
            columns: None,
        }
    }

    /// The line of the text with a caret under the place, two lines without an end; none where it has no columns.
    ///
    /// ```text
    ///   4 | pitch = "8.5 mmm"
    ///     |         ^^^^^^^^^
    /// ```
    pub(crate) fn excerpt(self, text: &str) -> Option<String> {
        let [first, behind] = self.columns?;
        let line = text.lines().nth(self.line - 1)?;
        // A line may hold a table of a million values: only the part around the place is looked at.
        let (first, behind) = (first - 1, behind - 1);
        let from = match line.char_indices().nth(WIDEST) {
            None => 0,
            Some(_) => first.saturating_sub(BEFORE),
        };
        let rest = line
            .char_indices()
            .nth(from)
            .map_or("", |(at, _)| &line[at..]);
        let end = rest.char_indices().nth(WIDEST).map(|(at, _)| at);
        let shown = &rest[..end.unwrap_or(rest.len())];
        let to = from + shown.chars().count();
        let first = first.min(to);
        let cut = |cut| if cut { "…" } else { "" };
        let (number, begin) = (self.line.to_string(), cut(from > 0));
        let mut excerpt = String::new();
        let shown = plain(shown).replace('\t', " ");
        let _ = writeln!(excerpt, "  {number} | {begin}{shown}{}", cut(end.is_some()));
        let margin = " ".repeat(number.len());
        let indent = " ".repeat(begin.chars().count() + first - from);
        let carets = "^".repeat(behind.min(to).saturating_sub(first).max(1));
        let _ = write!(excerpt, "  {margin} | {indent}{carets}");
        Some(excerpt)
    }
}

/// Characters of a line that are shown, and those before the place.
const WIDEST: usize = 120;
const BEFORE: usize = 30;

/// Beginnings of the lines of a text. A table of measured values may stand on one line: no place costs more for that.
pub(crate) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
    /// Bytes that go on with a character.
    further: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = std::iter::once(0).chain(breaks.map(|(at, _)| at + 1));
        let further = (0..text.len()).filter(|at| !text.is_char_boundary(*at));
        Self {
            text,
            starts: starts.collect(),
            further: further.collect(),
        }
    }

    /// Place of some bytes, as far as they stand on one line.
    pub(crate) fn at(&self, bytes: Range<usize>) -> TextSpan {
        let line = self.starts.partition_point(|&start| start <= bytes.start);
        let start = self.starts[line - 1];
        let further = |until: usize| self.further.partition_point(|&at| at < until);
        let column = |at: usize| at - start - (further(at) - further(start)) + 1;
        let behind = self.starts.get(line).copied();
        let rest = self
            .text
            .get(bytes.start..behind.unwrap_or(self.text.len()));
        let length = rest.unwrap_or_default().trim_end().len();
        let end = bytes.end.clamp(bytes.start, bytes.start + length);
        TextSpan {
            line,
            columns: Some([column(bytes.start), column(end)]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str, part: &str) -> String {
        let begin = text.find(part).unwrap();
        let place = Lines::new(text).at(begin..begin + part.len());
        place.excerpt(text).unwrap()
    }

    #[test]
    fn carets_stand_under_the_part() {
        let text = "[chain]\npitch = \"8.5 mmm\" # µ\nlinks = 4\n";
        let excerpt = "  2 | pitch = \"8.5 mmm\" # µ\n    |         ^^^^^^^^^";
        assert_eq!(shown(text, "\"8.5 mmm\""), excerpt);
        assert_eq!(shown("größe = 3", "3"), "  1 | größe = 3\n    |         ^");
    }

    #[test]
    fn what_goes_on_over_lines_is_shown_to_the_end_of_the_first() {
        let text = "a = [1,  \n 2]\n";
        assert_eq!(shown(text, "[1,  \n 2]"), "  1 | a = [1,  \n    |     ^^^");
    }

    #[test]
    fn of_long_lines_the_part_around_the_place_is_shown() {
        let text = format!(
            "values = [{}oops, {}]",
            "0, ".repeat(500),
            "1, ".repeat(500)
        );
        let excerpt = shown(&text, "oops");
        let lines: Vec<&str> = excerpt.lines().collect();
        assert!(
            lines.iter().all(|line| line.chars().count() < 140),
            "{excerpt}"
        );
        let column = |line: &str, what| line[..line.find(what).unwrap()].chars().count();
        assert_eq!(column(lines[0], "oops"), column(lines[1], "^^^^"));
    }

    #[test]
    fn characters_that_command_a_terminal_are_spelled() {
        assert!(!shown("a = \"\u{1b}[2J\"", "a").contains('\u{1b}'));
    }
}
