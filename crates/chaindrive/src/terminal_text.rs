//! Texts of unknown origin, as terminals, tables and pages may have them: the one place that says what they may hold.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Characters of a text that a message shows.
const MOST_SHOWN: usize = 60;

/// A text without characters that command a terminal, are not seen or turn the order of reading: those are spelled, `\u{1b}`. Lines and
/// tabs stay.
///
/// ```
/// assert_eq!(chaindrive::plain("chain \u{1b}[2J"), "chain \\u{1b}[2J");
/// ```
pub fn plain(text: &str) -> Cow<'_, str> {
    spelled(text, is_command)
}

/// The same without lines and tabs: what somebody else named is on the line of ours that names it.
///
/// ```
/// assert_eq!(chaindrive::one_line("crank\nverdict: trusted"), "crank\\nverdict: trusted");
/// ```
pub fn one_line(text: &str) -> Cow<'_, str> {
    spelled(text, is_strange)
}

/// A text as a cell of CSV: on one line, and nothing that a spreadsheet takes for a formula. Numbers stay as they are.
///
/// ```
/// assert_eq!(chaindrive::cell("=1+1"), "'=1+1");
/// assert_eq!(chaindrive::cell("-1.5"), "-1.5");
/// ```
pub fn cell(text: &str) -> Cow<'_, str> {
    let text = one_line(text);
    if text.starts_with(['=', '+', '-', '@']) && text.parse::<f64>().is_err() {
        return Cow::Owned(format!("'{text}"));
    }
    text
}

/// JSON in which such characters are spelled as JSON spells them.
pub fn plain_json(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        if is_command(character) {
            for unit in character.encode_utf16(&mut [0; 2]) {
                let _ = write!(text, "\\u{unit:04x}");
            }
        } else {
            text.push(character);
        }
    }
    text
}

fn spelled(text: &str, strange: fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(strange) {
        return Cow::Borrowed(text);
    }
    let mut told = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        match character {
            '\n' | '\t' if strange(character) => {
                told.extend(character.escape_default());
            }
            _ if strange(character) => told.extend(character.escape_unicode()),
            _ => told.push(character),
        }
    }
    Cow::Owned(told)
}

/// A control character, or one that is not seen, parts lines or turns the order of reading. Lines and tabs are ours.
pub(crate) fn is_command(character: char) -> bool {
    let unseen = matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}'
    );
    unseen || character.is_control() && !matches!(character, '\n' | '\t')
}

/// The same, and lines and tabs: what no name has.
pub(crate) fn is_strange(character: char) -> bool {
    is_command(character) || matches!(character, '\n' | '\t')
}

/// Nothing but letters, digits, signs and spaces of ASCII: most texts, told apart at once.
pub(crate) fn is_plain(text: &str) -> bool {
    text.bytes().all(|byte| (b' '..=b'~').contains(&byte))
}

/// A text cut to what fits in a message, on one line.
pub(crate) fn shorten(text: &str) -> String {
    if text.len() <= MOST_SHOWN && is_plain(text) {
        return text.to_owned();
    }
    let clean = text.chars().map(|c| if is_strange(c) { ' ' } else { c });
    let mut short: String = clean.take(MOST_SHOWN).collect();
    if short.chars().count() < text.chars().count() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What joins letters, what parts lines without a line feed, what carries words that nobody sees.
    #[test]
    fn what_is_not_seen_is_spelled() {
        for strange in [
            "\u{200d}",
            "\u{2028}",
            "\u{e0041}",
            "\u{85}",
            "\u{7f}",
            "\u{feff}",
        ] {
            let told = plain(strange);
            assert!(told.is_ascii(), "{told}");
            let json = plain_json(&format!("\"{strange}\""));
            assert!(json.is_ascii(), "{json}");
            assert_eq!(
                serde_json::from_str::<String>(&json).ok().as_deref(),
                Some(strange)
            );
        }
        assert_eq!(plain("Kette µ\n\tü"), "Kette µ\n\tü");
        assert_eq!(one_line("a\tb\nc"), "a\\tb\\nc");
        assert_eq!(
            [cell("+x"), cell("-3e-5"), cell("-inf"), cell("@a\nb")],
            ["'+x", "-3e-5", "-inf", "'@a\\nb"]
        );
    }
}
