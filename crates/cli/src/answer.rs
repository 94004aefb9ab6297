//! Answers of commands as JSON: one document on stdout, whose schema `chaindrive schema COMMAND` prints.

use chaindrive::plain_json;
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
    print(plain_json(
        &text.map_err(|error| Failure::Argument(error.to_string()))?,
    ))
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
