//! Titles for the members of unions in the schema, by which generators of code name their classes.

use heck::ToUpperCamelCase as _;
use serde_json::{Map, Value};

/// Gives every member of a union that is not a reference a title: the name of the union, and the kind, word or form of the member,
/// such as `ElasticJohnson`, `SprocketCentreWithUnit`, `ChainWithPitch`.
pub(super) fn name_members(schema: &mut Value) {
    let title = schema.get("title").and_then(Value::as_str);
    let name = title.unwrap_or_default().to_upper_camel_case();
    name_below(schema, &name);
}

fn name_below(schema: &mut Value, name: &str) {
    let Value::Object(object) = schema else {
        return;
    };
    for (key, value) in object.iter_mut() {
        match (key.as_str(), value) {
            ("$defs", Value::Object(definitions)) => {
                for (definition, schema) in definitions {
                    name_below(schema, &definition.to_upper_camel_case());
                }
            }
            ("properties", Value::Object(properties)) => {
                for (property, schema) in properties {
                    name_below(schema, &format!("{name}{}", property.to_upper_camel_case()));
                }
            }
            ("oneOf" | "anyOf", Value::Array(members)) => {
                for member in members {
                    name_member(member, name);
                }
            }
            ("prefixItems", Value::Array(items)) => {
                for item in items {
                    name_below(item, name);
                }
            }
            ("items", items) => name_below(items, name),
            _ => {}
        }
    }
}

fn name_member(member: &mut Value, union: &str) {
    let Some(form) = member.as_object().and_then(form) else {
        return;
    };
    let title = format!("{union}{form}");
    name_below(member, &title);
    member["title"] = title.into();
}

/// What tells a member from the others; none of a reference, which has a name.
fn form(member: &Map<String, Value>) -> Option<String> {
    if member.contains_key("$ref") {
        return None;
    }
    let properties = member.get("properties");
    let kind = properties.and_then(|it| it.pointer("/kind/const"));
    if let Some(word) = kind.or(member.get("const")).and_then(Value::as_str) {
        return Some(word.to_upper_camel_case());
    }
    if properties.is_some_and(|it| it.get("unit").is_some()) {
        return Some("WithUnit".to_owned());
    }
    let required = member.get("required").and_then(|it| it[0].as_str());
    if let Some(key) = required.filter(|_| properties.is_none()) {
        return Some(format!("With{}", key.to_upper_camel_case()));
    }
    let form = match member.get("type").and_then(Value::as_str) {
        _ if member.contains_key("enum") => "Word",
        Some("array") => "List",
        Some("string") => "Text",
        Some("number" | "integer") => "Number",
        Some("boolean") => "Choice",
        _ => "Table",
    };
    Some(form.to_owned())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn judge(schema: &Value, place: &str, titles: &mut BTreeSet<String>) {
        if let Value::Object(object) = schema {
            for union in ["oneOf", "anyOf"] {
                let members = object.get(union).and_then(Value::as_array);
                for (index, member) in members.into_iter().flatten().enumerate() {
                    if member.get("$ref").is_none() {
                        let title = member["title"]
                            .as_str()
                            .unwrap_or_else(|| panic!("{place}/{index}"));
                        assert!(titles.insert(title.to_owned()), "{place}: {title} twice");
                    }
                }
            }
            for (key, value) in object {
                judge(value, &format!("{place}/{key}"), titles);
            }
        } else if let Value::Array(items) = schema {
            for item in items {
                judge(item, place, titles);
            }
        }
    }

    /// A generator that takes titles for names has to number none of them.
    #[test]
    fn every_member_of_a_union_has_a_title_of_its_own() {
        let mut titles = BTreeSet::new();
        judge(&crate::scene::schema(), "", &mut titles);
        for title in [
            "ElasticJohnson",
            "SprocketCentreWithUnit",
            "ChainWithPitch",
            "MotionOfAngleTable",
        ] {
            assert!(titles.contains(title), "{title} of {titles:?}");
        }
    }
}
