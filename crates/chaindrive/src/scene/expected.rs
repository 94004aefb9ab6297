//! Expectations of the schema of a value: the part of JSON Schema that the format's types produce.

use serde_json::{Map, Value as Json};

use chaindrive_quantities::Dimension;

/// Expectation of a schema, after references and optional wrappers.
pub(crate) enum Expectation<'s> {
    Table(&'s Json),
    List(&'s Json),
    /// The members of a family, and the kind of a table that does not name one.
    Kinds(&'s [Json], Option<&'s str>),
    Words(Vec<&'s str>),
    Quantity(&'s Json, &'static Dimension),
    Integer,
    Truth,
    Text,
    RunIn,
    Anything,
}

impl<'s> Expectation<'s> {
    /// Expectation of a schema freed of references.
    pub(crate) fn of(schema: &'s Json) -> Self {
        if let Some(name) = schema.get("x-dimension").and_then(Json::as_str)
            && let Some(dimension) = Dimension::named(name)
        {
            return Expectation::Quantity(schema, dimension);
        }
        if schema.get("x-run-in").is_some() {
            return Expectation::RunIn;
        }
        if let Some(members) = schema.get("oneOf").and_then(Json::as_array) {
            if members.iter().all(|member| kind_of(member).is_some()) {
                let unnamed = schema.get("x-default-kind").and_then(Json::as_str);
                return Expectation::Kinds(members, unnamed);
            }
            let words = members.iter().flat_map(words_of);
            return Expectation::Words(words.collect());
        }
        if schema.get("enum").is_some() {
            return Expectation::Words(words_of(schema).collect());
        }
        let kind = match schema.get("type") {
            Some(Json::Array(kinds)) => kinds
                .iter()
                .find_map(|kind| kind.as_str().filter(|k| *k != "null")),
            kind => kind.and_then(Json::as_str),
        };
        match kind {
            Some("object") => Expectation::Table(schema),
            Some("array") => Expectation::List(schema),
            Some("integer") => Expectation::Integer,
            Some("boolean") => Expectation::Truth,
            Some("string") => Expectation::Text,
            _ => Expectation::Anything,
        }
    }
}

/// A schema with its named definitions.
pub(crate) struct Reading<'s> {
    definitions: Option<&'s Map<String, Json>>,
}

impl<'s> Reading<'s> {
    pub(crate) fn new(schema: &'s Json) -> Self {
        Self {
            definitions: schema.get("$defs").and_then(Json::as_object),
        }
    }

    /// Follows references, and drops the `null` that stands for an absent key.
    pub(crate) fn core(&self, mut schema: &'s Json) -> &'s Json {
        // References do not nest deeper than this.
        for _ in 0..8 {
            let reference = schema.get("$ref").and_then(Json::as_str);
            let target = reference
                .and_then(|text| text.rsplit('/').next())
                .and_then(|name| self.definitions?.get(name));
            let choices = schema.get("anyOf").and_then(Json::as_array);
            let choice = choices.and_then(|list| list.iter().find(|s| s["type"] != "null"));
            match target.or(choice) {
                Some(next) => schema = next,
                None => break,
            }
        }
        schema
    }
}

/// The `kind` of a member of a family.
pub(crate) fn kind_of(member: &Json) -> Option<&str> {
    member
        .get("properties")?
        .get("kind")?
        .get("const")?
        .as_str()
}

fn words_of(schema: &Json) -> impl Iterator<Item = &str> {
    let listed = schema
        .get("enum")
        .and_then(Json::as_array)
        .into_iter()
        .flatten();
    listed.chain(schema.get("const")).filter_map(Json::as_str)
}

/// Advice about a key that is missing: "give the nominal pitch", "say what pushes it".
pub(crate) fn request(schema: &Json) -> Option<String> {
    let text = schema.get("description")?.as_str()?;
    let sentence = text
        .split(['.', ';', ':', ',', '('])
        .next()?
        .trim()
        .replace('\n', " ");
    let mut letters = sentence.chars();
    let first = letters.next()?.to_lowercase();
    let sentence: String = first.chain(letters).collect();
    let word = sentence.split_whitespace().next()?;
    Some(match word {
        "what" | "where" | "how" | "which" | "whether" => format!("say {sentence}"),
        "the" | "a" | "an" | "its" => format!("give {sentence}"),
        _ => format!("give the {sentence}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn requests_are_english() {
        for (description, request_) in [
            ("The chain, or the name of one.", "give the chain"),
            ("Nominal pitch [m]: what …", "give the nominal pitch [m]"),
            ("What pushes it.", "say what pushes it"),
            ("Its end (x, y) [m].", "give its end"),
        ] {
            let schema = json!({"description": description});
            assert_eq!(request(&schema).as_deref(), Some(request_));
        }
    }
}
