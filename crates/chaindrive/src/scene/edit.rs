//! Changes single values of a scene and keeps the rest of its text, comments included.

use serde_json::Value as Json;
use toml_edit::{DocumentMut, Item, Value as Toml};

use super::path::steps;
use super::suggest::one_of;
use super::tree::{Node, Value, is_json};
use super::{Problem, Scene, SceneError, limits};

impl Scene {
    /// The scene with one value replaced, checked anew.
    ///
    /// `path` is dotted, with entries of lists by name or by index: `chain.links`,
    /// `sprockets.camshaft.inertia`, `sprockets[1].load`. `value` is TOML, or else taken as a
    /// text: `124`, `12 mm`, `[{ kind = "constant", torque = "5 kN m" }]`. A key that is absent is
    /// added, with the tables that lead to it.
    ///
    /// # Errors
    /// A path that leads nowhere; otherwise those of [`Scene::from_text`].
    pub fn replace(&self, path: &str, value: &str) -> Result<Self, SceneError> {
        self.put(&[self.edit(path, value)?])
    }

    /// The scene with one value replaced by a JSON value, checked anew; see [`Scene::replace`].
    ///
    /// # Errors
    /// A path that leads nowhere, or a JSON `null`; otherwise those of [`Scene::from_text`].
    pub fn replace_json(&self, path: &str, value: &Json) -> Result<Self, SceneError> {
        self.put(&[self.edit_json(path, value)?])
    }

    /// The scene without the value at a path, checked anew; the scene as it is if there is none.
    ///
    /// # Errors
    /// As [`Scene::replace`]: a path that leads nowhere, a value that cannot be missed.
    pub fn without(&self, path: &str) -> Result<Self, SceneError> {
        if self.tree.find(path).is_none() {
            return Ok(self.clone());
        }
        let keys = self.keys(path)?;
        let text = if is_json(&self.text) {
            let mut root: Json = serde_json::from_str(&self.text).unwrap_or_default();
            take_json(&mut root, &keys)
                .ok_or_else(|| self.refuse(path, "nothing can be left out here", None))?;
            format!("{root:#}\n")
        } else {
            let text = self.text.strip_prefix('\u{feff}').unwrap_or(&self.text);
            let mut document: DocumentMut = text.parse().unwrap_or_default();
            take_toml(document.as_item_mut(), &keys)
                .ok_or_else(|| self.refuse(path, "nothing can be left out here", None))?;
            document.to_string()
        };
        self.edited(&text, &[keys])
    }

    /// This scene with another text, which differs at the ends of these ways.
    ///
    /// Places stay those of the text that was read, which is the one that a user has before his eyes; what has been put there has none.
    fn edited(&self, text: &str, ways: &[Vec<Key>]) -> Result<Self, SceneError> {
        let tree = Node::parse(text)
            .map_err(|problem| SceneError::new(&self.name, vec![problem]).nowhere());
        let mut tree = tree?;
        tree.take_places(Some(&self.tree));
        for keys in ways {
            let changed = keys.iter().try_fold(&mut tree, |node, key| match key {
                Key::Index(index) => node.entry_mut(*index),
                Key::Name(name) => node.get_mut(name),
            });
            if let Some(changed) = changed {
                changed.take_places(None);
            }
        }
        Self::from_tree(tree, text, &self.source())
    }

    /// An edit by a text, as [`replace`](Self::replace) reads it.
    pub(crate) fn edit(&self, path: &str, value: &str) -> Result<Edit, SceneError> {
        let deep = |problem| SceneError::new(&self.name, vec![problem]);
        limits::check_toml(value).map_err(deep)?;
        let toml = value.trim().parse::<Toml>();
        Ok(Edit {
            path: path.to_owned(),
            value: toml.unwrap_or_else(|_| Toml::from(value.trim())),
        })
    }

    /// An edit by a JSON value, as [`replace_json`](Self::replace_json) takes it.
    pub(crate) fn edit_json(&self, path: &str, value: &Json) -> Result<Edit, SceneError> {
        let path = path.to_owned();
        match toml_of(value) {
            Some(value) => Ok(Edit { path, value }),
            None => Err(self.refuse(&path, "`null` is not a value", None)),
        }
    }

    /// The scene with several values put, one after the other, checked anew at the end.
    pub(crate) fn put(&self, edits: &[Edit]) -> Result<Self, SceneError> {
        let mut ways: Vec<Vec<Key>> = Vec::new();
        for (count, edit) in edits.iter().enumerate() {
            let keys = self.keys(&edit.path)?;
            // What lies in a value that is put is found there alone.
            if ways.iter().any(|way| keys.starts_with(way)) {
                return self.put(&edits[..count])?.put(&edits[count..]);
            }
            ways.push(keys);
        }
        let both = || edits.iter().zip(&ways);
        let nowhere = |edit: &Edit| {
            let hint = "give the path of a table or a value, such as `chain.links`";
            self.refuse(&edit.path, "nothing can be put here", Some(hint.into()))
        };
        let text = if is_json(&self.text) {
            let mut root: Json = serde_json::from_str(&self.text).unwrap_or_default();
            for (edit, keys) in both() {
                put_json(&mut root, keys, json_of(&edit.value)).ok_or_else(|| nowhere(edit))?;
            }
            format!("{root:#}\n")
        } else {
            let text = self.text.strip_prefix('\u{feff}').unwrap_or(&self.text);
            let mut document: DocumentMut = text.parse().unwrap_or_default();
            for (edit, keys) in both() {
                let value = edit.value.clone();
                put_toml(document.as_item_mut(), keys, value).ok_or_else(|| nowhere(edit))?;
            }
            document.to_string()
        };
        self.edited(&text, &ways)
    }

    fn refuse(&self, path: &str, message: &str, hint: Option<String>) -> SceneError {
        let (path, place) = self.tree.locate(path);
        let mut problem = Problem::new(&path, place, message);
        problem.hint = hint;
        SceneError::new(&self.name, vec![problem]).within(&self.read)
    }

    /// The steps of a path, with names in lists turned into indices.
    fn keys(&self, path: &str) -> Result<Vec<Key>, SceneError> {
        limits::check_path(path).map_err(|problem| SceneError::new(&self.name, vec![problem]))?;
        let mut node = Some(&self.tree);
        let mut keys = Vec::new();
        for step in steps(path) {
            let Some(Value::List(items)) = node.map(|node| &node.value) else {
                node = node.and_then(|node| node.get(&step));
                keys.push(Key::Name(step));
                continue;
            };
            let Some(index) = node.and_then(|list| list.position(&step)) else {
                let names: Vec<&str> = items.iter().filter_map(name_of).collect();
                let message = format!("there is no `{step}` in a list of {}", items.len());
                return Err(self.refuse(path, &message, Some(one_of(&step, &names))));
            };
            node = items.get(index);
            keys.push(Key::Index(index));
        }
        if keys.is_empty() {
            return Err(self.refuse(
                path,
                "the path is empty",
                Some("such as `chain.links`".into()),
            ));
        }
        Ok(keys)
    }
}

/// A value that is to be put at a path of a scene.
pub(crate) struct Edit {
    path: String,
    value: Toml,
}

#[derive(PartialEq)]
enum Key {
    Name(String),
    Index(usize),
}

/// Whether a path goes on past `chain`, which may be written as the name of a catalogue chain.
fn leads_into_chain(keys: &[Key]) -> bool {
    matches!(keys, [Key::Name(first), _, ..] if first == "chain")
}

fn name_of(node: &Node) -> Option<&str> {
    match &node.get("name")?.value {
        Value::Text(name) => Some(name),
        _ => None,
    }
}

fn put_json(root: &mut Json, keys: &[Key], value: Json) -> Option<()> {
    let mut place = root;
    if leads_into_chain(keys)
        && let Some(named) = place.get_mut("chain").filter(|chain| chain.is_string())
    {
        *named = serde_json::json!({"type": named.take()});
    }
    for key in keys {
        place = match key {
            Key::Index(index) => place.get_mut(index)?,
            Key::Name(name) => {
                if place.is_null() {
                    *place = Json::Object(serde_json::Map::new());
                }
                place
                    .as_object_mut()?
                    .entry(name.as_str())
                    .or_insert(Json::Null)
            }
        };
    }
    *place = value;
    Some(())
}

fn put_toml(root: &mut Item, keys: &[Key], value: Toml) -> Option<()> {
    let Some((key, rest)) = keys.split_first() else {
        put_value(root, value);
        return Some(());
    };
    match key {
        Key::Name(name) => {
            if leads_into_chain(keys)
                && let Some(chain) = root.get_mut("chain").and_then(Item::as_value_mut)
                && let Some(named) = chain.as_str()
            {
                let mut table = toml_edit::InlineTable::new();
                table.insert("type", named.into());
                *chain = Toml::InlineTable(table);
            }
            if let Some(Toml::InlineTable(_)) = root.as_value() {
                return put_inline(root.as_value_mut()?, keys, value);
            }
            let item = root.as_table_like_mut()?.entry(name).or_insert(Item::None);
            if item.is_none() && !rest.is_empty() {
                *item = Item::Table(toml_edit::Table::new());
            }
            put_toml(item, rest, value)
        }
        Key::Index(index) => match root {
            Item::ArrayOfTables(tables) => put_in_table(tables.get_mut(*index)?, rest, value),
            Item::Value(list) => put_inline(list, keys, value),
            _ => None,
        },
    }
}

/// Puts a value into an entry of an array of tables, which keeps its heading.
fn put_in_table(table: &mut toml_edit::Table, keys: &[Key], value: Toml) -> Option<()> {
    if let Some((Key::Name(name), rest)) = keys.split_first() {
        let item = table.entry(name).or_insert(Item::None);
        if item.is_none() && !rest.is_empty() {
            *item = Item::Value(Toml::InlineTable(toml_edit::InlineTable::new()));
        }
        return put_toml(item, rest, value);
    }
    let Toml::InlineTable(entries) = value else {
        return None;
    };
    table.clear();
    for (key, value) in &entries {
        table.insert(key, Item::Value(value.clone()));
    }
    Some(())
}

fn put_inline(place: &mut Toml, keys: &[Key], value: Toml) -> Option<()> {
    let Some((key, rest)) = keys.split_first() else {
        let decor = place.decor().clone();
        *place = value;
        *place.decor_mut() = decor;
        return Some(());
    };
    let next = match key {
        Key::Index(index) => place.as_array_mut()?.get_mut(*index)?,
        Key::Name(name) => {
            let empty = || Toml::InlineTable(toml_edit::InlineTable::new());
            place
                .as_inline_table_mut()?
                .entry(name)
                .or_insert_with(empty)
        }
    };
    put_inline(next, rest, value)
}

/// Takes a key out of a table.
fn take_json(root: &mut Json, keys: &[Key]) -> Option<()> {
    let (Key::Name(last), way) = keys.split_last()? else {
        return None;
    };
    let table = way.iter().try_fold(root, |place, key| match key {
        Key::Index(index) => place.get_mut(index),
        Key::Name(name) => place.get_mut(name),
    });
    // `remove` would put the last entry in its place.
    table?.as_object_mut()?.shift_remove(last)?;
    Some(())
}

/// Takes a key out of a table.
fn take_toml(root: &mut Item, keys: &[Key]) -> Option<()> {
    let (Key::Name(last), way) = keys.split_last()? else {
        return None;
    };
    let table = way.iter().try_fold(root, |place, key| match key {
        Key::Index(index) => place.get_mut(*index),
        Key::Name(name) => place.get_mut(name.as_str()),
    });
    table?.as_table_like_mut()?.remove(last)?;
    Some(())
}

/// Puts a value where another one was and keeps the comment after it.
fn put_value(item: &mut Item, mut value: Toml) {
    if let Some(old) = item.as_value() {
        *value.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(value);
}

fn toml_of(json: &Json) -> Option<Toml> {
    Some(match json {
        Json::Null => return None,
        Json::Bool(truth) => (*truth).into(),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => whole.into(),
            None => number.as_f64()?.into(),
        },
        Json::String(text) => text.as_str().into(),
        Json::Array(items) => Toml::Array(items.iter().map(toml_of).collect::<Option<_>>()?),
        Json::Object(entries) => {
            let entries = entries
                .iter()
                .filter_map(|(key, value)| Some((key, toml_of(value)?)));
            Toml::InlineTable(entries.map(|(key, value)| (key.as_str(), value)).collect())
        }
    })
}

fn json_of(toml: &Toml) -> Json {
    match toml {
        Toml::String(text) => text.value().as_str().into(),
        Toml::Integer(number) => (*number.value()).into(),
        Toml::Float(number) => (*number.value()).into(),
        Toml::Boolean(truth) => (*truth.value()).into(),
        Toml::Datetime(date) => date.value().to_string().into(),
        Toml::Array(items) => items.iter().map(json_of).collect(),
        Toml::InlineTable(entries) => entries
            .iter()
            .map(|(key, value)| (key.to_owned(), json_of(value)))
            .collect(),
    }
}
