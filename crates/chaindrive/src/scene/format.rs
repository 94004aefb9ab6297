//! The scene format as a JSON Schema.

use std::sync::LazyLock;

use serde_json::{Map, Value, json};

use super::defaults;
use super::schema::SceneText;
use super::titles;
use crate::laws;

/// JSON Schema of the scene format (draft 2020-12), for editors and front ends.
///
/// Quantities carry their dimension as `x-dimension` and their SI unit as `x-unit`. The file
/// `chaindrive.schema.json` is this value.
pub fn schema() -> Value {
    let mut schema = raw().clone();
    defaults::put_into(&mut schema);
    for_editors(&mut schema);
    let chain = &mut schema["properties"]["chain"];
    *chain = json!({
        "description": chain["description"],
        "anyOf": [{"type": "string", "examples": ["16B-1"]}, {"$ref": chain["$ref"]}],
    });
    titles::name_members(&mut schema);
    schema
}

/// The schema as derived, which the validator walks. Derived once: it takes longer than to read a scene.
pub(crate) fn raw() -> &'static Value {
    static RAW: LazyLock<Value> = LazyLock::new(|| {
        let mut schema = schemars::schema_for!(SceneText).to_value();
        laws::put_into(&mut schema);
        plain_brackets(&mut schema);
        schema
    });
    &RAW
}

/// Documentation of Rust writes `\[m\]` where a link is not meant.
fn plain_brackets(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            for (key, value) in object {
                match value {
                    Value::String(text) if key == "description" => {
                        *text = text.replace("\\[", "[").replace("\\]", "]");
                    }
                    value => plain_brackets(value),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(plain_brackets),
        _ => {}
    }
}

/// Brings the schema to what the validator accepts: no `null`, and short forms allowed.
fn for_editors(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            // First, since keys stand there that mean something else in a schema.
            require_unless(object);
            for value in object.values_mut() {
                for_editors(value);
            }
            drop_null(object);
            allow_missing_kind(object);
            allow_bare_kinds(object);
            allow_common_unit(object);
        }
        Value::Array(items) => items.iter_mut().for_each(for_editors),
        _ => {}
    }
}

fn drop_null(object: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            object.insert("type".into(), only);
        }
    }
    let says_nothing = |default: &Value| match default {
        Value::Null => true,
        Value::Object(table) => !table.contains_key("kind"),
        Value::Array(items) => items.is_empty(),
        _ => false,
    };
    if object.get("default").is_some_and(says_nothing) {
        object.remove("default");
    }
    if let Some(Value::Array(choices)) = object.get_mut("anyOf") {
        choices.retain(|choice| *choice != json!({"type": "null"}));
        if let [Value::Object(only)] = choices.as_slice() {
            let only = only.clone();
            object.remove("anyOf");
            for (key, value) in only {
                object.entry(key).or_insert(value);
            }
        }
    }
}

/// Some keys are required unless another one is there.
fn require_unless(object: &mut Map<String, Value>) {
    if let Some(Value::Object(unless)) = object.shift_remove("x-required-unless") {
        let choices = unless
            .into_iter()
            .flat_map(|(key, keys)| [json!({"required": [key]}), json!({"required": keys})]);
        object.insert("anyOf".into(), choices.collect());
    }
}

/// A table without `kind` may be one of the members.
fn allow_missing_kind(object: &mut Map<String, Value>) {
    let Some(kind) = object.remove("x-default-kind") else {
        return;
    };
    let members = object.get_mut("oneOf").and_then(Value::as_array_mut);
    for member in members.into_iter().flatten() {
        if member["properties"]["kind"]["const"] == kind
            && let Some(Value::Array(required)) = member.get_mut("required")
        {
            required.retain(|key| key != "kind");
        }
    }
}

/// `{ kind = "fixed" }` may be written `"fixed"`.
fn allow_bare_kinds(object: &mut Map<String, Value>) {
    let Some(Value::Array(members)) = object.get_mut("oneOf") else {
        return;
    };
    let bare: Vec<Value> = members
        .iter()
        .filter(|member| member["required"] == json!(["kind"]))
        .map(|member| member["properties"]["kind"]["const"].clone())
        .collect();
    if !bare.is_empty() {
        members.push(json!({
            "description": "A kind without further keys may be written as its bare name.",
            "enum": bare,
        }));
    }
}

/// `["1 ms", "2 ms"]` may be written `{ unit = "ms", values = [1, 2] }`.
fn allow_common_unit(object: &mut Map<String, Value>) {
    if object.get("type") != Some(&json!("array"))
        || object
            .get("items")
            .and_then(|items| items.get("x-dimension"))
            .is_none()
    {
        return;
    }
    let description = object.remove("description");
    let list = Value::Object(std::mem::take(object));
    let mut values = list.clone();
    values["items"] = json!({"type": "number"});
    if let Some(description) = description {
        object.insert("description".into(), description);
    }
    object.insert(
        "anyOf".into(),
        json!([list, {
            "type": "object",
            "properties": {"unit": {"type": "string"}, "values": values},
            "required": ["unit", "values"],
            "additionalProperties": false,
        }]),
    );
}
