//! A scene as a tree of values that know their place, whichever language it was written in.

use serde_json::Value as Json;
use toml_edit::{Item, TableLike, Value as Toml};

use super::error::Problem;
use super::limits;
use super::path::{push_step, steps};
use super::text_span::{Lines, TextSpan};
use crate::terminal_text::{is_plain, is_strange, shorten};

/// A value and its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) place: Option<TextSpan>,
    pub(crate) value: Value,
}

/// Kinds of values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Truth(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    Table(Vec<Entry>),
    /// A date, which no key of a scene takes.
    Date,
}

/// One key of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) place: Option<TextSpan>,
    pub(crate) node: Node,
}

impl Value {
    /// Its type, as messages call it.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Truth(_) => "true or false",
            Self::Integer(_) => "a whole number",
            Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Date => "a date",
        }
    }
}

impl Node {
    /// Texts and keys with control characters and the like. Scenes come from anywhere, and messages, results and drawings show their texts.
    pub(crate) fn control_characters(&self) -> Vec<Problem> {
        let mut found = Vec::new();
        self.find_control_characters("", &mut found);
        found
    }

    fn find_control_characters(&self, path: &str, found: &mut Vec<Problem>) {
        let speaks = |text: &str| !is_plain(text) && text.contains(is_strange);
        let problem = |path: &str, place: Option<TextSpan>, what: &str, text: &str| {
            let message = format!(
                "{what} \"{}\" has control characters, line feeds, tabs or characters that are not seen",
                shorten(text)
            );
            Problem::new(path, place, message).hint("leave them out")
        };
        match &self.value {
            Value::Text(text) if speaks(text) => {
                found.push(problem(path, self.place, "the text", text));
            }
            Value::List(items) => {
                for (index, item) in items.iter().enumerate() {
                    item.find_control_characters(&format!("{path}[{index}]"), found);
                }
            }
            Value::Table(entries) => {
                for entry in entries {
                    if speaks(&entry.key) {
                        found.push(problem(path, entry.place, "the key", &entry.key));
                    }
                    let dot = if path.is_empty() { "" } else { "." };
                    let within = format!("{path}{dot}{}", entry.key);
                    entry.node.find_control_characters(&within, found);
                }
            }
            _ => {}
        }
    }

    /// Parses TOML, or JSON when the text begins with `{`.
    pub(crate) fn parse(text: &str) -> Result<Self, Problem> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if is_json(text) {
            Self::parse_json(text)
        } else {
            Self::parse_toml(text)
        }
    }

    /// Parses TOML.
    pub(crate) fn parse_toml(text: &str) -> Result<Self, Problem> {
        limits::check_toml(text)?;
        let lines = Lines::new(text);
        let document = toml_edit::Document::parse(text).map_err(|error| {
            let place = error.span().map(|span| lines.at(span));
            Problem::new(
                "",
                place,
                format!("not TOML: {}", one_line(error.message())),
            )
        })?;
        Ok(lines.table(document.as_table(), Some(TextSpan::line(1))))
    }

    /// Parses JSON.
    pub(crate) fn parse_json(text: &str) -> Result<Self, Problem> {
        limits::check_json(text)?;
        let json: Json = serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let (line, column) = (error.line(), error.column());
            if message.starts_with("recursion limit") {
                return limits::too_deep("", Some(TextSpan::line(line)));
            }
            let message = message.split(" at line").next().unwrap_or_default();
            let columns = (column > 0).then_some([column, column + 1]);
            let place = TextSpan { line, columns };
            Problem::new("", Some(place), format!("not JSON: {message}"))
        })?;
        let mut tree = Self::from_json(&json);
        Lines::new(text).place_json(&mut tree, text)?;
        Ok(tree)
    }

    /// The tree of a JSON value; entries that are `null` count as absent.
    pub(crate) fn from_json(json: &Json) -> Self {
        let value = match json {
            // Only at the top and in lists; the validator refuses it there.
            Json::Null => Value::Text("null".into()),
            Json::Bool(truth) => Value::Truth(*truth),
            Json::Number(number) => number.as_i64().map_or_else(
                || Value::Float(number.as_f64().unwrap_or(f64::NAN)),
                Value::Integer,
            ),
            Json::String(text) => Value::Text(text.clone()),
            Json::Array(items) => Value::List(items.iter().map(Self::from_json).collect()),
            Json::Object(entries) => {
                let entries = entries.iter().filter(|(_, json)| !json.is_null());
                let entry = |(key, json): (&String, &Json)| Entry {
                    key: key.clone(),
                    place: None,
                    node: Self::from_json(json),
                };
                Value::Table(entries.map(entry).collect())
            }
        };
        Self { place: None, value }
    }

    /// As JSON, for serde. Numbers that are not finite become `null`; the validator has refused them.
    pub(crate) fn to_json(&self) -> Json {
        match &self.value {
            Value::Truth(truth) => Json::Bool(*truth),
            Value::Integer(number) => Json::from(*number),
            Value::Float(number) => Json::from(*number),
            Value::Text(text) => Json::String(text.clone()),
            Value::List(items) => Json::Array(items.iter().map(Self::to_json).collect()),
            Value::Table(entries) => {
                let entries = entries.iter().map(|e| (e.key.clone(), e.node.to_json()));
                Json::Object(entries.collect())
            }
            Value::Date => Json::Null,
        }
    }

    /// `chain = "16B-1"` becomes a table with this `type`.
    pub(crate) fn expand_chain(&mut self) {
        let Value::Table(entries) = &mut self.value else {
            return;
        };
        for entry in entries.iter_mut().filter(|entry| entry.key == "chain") {
            if let Value::Text(_) = entry.node.value {
                let named = Entry {
                    key: "type".into(),
                    place: entry.place,
                    node: entry.node.clone(),
                };
                entry.node.value = Value::Table(vec![named]);
            }
        }
    }

    /// A quantity as it was written, with its unit.
    pub(crate) fn written(&self) -> Option<String> {
        match &self.value {
            Value::Text(text) => Some(shorten(text)),
            _ => None,
        }
    }

    /// The value under a key of a table.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|e| e.key == key).map(|e| &e.node),
            _ => None,
        }
    }

    /// The same to change.
    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Self> {
        let Value::Table(entries) = &mut self.value else {
            return None;
        };
        let entry = entries.iter_mut().find(|entry| entry.key == key);
        entry.map(|entry| &mut entry.node)
    }

    /// An entry of a list, to change.
    pub(crate) fn entry_mut(&mut self, index: usize) -> Option<&mut Self> {
        match &mut self.value {
            Value::List(items) => items.get_mut(index),
            _ => None,
        }
    }

    /// Takes over the places of a tree, as far as it has the same values; others have none.
    pub(crate) fn take_places(&mut self, of: Option<&Self>) {
        self.place = of.and_then(|of| of.place);
        match &mut self.value {
            Value::Table(entries) => {
                let known = match of.map(|of| &of.value) {
                    Some(Value::Table(known)) => known.as_slice(),
                    _ => &[],
                };
                for entry in entries {
                    let same = known.iter().find(|it| it.key == entry.key);
                    entry.place = same.and_then(|same| same.place);
                    entry.node.take_places(same.map(|same| &same.node));
                }
            }
            Value::List(items) => {
                for (index, item) in items.iter_mut().enumerate() {
                    let same = match of.map(|of| &of.value) {
                        Some(Value::List(known)) => known.get(index),
                        _ => None,
                    };
                    item.take_places(same);
                }
            }
            _ => {}
        }
    }

    /// The value at a path, with entries of lists by name or index.
    pub(crate) fn find(&self, path: &str) -> Option<&Self> {
        steps(path).try_fold(self, |node, step| match &node.value {
            Value::List(items) => items.get(node.position(&step)?),
            _ => node.get(&step),
        })
    }

    /// Position of the list entry with this index or with this `name`.
    pub(crate) fn position(&self, key: &str) -> Option<usize> {
        let Value::List(items) = &self.value else {
            return None;
        };
        let named = |item: &Self| {
            item.get("name")
                .is_some_and(|name| name.value == Value::Text(key.to_owned()))
        };
        items
            .iter()
            .position(named)
            .or_else(|| key.parse().ok().filter(|&index| index < items.len()))
    }

    /// Follows a path as far as it leads: the path in its written form, with entries of lists by
    /// index, and the place of the last value on it.
    pub(crate) fn locate(&self, path: &str) -> (String, Option<TextSpan>) {
        let (mut node, mut place) = (Some(self), None);
        let mut written = String::new();
        for step in steps(path) {
            let index = node.and_then(|list| list.position(&step));
            if let (Some(index), Some(Value::List(items))) = (index, node.map(|n| &n.value)) {
                push_step(&mut written, &index.to_string());
                node = items.get(index);
            } else {
                push_step(&mut written, &step);
                node = node.and_then(|table| table.get(&step));
            }
            // What an option put there has no place, not that of its table.
            place = node.map_or(place, |found| found.place);
        }
        (written, place)
    }
}

/// Whether a text is meant as JSON.
pub(crate) fn is_json(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

fn one_line(message: &str) -> String {
    message
        .lines()
        .map(str::trim)
        .collect::<Vec<_>>()
        .join("; ")
}

impl Lines<'_> {
    fn table(&self, table: &dyn TableLike, place: Option<TextSpan>) -> Node {
        let entry = |(key, item): (&str, &Item)| {
            let span = table
                .key(key)
                .and_then(toml_edit::Key::span)
                .or_else(|| item.span());
            let place = span.map(|span| self.at(span)).or(place);
            Entry {
                key: key.to_owned(),
                place,
                node: self.item(item, place),
            }
        };
        Node {
            place,
            value: Value::Table(table.iter().map(entry).collect()),
        }
    }

    fn item(&self, item: &Item, place: Option<TextSpan>) -> Node {
        let place = item.span().map(|span| self.at(span)).or(place);
        match item {
            Item::None => Node {
                place,
                value: Value::Table(Vec::new()),
            },
            Item::Value(value) => self.value(value, place),
            Item::Table(table) => self.table(table, place),
            Item::ArrayOfTables(tables) => {
                let node = |table: &toml_edit::Table| {
                    let place = table.span().map(|span| self.at(span)).or(place);
                    self.table(table, place)
                };
                Node {
                    place,
                    value: Value::List(tables.iter().map(node).collect()),
                }
            }
        }
    }

    fn value(&self, value: &Toml, place: Option<TextSpan>) -> Node {
        let place = value.span().map(|span| self.at(span)).or(place);
        let value = match value {
            Toml::String(text) => Value::Text(text.value().clone()),
            Toml::Integer(number) => Value::Integer(*number.value()),
            Toml::Float(number) => Value::Float(*number.value()),
            Toml::Boolean(truth) => Value::Truth(*truth.value()),
            Toml::Datetime(_) => Value::Date,
            Toml::Array(items) => {
                Value::List(items.iter().map(|item| self.value(item, place)).collect())
            }
            Toml::InlineTable(table) => return self.table(table, place),
        };
        Node { place, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = 'x'\n\n[chain]\nlinks = 4\n\n[[sprockets]]\nname = 'crank'\nteeth = 23\n\n[[sprockets]]\nname = 'cam'\ntooth = { kind = 'iso606',\n  gap = 0.5 }\n";

    #[test]
    fn values_know_their_lines() {
        let tree = Node::parse(TEXT).unwrap();
        let line = |path| tree.locate(path).1.map(|place| place.line);
        assert_eq!(line("title"), Some(1));
        assert_eq!(line("chain"), Some(3));
        assert_eq!(line("chain.links"), Some(4));
        assert_eq!(line("sprockets[1]"), Some(10));
        assert_eq!(line("sprockets.crank.teeth"), Some(8));
        assert_eq!(line("sprockets.cam.tooth.gap"), Some(13));
        let (path, place) = tree.locate("sprockets.cam.teeth");
        assert_eq!(path, "sprockets[1].teeth");
        assert_eq!(place.map(|place| place.line), Some(10));
    }

    #[test]
    fn json_and_toml_make_the_same_tree() {
        let json = r#"{"title": "x", "chain": {"links": 4, "mass": null}}"#;
        let toml = "title = 'x'\nchain.links = 4\n";
        let of = |text| Node::parse(text).unwrap().to_json();
        assert_eq!(of(json), of(toml));
    }

    #[test]
    fn syntax_errors_have_a_line() {
        let problem = Node::parse("[chain]\npitch = = 3\n").unwrap_err();
        assert_eq!(problem.place.map(|it| it.line), Some(2));
        let problem = Node::parse("{\"chain\": \n [1,}").unwrap_err();
        assert_eq!(problem.place.map(|it| it.line), Some(2), "{problem}");
    }
}
