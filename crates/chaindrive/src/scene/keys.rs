//! Places of keys in the format, for whoever writes a key without the tables that lead to it.

use std::collections::HashSet;

use serde_json::Value as Json;

use super::expected::{Expectation, Reading, kind_of};
use super::path::push_step;
use super::suggest::distance;
use super::tree::Value;

/// Levels of tables that are looked through.
const LEVELS: usize = 6;
/// Most places that a hint names.
const MOST: usize = 3;

/// All keys below a schema, the upper ones first.
#[derive(Debug)]
pub(crate) struct Keys(Vec<Key>);

#[derive(Debug)]
struct Key {
    level: usize,
    /// With entry 0 of every list on the way.
    path: String,
    name: String,
    takes: ValueForm,
}

/// Values of a key, as far as they tell keys of one name apart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ValueForm {
    Tables,
    /// Tables with a kind, or the bare name of one.
    Kinds,
    Others,
}

impl ValueForm {
    fn of(schema: &Json) -> Self {
        match Expectation::of(schema) {
            Expectation::Table(_) => Self::Tables,
            Expectation::Kinds(..) => Self::Kinds,
            _ => Self::Others,
        }
    }

    fn suits(self, value: &Value) -> bool {
        match value {
            Value::Integer(_) | Value::Float(_) | Value::Truth(_) => self == Self::Others,
            Value::Text(_) => self != Self::Tables,
            _ => true,
        }
    }
}

impl Keys {
    pub(crate) fn below(root: &Json, schema: &Reading<'_>) -> Self {
        let (mut keys, mut seen) = (Vec::new(), HashSet::new());
        let mut tables = vec![(String::new(), root)];
        for level in 0..LEVELS {
            let mut next = Vec::new();
            for (path, table) in tables {
                for (step, inner) in steps(schema.core(table)) {
                    let mut place = path.clone();
                    push_step(&mut place, step);
                    if !seen.insert(place.clone()) {
                        continue;
                    }
                    if step != FIRST {
                        keys.push(Key {
                            level,
                            path: place.clone(),
                            name: step.to_owned(),
                            takes: ValueForm::of(schema.core(inner)),
                        });
                    }
                    next.push((place, inner));
                }
            }
            tables = next;
        }
        Self(keys)
    }

    /// Paths of a key that is unknown in the table at `within`: those below that table, otherwise the uppermost ones.
    /// All of them are as far from the name as the number says, and take such a value.
    pub(crate) fn elsewhere(
        &self,
        (written, value): (&str, &Value),
        within: &str,
    ) -> Option<(usize, Vec<String>)> {
        let first = with_first_entries(within);
        let below = |key: &Key| match key.path.strip_prefix(&first) {
            Some(rest) if first.is_empty() || rest.starts_with(['.', '[']) => {
                Some(format!("{within}{rest}"))
            }
            _ => None,
        };
        let near = |key: &&Key| {
            let few = distance(written, &key.name).is_some_and(|errors| errors <= 1);
            few && key.takes.suits(value)
        };
        let near: Vec<&Key> = self.0.iter().filter(near).collect();
        let score = |key: &Key| {
            let far = distance(written, &key.name).unwrap_or(usize::MAX);
            (far, below(key).is_none(), key.level)
        };
        let best = near.iter().map(|key| score(key)).min()?;
        let fitting = near.iter().filter(|key| score(key) == best);
        let paths = fitting.map(|key| below(key).unwrap_or_else(|| key.path.clone()));
        Some((best.0, paths.take(MOST).collect()))
    }
}

/// The entry of a list that stands for all of them.
const FIRST: &str = "0";

/// Keys of a table, of all members of a family, or the entry of a list.
fn steps(schema: &Json) -> Vec<(&str, &Json)> {
    match Expectation::of(schema) {
        Expectation::Table(table) => keys_of(table).collect(),
        Expectation::List(list) => list
            .get("items")
            .map(|it| (FIRST, it))
            .into_iter()
            .collect(),
        Expectation::Kinds(members, _) => members
            .iter()
            .filter(|member| kind_of(member).is_some())
            .flat_map(keys_of)
            .filter(|(key, _)| *key != "kind")
            .collect(),
        _ => Vec::new(),
    }
}

fn keys_of(table: &Json) -> impl Iterator<Item = (&str, &Json)> {
    let all = table.get("properties").and_then(Json::as_object);
    all.into_iter()
        .flatten()
        .map(|(key, it)| (key.as_str(), it))
}

/// A path with entry 0 in place of every other.
fn with_first_entries(path: &str) -> String {
    let mut first = String::new();
    for step in super::path::steps(path) {
        let is_index = step.bytes().all(|byte| byte.is_ascii_digit());
        push_step(&mut first, if is_index { FIRST } else { &step });
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format;

    fn elsewhere(written: &str, value: &Value, within: &str) -> Vec<String> {
        let keys = Keys::below(format::raw(), &Reading::new(format::raw()));
        keys.elsewhere((written, value), within)
            .map_or_else(Vec::new, |(_, paths)| paths)
    }

    #[test]
    fn a_key_is_known_by_its_last_step() {
        let (number, table) = (Value::Integer(20), Value::Table(Vec::new()));
        assert_eq!(elsewhere("links", &number, ""), ["chain.links"]);
        assert_eq!(elsewhere("Pretension", &number, ""), ["route.pretension"]);
        assert_eq!(
            elsewhere("teeth", &number, ""),
            ["sprockets[0].teeth", "gears[0].teeth"]
        );
        assert_eq!(elsewhere("teeth", &table, ""), ["contact.teeth"]);
        assert_eq!(elsewhere("xyzzy", &number, ""), [""; 0]);
    }

    /// A table that has the key further down is more likely to be meant than one elsewhere.
    #[test]
    fn keys_below_the_table_go_first() {
        let number = Value::Float(0.1);
        let preload = elsewhere("preload", &number, "tensioners[3]");
        assert_eq!(preload, ["tensioners[3].push.preload"]);
        let friction = elsewhere("friction", &Value::Table(Vec::new()), "contact");
        assert!(
            friction.contains(&"contact.teeth.friction".to_owned()),
            "{friction:?}"
        );
        assert!(
            friction.iter().all(|path| path.starts_with("contact.")),
            "{friction:?}"
        );
    }
}
