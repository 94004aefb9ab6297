//! Scenes in full: every value that counts, what was left open included, with where it comes from.

use std::collections::HashMap;
use std::fmt::Write as _;

use serde::Deserialize;
use serde_json::{Map, Value as Json, json};
use toml_edit::{DocumentMut, Item};

use super::expected::{Expectation, Reading, kind_of};
use super::path::steps;
use super::resolve::{self, Assumption};
use super::schema::{EVERY, STEPPING_KEYS, SceneText, TOLERANCE, UNTIL, Version};
use super::tree::{Node, is_json};
use super::validate::below;
use super::{Scene, SceneError, format, unreadable, validate};
use crate::Stepping;
use crate::figure::{Measure, figure};

/// Remark about a value that is simply not there.
const EMPTY: &str = "not given";

/// A scene with everything that it leaves open filled in.
#[derive(Clone, Debug)]
pub(crate) struct ResolvedScene {
    /// The values, in SI units, in the order of the schema.
    pub(crate) values: Map<String, Json>,
    /// Sources of values by path; each holds for all that lies below its path.
    remarks: HashMap<String, String>,
    /// SI units of quantities.
    pub(crate) units: HashMap<String, &'static str>,
}

impl Scene {
    /// The scene in full: every default with its value and, as a comment, its source or "assumed".
    ///
    /// Its text is TOML in SI units. It makes the same drive to the last bit, now and in versions with other defaults.
    ///
    /// ```
    /// use chaindrive::Scene;
    ///
    /// let scene = Scene::preset("industrial_16b")?;
    /// let full = scene.resolved()?;
    /// assert!(full.text().contains("poisson = 0.3 # assumed: steel on steel"));
    /// assert_eq!(format!("{:?}", full.drive()?), format!("{:?}", scene.drive()?));
    /// # Ok::<(), chaindrive::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Scene::drive`].
    pub fn resolved(&self) -> Result<Self, SceneError> {
        let resolved = ResolvedScene::of(self)?;
        Self::from_toml(&resolved.text(), &self.name)
    }

    /// Its text with other settings of the run, and what [`assumed`](Self::assumed) tells of it.
    pub(crate) fn resolved_text(
        &self,
        run: Map<String, Json>,
    ) -> Result<(String, Vec<String>), SceneError> {
        let mut resolved = ResolvedScene::of(self)?;
        resolved.settle_on(run);
        Ok((resolved.text(), resolved.assumed()))
    }

    /// Inputs that nobody measured or gave, as `path = value`: those whose source is the word "assumed", settings of the run left aside.
    ///
    /// # Errors
    /// As [`Scene::drive`].
    pub fn assumed(&self) -> Result<Vec<String>, SceneError> {
        Ok(ResolvedScene::of(self)?.assumed())
    }
}

impl ResolvedScene {
    /// # Errors
    /// As [`Scene::drive`].
    pub(crate) fn of(scene: &Scene) -> Result<Self, SceneError> {
        let (_, assumptions) = resolve::drive(&scene.content, &scene.tree)
            .map_err(|problems| problems.of(&scene.name).within(&scene.read))?;
        let mut given = scene.tree.clone();
        given.expand_chain();
        let mut values = json!(scene.content);
        prune(&mut values);
        let mut remarks = HashMap::new();
        for mut assumption in assumptions.into_iter().chain(run_defaults(scene)) {
            prune(&mut assumption.value);
            if put(&mut values, &assumption.path, assumption.value) {
                remarks.insert(assumption.path, assumption.remark);
            }
        }
        // Once more through the types, which have defaults of their own for what came in.
        let content = SceneText::deserialize(&values)
            .map_err(|error| SceneError::new(&scene.name, vec![unreadable(&error)]))?;
        values = json!(content);
        prune(&mut values);
        in_order(&mut values, format::raw(), &Reading::new(format::raw()));
        if let Json::Object(values) = &values {
            // What stands in the text, and what the types of the schema put in.
            let comments = comments(&scene.text);
            annotate(values, "", &given, &comments, &mut remarks);
        }
        let units = units(&values);
        Ok(Self {
            values: match values {
                Json::Object(values) => values,
                _ => Map::new(),
            },
            remarks,
            units,
        })
    }

    /// Puts the settings of a run in place of those of the scene.
    fn settle_on(&mut self, mut settings: Map<String, Json>) {
        // What a run does not decide stays as the scene says it.
        let decided = |key: &str| key == "accuracy" || STEPPING_KEYS.contains(&key);
        let kept = self.values.get("run").and_then(Json::as_object);
        for (key, value) in kept.into_iter().flatten() {
            if !decided(key) && !settings.contains_key(key) {
                settings.insert(key.clone(), value.clone());
            }
        }
        self.remarks
            .retain(|path, _| path != "run" && !path.starts_with("run."));
        self.remarks.insert("run".into(), "as it was run".into());
        self.values.insert("run".into(), settings.into());
        self.units = units(&Json::Object(self.values.clone()));
    }

    fn assumed(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (key, value) in &self.values {
            if key != "run" {
                self.add_assumed(key, value, &mut found);
            }
        }
        found
    }

    /// Adds the values at a place and below whose source says that they were assumed.
    fn add_assumed(&self, place: &str, value: &Json, found: &mut Vec<String>) {
        match value {
            Json::Object(inner) => {
                for (key, value) in inner {
                    self.add_assumed(&below(place, key), value, found);
                }
            }
            Json::Array(items) if items.iter().any(Json::is_object) => {
                for (index, item) in items.iter().enumerate() {
                    self.add_assumed(&below(place, &index.to_string()), item, found);
                }
            }
            _ if self.remark(place).is_some_and(|it| it.contains("assumed")) => {
                let unit = self.units.get(place).filter(|unit| **unit != "1");
                let told = match (value.as_f64(), unit) {
                    (Some(value), Some(unit)) => match Measure::of_unit(unit) {
                        Some(measure) => measure.told(value),
                        None => format!("{} {unit}", figure(value)),
                    },
                    (Some(value), None) => figure(value),
                    (None, _) => leaf(value),
                };
                found.push(format!("{place} = {told}"));
            }
            _ => {}
        }
    }

    /// The scene as TOML.
    pub(crate) fn text(&self) -> String {
        let version = Version::PRESENT;
        let mut text = format!("format = \"{version}\"\ndefaults = \"{version}\"\n");
        self.table(&self.values, "", "", &mut text);
        text
    }

    /// `place` is the path in the scene, `heading` that of TOML, which does not count the entries of lists.
    fn table(&self, table: &Map<String, Json>, place: &str, heading: &str, text: &mut String) {
        let is_list_of_tables = |value: &Json| {
            let list = value.as_array().filter(|list| !list.is_empty());
            list.is_some_and(|list| list.iter().all(Json::is_object))
        };
        for (key, value) in table {
            if !(value.is_object() || is_list_of_tables(value)) {
                let comment = self.comment(&below(place, key), value);
                let _ = writeln!(text, "{key} = {}{comment}", leaf(value));
            }
        }
        for (key, value) in table {
            let (place, heading) = (below(place, key), join(heading, key));
            if let Json::Object(inner) = value {
                // A heading with nothing but tables below it is theirs.
                if !inner.values().all(Json::is_object) {
                    let _ = writeln!(text, "\n[{heading}]");
                }
                self.table(inner, &place, &heading, text);
            } else if is_list_of_tables(value) {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    let _ = writeln!(text, "\n[[{heading}]]");
                    if let Json::Object(inner) = item {
                        self.table(inner, &below(&place, &index.to_string()), &heading, text);
                    }
                }
            }
        }
    }

    /// Unit and remark of a value, as a comment after it.
    fn comment(&self, place: &str, value: &Json) -> String {
        let first = if value.is_array() {
            below(place, "0")
        } else {
            place.to_owned()
        };
        let unit = self
            .units
            .get(&first)
            .or_else(|| self.units.get(&below(&first, "0")));
        let unit = unit.filter(|unit| **unit != "1");
        let unit = unit.map(|unit| format!("[{unit}]"));
        let remark = self.remark(place).map(str::to_owned);
        let words: Vec<String> = unit.into_iter().chain(remark).collect();
        if words.is_empty() {
            String::new()
        } else {
            format!(" # {}", words.join(" "))
        }
    }

    /// Source of a value: its own remark, or that of the table it belongs to.
    pub(crate) fn remark(&self, place: &str) -> Option<&str> {
        let mut place = place;
        loop {
            if let Some(remark) = self.remarks.get(place) {
                return Some(remark).filter(|r| !r.is_empty()).map(String::as_str);
            }
            place = &place[..place.rfind(['.', '['])?];
        }
    }
}

/// Settings of a run that the scene leaves open.
fn run_defaults(scene: &Scene) -> Vec<Assumption> {
    let wanted = scene.run_defaults();
    let assumed = |key: &str, value: Json| Assumption {
        path: format!("run.{key}"),
        value,
        remark: "assumed".into(),
    };
    let mut open = Vec::new();
    if wanted.until.is_none() {
        open.push(assumed("until", UNTIL.into()));
    }
    if wanted.every.is_none() {
        open.push(assumed("every", EVERY.into()));
    }
    match (wanted.accuracy, wanted.chosen_accuracy()) {
        (None, Some(accuracy)) => open.push(assumed("accuracy", accuracy.into())),
        (Some(_), _) => {}
        (None, None) => {
            if wanted.method.is_none() {
                open.push(assumed("method", Stepping::default().name().into()));
            }
            if wanted.tolerance.is_none() {
                open.push(assumed("tolerance", TOLERANCE.into()));
            }
        }
    }
    open
}

/// Drops keys without a value, and tables and lists without entries.
fn prune(value: &mut Json) {
    match value {
        Json::Object(entries) => {
            entries.values_mut().for_each(prune);
            entries.retain(|_, value| match value {
                Json::Null => false,
                Json::Object(inner) => !inner.is_empty(),
                Json::Array(inner) => !inner.is_empty(),
                Json::String(text) => !text.is_empty(),
                _ => true,
            });
        }
        Json::Array(items) => items.iter_mut().for_each(prune),
        _ => {}
    }
}

/// Brings the keys of all tables into the order of the schema.
fn in_order(value: &mut Json, schema: &Json, reading: &Reading<'_>) {
    let core = reading.core(schema);
    let table = match Expectation::of(core) {
        Expectation::Kinds(members, _) => {
            let of_kind = |member: &&Json| kind_of(member) == value["kind"].as_str();
            members.iter().find(of_kind).unwrap_or(core)
        }
        _ => core,
    };
    match value {
        Json::Object(entries) => {
            let keys = table["properties"].as_object();
            let place = |key: &str| keys?.keys().position(|known| known == key);
            let mut sorted: Vec<_> = std::mem::take(entries).into_iter().collect();
            sorted.sort_by_key(|(key, _)| place(key));
            *entries = sorted.into_iter().collect();
            for (key, value) in entries {
                in_order(value, &table["properties"][key.as_str()], reading);
            }
        }
        Json::Array(items) => {
            for item in items {
                in_order(item, &table["items"], reading);
            }
        }
        _ => {}
    }
}

/// Puts a value at a path, with the tables that lead to it; false where something else is in the way.
fn put(values: &mut Json, path: &str, value: Json) -> bool {
    let mut place = values;
    for step in steps(path) {
        let next = match place {
            Json::Array(items) => step.parse().ok().and_then(|i: usize| items.get_mut(i)),
            Json::Object(entries) => Some(entries.entry(step).or_insert(Json::Null)),
            Json::Null => {
                *place = json!({});
                place
                    .as_object_mut()
                    .map(|new| new.entry(step).or_insert(Json::Null))
            }
            _ => None,
        };
        match next {
            Some(next) => place = next,
            None => return false,
        }
    }
    if !place.is_null() {
        return false;
    }
    *place = value;
    true
}

/// Remarks for what was written, and for what is simply not there.
fn annotate(
    table: &Map<String, Json>,
    place: &str,
    given: &Node,
    comments: &HashMap<String, String>,
    remarks: &mut HashMap<String, String>,
) {
    for (key, value) in table {
        let place = below(place, key);
        if remarks.contains_key(&place) {
            continue;
        }
        let list = value.as_array().into_iter().flatten().enumerate();
        for (index, item) in list.filter_map(|(i, item)| Some((i, item.as_object()?))) {
            let place = below(&place, &index.to_string());
            annotate(item, &place, given, comments, remarks);
        }
        match (value, given.find(&place)) {
            (Json::Object(inner), _) => annotate(inner, &place, given, comments, remarks),
            (_, None) => {
                remarks.insert(place, EMPTY.into());
            }
            (value, Some(node)) => {
                let written = node.written().filter(|_| value.is_number());
                let comment = comments.get(&place).cloned();
                let words: Vec<String> = written.into_iter().chain(comment).collect();
                remarks.insert(place, words.join("; "));
            }
        }
    }
}

/// The comments after values of a TOML text, by place.
fn comments(text: &str) -> HashMap<String, String> {
    let mut found = HashMap::new();
    if !is_json(text)
        && let Ok(document) = text.parse::<DocumentMut>()
    {
        collect(document.as_item(), "", &mut found);
    }
    found
}

fn collect(item: &Item, place: &str, found: &mut HashMap<String, String>) {
    if let Some(table) = item.as_table_like() {
        for (key, item) in table.iter() {
            collect(item, &below(place, key), found);
        }
    }
    if let Some(tables) = item.as_array_of_tables() {
        for (index, table) in tables.iter().enumerate() {
            for (key, item) in table {
                collect(item, &below(&below(place, &index.to_string()), key), found);
            }
        }
    }
    let suffix = item.as_value().and_then(|value| value.decor().suffix());
    let suffix = suffix.and_then(|raw| raw.as_str()).unwrap_or_default();
    if let Some((_, comment)) = suffix.split_once('#') {
        let line = comment.lines().next().unwrap_or_default();
        // A text in full has units before its remarks.
        let line = line.trim();
        let remark = line.strip_prefix('[').and_then(|line| line.split_once(']'));
        let remark = remark.map_or(line, |(_, remark)| remark.trim());
        found.insert(place.to_owned(), remark.to_owned());
    }
}

/// SI units of the quantities of a valid scene.
fn units(values: &Json) -> HashMap<String, &'static str> {
    validate::units(&mut Node::from_json(values), format::raw())
}

fn join(heading: &str, key: &str) -> String {
    if heading.is_empty() {
        key.to_owned()
    } else {
        format!("{heading}.{key}")
    }
}

/// A value as TOML, on one line.
pub(crate) fn leaf(value: &Json) -> String {
    match value {
        Json::Array(items) => {
            let items: Vec<String> = items.iter().map(leaf).collect();
            format!("[{}]", items.join(", "))
        }
        Json::String(text) => toml_edit::Value::from(text.as_str()).to_string(),
        Json::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            // The shortest digits that read back as the same number.
            Some(float) => format!("{float:?}"),
            None => number.to_string(),
        },
        other => other.to_string(),
    }
}
