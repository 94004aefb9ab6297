//! Compares a tree with the schema, collects every problem, and rewrites quantities to SI.
//!
//! Afterwards serde can read the tree: what it would refuse has been refused here, with a place,
//! its part of the text and a hint.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};

use serde_json::{Map, Value as Json};

use super::error::{Problem, Problems};
use super::expected::{Expectation, Reading, kind_of, request};
use super::keys::Keys;
use super::path::push_step;
use super::run_in::RunIn;
use super::schema::Version;
use super::suggest::{did_you_mean, distance, nearest, one_of};
use super::tree::{Entry, Node, Value};
use crate::terminal_text::shorten;
use chaindrive_quantities::{CONTACT_STIFFNESS, Dimension, Range};

/// Checks `tree` against `schema` and normalises it: quantities become SI numbers, bare names of
/// kinds become tables.
pub(crate) fn validate(tree: &mut Node, schema: &Json) -> Problems {
    let mut validator = Validator::new(schema, schema);
    validator.visit(tree, schema, "", None);
    validator.problems
}

/// The same of a part on its own, by the name that its type has in the schema.
pub(crate) fn validate_part(tree: &mut Node, schema: &Json, name: &str) -> Problems {
    let part = &schema["$defs"][name];
    let mut validator = Validator::new(schema, part);
    validator.visit(tree, part, "", None);
    validator.problems
}

/// SI units of the quantities of a valid tree, by path; the tree is normalised.
pub(crate) fn units(tree: &mut Node, schema: &Json) -> HashMap<String, &'static str> {
    let mut validator = Validator::new(schema, schema);
    validator.units = Some(HashMap::new());
    validator.visit(tree, schema, "", None);
    validator.units.unwrap_or_default()
}

/// Refuses a format that this version does not know, before all that would be wrong in consequence.
pub(crate) fn known_version(tree: &Node) -> Result<(), Problem> {
    for key in ["format", "defaults"] {
        let Some(node) = tree.get(key) else {
            continue;
        };
        let known = Version::PRESENT;
        let written = match &node.value {
            Value::Text(text) if text == known => continue,
            Value::Text(text) => shorten(text),
            Value::Float(number) => number.to_string(),
            other => other.kind().to_owned(),
        };
        let hint = if written == known {
            format!("a version is a text: \"{written}\"")
        } else {
            let version = env!("CARGO_PKG_VERSION");
            format!("chaindrive {version} knows {known}; take a newer one, or leave it out")
        };
        let message = format!("`{written}` is not a known version");
        return Err(Problem::new(key, node.place, message).hint(hint));
    }
    Ok(())
}

struct Validator<'s> {
    schema: Reading<'s>,
    /// Schema of the tree, and the keys that it has anywhere: needed for the first unknown one.
    root: &'s Json,
    keys: OnceCell<Keys>,
    problems: Problems,
    /// Units of the quantities passed, where they are wanted.
    units: Option<HashMap<String, &'static str>>,
}

impl<'s> Validator<'s> {
    fn new(schema: &'s Json, root: &'s Json) -> Self {
        Self {
            schema: Reading::new(schema),
            root,
            keys: OnceCell::new(),
            problems: Problems::default(),
            units: None,
        }
    }

    fn refuse(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// `exponent` is that of the power law the value belongs to.
    fn visit(&mut self, node: &mut Node, schema: &'s Json, path: &str, exponent: Option<f64>) {
        let core = self.schema.core(schema);
        let before = self.problems.count();
        match Expectation::of(core) {
            Expectation::Table(core) => self.table(node, core, path, None),
            Expectation::List(core) => self.list(node, core, path, exponent),
            Expectation::Kinds(members, unnamed) => self.kinds(node, members, unnamed, path),
            Expectation::Words(words) => self.word(node, &words, path),
            Expectation::Quantity(core, dimension) => {
                self.quantity(node, core, dimension, path, exponent);
            }
            Expectation::Integer => self.integer(node, path),
            Expectation::Truth => {
                if !matches!(node.value, Value::Truth(_)) {
                    self.wrong_type(node, path, "true or false");
                }
            }
            Expectation::Text => {
                if !matches!(node.value, Value::Text(_)) {
                    self.wrong_type(node, path, "a text");
                }
            }
            Expectation::RunIn => match &node.value {
                Value::Text(text) => {
                    if let Err(problem) = text.parse::<RunIn>() {
                        let hint = "write a time such as \"0.5 s\", turns such as \"5 turns of camshaft\", or \"auto\"";
                        self.refuse(Problem::new(path, node.place, problem).hint(hint));
                    }
                }
                Value::Integer(_) | Value::Float(_) => {}
                _ => self.wrong_type(node, path, "a time, turns of a sprocket, or \"auto\""),
            },
            Expectation::Anything => {}
        }
        if self.problems.count() == before {
            self.range(node, core, path);
            if !std::ptr::eq(core, schema) {
                self.range(node, schema, path);
            }
        }
    }

    fn wrong_type(&mut self, node: &Node, path: &str, needed: &str) {
        let found = match &node.value {
            Value::Text(text) => format!("the text \"{}\"", shorten(text)),
            Value::Integer(number) => format!("the number {number}"),
            Value::Float(number) => format!("the number {number}"),
            other => other.kind().to_owned(),
        };
        self.refuse(Problem::new(
            path,
            node.place,
            format!("found {found}, needed is {needed}"),
        ));
    }

    /// `kind` is the member of the family the table has been found to be.
    fn table(&mut self, node: &mut Node, schema: &'s Json, path: &str, kind: Option<&str>) {
        let here = node.place;
        if !matches!(node.value, Value::Table(_)) {
            self.wrong_type(node, path, "a table");
            return;
        }
        let exponent = node.get("exponent").and_then(number);
        let Value::Table(entries) = &mut node.value else {
            return;
        };
        let nothing = Map::new();
        let properties = schema
            .get("properties")
            .and_then(Json::as_object)
            .unwrap_or(&nothing);
        let known: Vec<&str> = properties.keys().map(String::as_str).collect();
        let mut meant = Vec::new();
        let mut seen: HashSet<String> = HashSet::new();
        for entry in entries.iter_mut() {
            let place = below(path, &entry.key);
            if !seen.insert(entry.key.clone()) {
                let message = "stands twice";
                self.refuse(Problem::new(&place, entry.place, message).hint("keep one of them"));
            }
            // A lookup by the schema's own lifetime, not that of the local default.
            let property = schema.get("properties").and_then(|all| all.get(&entry.key));
            match property {
                Some(_) if entry.key == "kind" && kind.is_some() => {}
                Some(property) => match self.meant(entry, property, schema) {
                    Some(near) => {
                        let text = format!(
                            "found the number {}, needed is a table",
                            number(&entry.node).unwrap_or(f64::NAN)
                        );
                        let problem = Problem::new(&place, entry.place, text);
                        self.refuse(problem.hint(format!("did you mean `{near}`?")));
                        meant.push(near);
                    }
                    None => self.visit(&mut entry.node, property, &place, exponent),
                },
                None => self.problems.push_with(|| {
                    let keys = self
                        .keys
                        .get_or_init(|| Keys::below(self.root, &self.schema));
                    let (near, problem) = unknown_key(entry, path, &known, kind, keys);
                    meant.extend(near);
                    problem
                }),
            }
        }
        let listed = |keys: Option<&'s Json>| keys.and_then(Json::as_array).into_iter().flatten();
        // Keys that another key may stand for.
        let unless = schema.get("x-required-unless").and_then(Json::as_object);
        let unless = unless.into_iter().flatten();
        let alone = unless.filter(|(key, _)| !seen.contains(*key));
        let required = listed(schema.get("required"));
        let required = required.chain(alone.flat_map(|(_, keys)| listed(Some(keys))));
        for key in required.filter_map(Json::as_str) {
            if seen.contains(key) || meant.iter().any(|k| k == key) {
                continue;
            }
            let place = below(path, key);
            let problem = Problem::new(&place, here, "missing");
            self.refuse(match request(&properties[key]) {
                Some(text) => problem.hint(text),
                None => problem,
            });
        }
    }

    /// The key that was meant where a number stands in place of a table, and a key of nearly the same name takes numbers: `teeth`
    /// for `tooth`.
    fn meant(&self, entry: &Entry, property: &'s Json, schema: &'s Json) -> Option<String> {
        number(&entry.node)?;
        let all = schema.get("properties")?.as_object()?;
        let expected = |schema| Expectation::of(self.schema.core(schema));
        if !matches!(
            expected(property),
            Expectation::Table(_) | Expectation::Kinds(..)
        ) {
            return None;
        }
        let takes_numbers = |schema| {
            matches!(
                expected(schema),
                Expectation::Quantity(..) | Expectation::Integer
            )
        };
        let fitting = all.iter().filter(|(_, schema)| takes_numbers(schema));
        let keys: Vec<&str> = fitting.map(|(key, _)| key.as_str()).collect();
        nearest(&entry.key, &keys).map(str::to_owned)
    }

    fn list(&mut self, node: &mut Node, schema: &'s Json, path: &str, exponent: Option<f64>) {
        let Some(items) = schema.get("items") else {
            return;
        };
        let core = self.schema.core(items);
        if core.get("x-dimension").is_some() && matches!(node.value, Value::Table(_)) {
            self.common_unit(node, path);
        }
        let here = node.place;
        if let (Value::Text(text), Expectation::Kinds(members, _)) =
            (&node.value, Expectation::of(core))
            && let Some(table) = self.around_quantity(text, members)
        {
            let needed = format!("a list; write `{} = [{table}]`", last_key(path));
            self.wrong_type(node, path, &needed);
            return;
        }
        let Value::List(entries) = &mut node.value else {
            self.wrong_type(node, path, "a list");
            return;
        };
        let count = entries.len() as u64;
        let bound = |key| schema.get(key).and_then(Json::as_u64);
        let (least, most) = (bound("minItems"), bound("maxItems"));
        let refusal = match (least, most) {
            (Some(least), Some(most)) if least == most && count != least => {
                Some(format!("{count} values, needed are {least}"))
            }
            (_, Some(most)) if count > most => Some(format!("{count} values, at most {most}")),
            _ => None,
        };
        if let Some(message) = refusal {
            self.refuse(Problem::new(path, here, message));
            // Whatever the values are, they are too many or too few.
            return;
        }
        for (index, entry) in entries.iter_mut().enumerate() {
            self.visit(entry, items, &below(path, &index.to_string()), exponent);
        }
    }

    /// `{ unit = "ms", values = [1, 2] }` becomes `["1 ms", "2 ms"]`.
    fn common_unit(&mut self, node: &mut Node, path: &str) {
        let (unit, values) = match (node.get("unit"), node.get("values")) {
            (Some(unit), Some(values)) => (unit.clone(), values.clone()),
            _ => return,
        };
        let (Value::Text(unit), Value::List(mut values)) = (unit.value, values.value) else {
            return;
        };
        for (index, value) in values.iter_mut().enumerate() {
            let text = match &value.value {
                Value::Integer(number) => format!("{number} {unit}"),
                Value::Float(number) => format!("{number:e} {unit}"),
                _ => {
                    let place = below(&below(path, "values"), &index.to_string());
                    self.wrong_type(value, &place, "a number, because the list has a unit");
                    continue;
                }
            };
            value.value = Value::Text(text);
        }
        node.value = Value::List(values);
    }

    fn kinds(&mut self, node: &mut Node, members: &'s [Json], unnamed: Option<&str>, path: &str) {
        let names: Vec<&str> = members.iter().filter_map(kind_of).collect();
        if let Value::Text(name) = &node.value {
            // A bare name; what else its kind needs is reported as missing.
            let kind = Entry {
                key: "kind".into(),
                place: node.place,
                node: node.clone(),
            };
            if let Some(table) = self.around_quantity(name, members) {
                let message = format!(
                    "found the quantity \"{}\", needed is a table with a `kind`",
                    shorten(name)
                );
                let problem = Problem::new(path, node.place, message);
                let hint = format!("write `{} = {table}`", last_key(path));
                self.refuse(problem.hint(hint));
                return;
            }
            if !matches_any(&names, name) {
                let problem = Problem::new(
                    path,
                    node.place,
                    format!("unknown kind `{}`", shorten(name)),
                );
                self.refuse(problem.hint(one_of(name, &names)));
                return;
            }
            node.value = Value::Table(vec![kind]);
        }
        let here = node.place;
        let Value::Table(entries) = &mut node.value else {
            self.wrong_type(node, path, "a table with a `kind`");
            return;
        };
        if let Some(kind) = unnamed
            && entries.iter().all(|entry| entry.key != "kind")
        {
            entries.push(Entry {
                key: "kind".into(),
                place: here,
                node: Node {
                    place: here,
                    value: Value::Text(kind.to_owned()),
                },
            });
        }
        let Some(entry) = entries.iter_mut().find(|entry| entry.key == "kind") else {
            let problem = Problem::new(&below(path, "kind"), here, "missing");
            self.refuse(problem.hint(format!("the kinds are {}", names.join(", "))));
            return;
        };
        let place = below(path, "kind");
        let Value::Text(name) = &entry.node.value else {
            let node = entry.node.clone();
            self.wrong_type(&node, &place, "a text");
            return;
        };
        let Some(member) = members
            .iter()
            .find(|m| kind_of(m).is_some_and(|k| same(k, name)))
        else {
            let message = format!("unknown kind `{}`", shorten(name));
            let problem = Problem::new(&place, entry.node.place, message);
            let hint = one_of(name, &names);
            self.refuse(problem.hint(hint));
            return;
        };
        let kind = kind_of(member).unwrap_or_default();
        entry.node.value = Value::Text(kind.to_owned());
        self.table(node, member, path, Some(kind));
    }

    /// The table of a family that a quantity written in its place was meant for: the first whose one key that must be given takes it.
    fn around_quantity(&self, text: &str, members: &'s [Json]) -> Option<String> {
        let first = text.chars().next()?;
        if !(first.is_ascii_digit() || matches!(first, '-' | '+' | '.')) {
            return None;
        }
        members.iter().find_map(|member| {
            let required = member.get("required")?.as_array()?.iter();
            let mut keys = required
                .filter_map(Json::as_str)
                .filter(|key| *key != "kind");
            let (key, None) = (keys.next()?, keys.next()) else {
                return None;
            };
            let property = self.schema.core(&member["properties"][key]);
            let Expectation::Quantity(_, dimension) = Expectation::of(property) else {
                return None;
            };
            dimension.read(text, None).ok()?;
            let kind = kind_of(member)?;
            Some(format!("{{ kind = \"{kind}\", {key} = \"{text}\" }}"))
        })
    }

    fn word(&mut self, node: &mut Node, words: &[&str], path: &str) {
        let Value::Text(text) = &node.value else {
            self.wrong_type(node, path, &format!("one of {}", words.join(", ")));
            return;
        };
        if let Some(word) = words.iter().find(|word| same(word, text)) {
            node.value = Value::Text((*word).to_owned());
        } else {
            let message = format!("unknown value `{}`", shorten(text));
            self.refuse(Problem::new(path, node.place, message).hint(one_of(text, words)));
        }
    }

    fn quantity(
        &mut self,
        node: &mut Node,
        schema: &Json,
        dimension: &'static Dimension,
        path: &str,
        exponent: Option<f64>,
    ) {
        if let Some(units) = &mut self.units {
            units.insert(path.to_owned(), dimension.unit);
        }
        let value = match &node.value {
            Value::Integer(_) | Value::Float(_) => number(node).unwrap_or(f64::NAN),
            Value::Text(text) => {
                let words = schema.get("x-words");
                let word = words.and_then(|words| words.get(text));
                if word.is_some_and(Json::is_string) {
                    return;
                }
                let word = word.and_then(Json::as_f64);
                let exponent = exponent.filter(|_| dimension.name == CONTACT_STIFFNESS);
                let read = || dimension.read(&shorten(text), exponent);
                match word.map_or_else(read, Ok) {
                    Ok(value) => value,
                    Err(complaint) => {
                        let problem = Problem::new(path, node.place, complaint.message);
                        self.refuse(problem.hint(complaint.hint));
                        return;
                    }
                }
            }
            _ => {
                let needed = format!("{} such as \"{}\"", dimension.name, dimension.example);
                self.wrong_type(node, path, &needed);
                return;
            }
        };
        if value.is_finite() {
            node.value = Value::Float(value);
        } else {
            let problem = Problem::new(path, node.place, format!("{value} is not a finite number"));
            let hint = format!("give {} such as \"{}\"", dimension.name, dimension.example);
            self.refuse(problem.hint(hint));
        }
    }

    fn integer(&mut self, node: &mut Node, path: &str) {
        match node.value {
            Value::Integer(_) => {}
            #[expect(clippy::cast_possible_truncation, reason = "whole and small")]
            Value::Float(number) if number.fract() == 0.0 && number.abs() < 1e15 => {
                node.value = Value::Integer(number as i64);
            }
            _ => self.wrong_type(node, path, "a whole number"),
        }
    }

    fn range(&mut self, node: &Node, schema: &Json, path: &str) {
        let Some(value) = number(node) else {
            return;
        };
        if let Some(allowed) = Range(schema).refuses(value) {
            let message = format!("{value}, must be {allowed}");
            let problem = Problem::new(path, node.place, message);
            let remedy = schema.get("x-remedy").and_then(Json::as_str);
            self.refuse(match remedy {
                Some(remedy) => problem.hint(remedy),
                None => problem,
            });
        }
    }
}

/// Whether two names agree; `rest_length` will do for `rest-length`.
fn same(name: &str, written: &str) -> bool {
    name == written || name == written.replace('_', "-")
}

fn matches_any(names: &[&str], written: &str) -> bool {
    names.iter().any(|name| same(name, written))
}

fn number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Integer(number) => Some(number as f64),
        Value::Float(number) => Some(number),
        _ => None,
    }
}

/// The problem of a key that the table at `path` does not have, and the key of that table that was meant.
fn unknown_key(
    entry: &Entry,
    path: &str,
    known: &[&str],
    kind: Option<&str>,
    keys: &Keys,
) -> (Option<String>, Problem) {
    let message = match kind {
        Some(kind) => format!("unknown key; a `{kind}` has no `{}`", shorten(&entry.key)),
        None => "unknown key".to_owned(),
    };
    let problem = Problem::new(&below(path, &entry.key), entry.place, message);
    let near = nearest(&entry.key, known);
    let typing_errors = near.and_then(|near| distance(&entry.key, near));
    match keys.elsewhere((&entry.key, &entry.node.value), path) {
        // One typing error is likelier than a wrong table, and a wrong table than two typing errors.
        Some((far, paths)) if typing_errors.is_none_or(|errors| errors > far + 1) => {
            (None, problem.hint(did_you_mean(&paths)))
        }
        _ => {
            let near = near.map(str::to_owned);
            (near, problem.hint(one_of(&entry.key, known)))
        }
    }
}

/// The key at the end of a path.
fn last_key(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// A path with one more step.
pub(crate) fn below(path: &str, step: &str) -> String {
    let mut place = path.to_owned();
    push_step(&mut place, &shorten(step));
    place
}
