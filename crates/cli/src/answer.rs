//! Answers of commands as JSON: one document on stdout, whose schema `chaindrive schema COMMAND` prints.

use std::fmt::Write as _;

use chaindrive::plain;
use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::terminal::print;

/// Prints an answer and nothing else.
pub(crate) fn answer(document: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(document);
    print(spelled(
        &text.map_err(|error| Failure::Argument(error.to_string()))?,
    ))
}

/// JSON in which characters that command a terminal are spelled as JSON spells them.
pub(crate) fn spelled(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        let mut bytes = [0; 4];
        let one: &str = character.encode_utf8(&mut bytes);
        if plain(one) == one {
            text.push(character);
        } else {
            let _ = write!(text, "\\u{:04x}", u32::from(character));
        }
    }
    text
}

/// JSON Schema of an answer (draft 2020-12).
pub(crate) fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    RecursiveTransform(plain_brackets).transform(&mut schema);
    schema.to_value()
}

/// Documentation of Rust writes `\[m\]` where a link is not meant.
fn plain_brackets(schema: &mut Schema) {
    if let Some(Value::String(text)) = schema.get_mut("description") {
        *text = text.replace("\\[", "[").replace("\\]", "]");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_of_an_answer_commands_a_terminal() {
        let title = "\u{1b}[2J \u{202e} µ\n";
        let text = spelled(&serde_json::to_string(title).unwrap());
        assert_eq!(plain(&text), text);
        assert_eq!(serde_json::from_str::<String>(&text).unwrap(), title);
    }
}
