//! Limits on the size of a scene, checked before its text is parsed.
//!
//! A tree is built, copied and dropped by recursion, and every value of a text takes some hundred bytes
//! on the way to a drive. Both are therefore bounded by counting, before anything is built.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

use super::error::Problem;
use super::path::steps;
use super::text_span::TextSpan;

/// Largest text \[bytes\] that is read: room for the tables of a measured drive, not for a film.
const LARGEST: u64 = 16 << 20;

/// Deepest nesting of tables and lists. The format itself needs eight levels.
const DEEPEST: usize = 32;

/// Most values of a text: a table of half a million pairs.
const MOST_VALUES: usize = 1_000_000;

/// Reads a file of text of at most 16 MiB, which is no scene.
///
/// # Errors
/// Why it cannot be read, without its name.
pub fn read_file(path: &Path) -> Result<String, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    read_text(file, "the file").map_err(|problem| problem.message)
}

/// Reads a text of at most [`LARGEST`] bytes; `what` is what messages call its source.
pub(crate) fn read_text(source: impl Read, what: &str) -> Result<String, Problem> {
    let refuse = |message: String| Problem::new("", None, message);
    let mut bytes = Vec::new();
    source
        .take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| refuse(format!("{what} cannot be read: {error}")))?;
    if bytes.len() as u64 > LARGEST {
        let message = format!("{what} is larger than {} MiB", LARGEST >> 20);
        return Err(refuse(message).hint("a scene is a text of TOML or JSON"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        refuse(format!("{what} is not a text: byte {at} is not UTF-8"))
            .hint("a scene is TOML or JSON in UTF-8")
    })
}

/// Refuses TOML that nests too deeply or has too many values.
///
/// Dots count like brackets: `a.b.c = 1` nests as `{ a = { b = { c = 1 } } }` does. So do the points of
/// numbers, one a value.
pub(crate) fn check_toml(text: &str) -> Result<(), Problem> {
    let (mut brackets, mut dots, mut values, mut line) = (0_usize, 0_usize, 0_usize, 1_usize);
    for token in Source::new(text).lex() {
        match token.kind() {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => brackets += 1,
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                brackets = brackets.saturating_sub(1);
                dots = 0;
            }
            TokenKind::Dot => dots += 1,
            TokenKind::Comma | TokenKind::Equals => {
                values += 1;
                dots = 0;
            }
            TokenKind::Newline => {
                line += 1;
                dots = 0;
            }
            TokenKind::MlBasicString | TokenKind::MlLiteralString => {
                let span = token.span();
                let inside = text.get(span.start()..span.end()).unwrap_or_default();
                line += inside.matches('\n').count();
            }
            _ => {}
        }
        if brackets + dots > DEEPEST {
            return Err(too_deep("", Some(TextSpan::line(line))));
        }
        if values > MOST_VALUES {
            return Err(too_many(Some(TextSpan::line(line))));
        }
    }
    Ok(())
}

/// Refuses JSON with too many values; its parser bounds the depth.
pub(crate) fn check_json(text: &str) -> Result<(), Problem> {
    // Commas within texts count too: no scene writes a million of them.
    if text.bytes().filter(|byte| *byte == b',').count() > MOST_VALUES {
        return Err(too_many(None));
    }
    Ok(())
}

/// Refuses a dotted path of too many steps.
pub(crate) fn check_path(path: &str) -> Result<(), Problem> {
    let count = steps(path).take(DEEPEST + 1).count();
    if count <= DEEPEST {
        return Ok(());
    }
    let begin: Vec<String> = steps(path).take(3).collect();
    Err(too_deep(&format!("{}…", begin.join(".")), None))
}

pub(crate) fn too_deep(path: &str, place: Option<TextSpan>) -> Problem {
    let message = format!("nested deeper than {DEEPEST} levels");
    Problem::new(path, place, message).hint("no key of a scene lies that deep")
}

fn too_many(place: Option<TextSpan>) -> Problem {
    let message = format!("more than {MOST_VALUES} values");
    Problem::new("", place, message).hint("give tables and measured profiles with fewer points")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_counted_in_brackets_and_dots() {
        let deep = |n: usize| "a.".repeat(n);
        for text in [
            format!("{}x = 1", deep(40)),
            format!("[{}x]", deep(40)),
            format!("x = {}1{}", "[".repeat(40), "]".repeat(40)),
            format!("x = {}1{}", "{ a = ".repeat(40), "}".repeat(40)),
            format!("\n\n\nx = [[[[[{{ {}x = 1 }}]]]]]", deep(28)),
        ] {
            let problem = check_toml(&text).unwrap_err();
            assert!(problem.to_string().contains("nested deeper"), "{text}");
            let line = problem.place.map(|place| place.line);
            assert_eq!(line, Some(1 + text.matches('\n').count()));
        }
        let flat = "x = [".to_owned() + &"[1.5, 2.5], ".repeat(1000) + "]\n# " + &deep(99);
        check_toml(&flat).unwrap();
        check_toml(&format!("x = '''\n{}\n'''", deep(99))).unwrap();
    }

    #[test]
    fn values_are_counted() {
        let long = |n: usize| format!("x = [{}1]", "0,".repeat(n));
        check_toml(&long(1000)).unwrap();
        assert!(check_toml(&long(MOST_VALUES)).is_err());
        assert!(check_json(&long(MOST_VALUES + 1)).is_err());
    }

    #[test]
    fn paths_are_bounded() {
        check_path("sprockets[1].contact.friction.coefficient").unwrap();
        let problem = check_path(&"a.".repeat(15_000)).unwrap_err();
        assert!(problem.to_string().len() < 200, "{problem}");
    }
}
