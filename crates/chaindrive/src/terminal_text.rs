//! Texts of unknown origin, as a terminal may have them.

use std::borrow::Cow;
use std::fmt::Write as _;

/// A text without characters that command a terminal or turn the order of reading: those are spelled, `\u{1b}`. Lines and tabs stay.
///
/// ```
/// assert_eq!(chaindrive::plain("chain \u{1b}[2J"), "chain \\u{1b}[2J");
/// ```
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(is_command) {
        return Cow::Borrowed(text);
    }
    let mut told = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if is_command(character) {
            let _ = write!(told, "{}", character.escape_unicode());
        } else {
            told.push(character);
        }
    }
    Cow::Owned(told)
}

/// A control character, or one that turns the order of reading.
pub(crate) fn is_command(character: char) -> bool {
    let turns = matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || character.is_control() && !matches!(character, '\n' | '\t')
}

/// A text cut to what fits in a message, on one line.
pub(crate) fn shorten(text: &str) -> String {
    let clean = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let mut short: String = clean.take(60).collect();
    if short.chars().count() < text.chars().count() {
        short.push('…');
    }
    short
}
