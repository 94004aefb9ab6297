//! Places of the values in a text of JSON, which the parser does not tell: every value is a slice of the text.

use std::borrow::Cow;
use std::fmt::{self, Formatter};

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::error::Problem;
use super::limits::DEEPEST;
use super::place::{Lines, Place};
use super::tree::{Node, Value};

/// Entries of an object, in the order of the text.
struct Entries<'t>(Vec<(Key<'t>, &'t RawValue)>);

#[derive(Deserialize)]
struct Key<'t>(#[serde(borrow)] Cow<'t, str>);

impl<'t> Deserialize<'t> for Entries<'t> {
    fn deserialize<D: Deserializer<'t>>(text: D) -> Result<Self, D::Error> {
        text.deserialize_map(InOrder)
    }
}

struct InOrder;

impl<'t> Visitor<'t> for InOrder {
    type Value = Entries<'t>;

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'t>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Entries(entries))
    }
}

impl Lines<'_> {
    /// Gives the places in a text to the tree that was made of it.
    ///
    /// # Errors
    /// A key that stands twice in an object: readers of JSON differ in which of the values they take.
    pub(super) fn place_json(&self, tree: &mut Node, text: &str) -> Result<(), Problem> {
        match serde_json::from_str(text) {
            Ok(whole) => {
                self.place(tree, whole, 0)?;
                // What is missing in a scene is missing everywhere in it.
                tree.place = Some(Place::line(1));
                Ok(())
            }
            // The text was read before; whatever this is, it has no places.
            Err(_) => Ok(()),
        }
    }

    fn place(&self, node: &mut Node, raw: &RawValue, depth: usize) -> Result<(), Problem> {
        node.place = self.of(raw.get());
        // Every level is read again. What lies deeper is refused by itself.
        if depth > DEEPEST {
            return Ok(());
        }
        match &mut node.value {
            Value::List(items) => {
                let parts: Vec<&RawValue> = serde_json::from_str(raw.get()).unwrap_or_default();
                for (item, part) in items.iter_mut().zip(parts) {
                    self.place(item, part, depth + 1)?;
                }
            }
            Value::Table(entries) => {
                let Ok(Entries(parts)) = serde_json::from_str(raw.get()) else {
                    return Ok(());
                };
                let mut present = entries.iter_mut().peekable();
                for (Key(key), part) in parts {
                    let place = match &key {
                        Cow::Borrowed(key) => self.of(key),
                        // Escapes were taken out of it.
                        Cow::Owned(_) => self.of(part.get()),
                    };
                    // Entries that are null are absent.
                    let Some(entry) = present.next_if(|entry| entry.key == key) else {
                        if part.get() == "null" {
                            continue;
                        }
                        let message = format!("the key `{key}` stands twice in this table");
                        return Err(Problem::new("", place, message).hint("keep one of them"));
                    };
                    entry.place = place;
                    self.place(&mut entry.node, part, depth + 1)?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}
