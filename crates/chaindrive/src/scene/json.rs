//! Places of values in a text of JSON. The parser of the values knows none.

use std::collections::HashSet;

use jsonc_parser::ast::Value as Json;
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

use super::error::Problem;
use super::text_span::{Lines, TextSpan};
use super::tree::{Node, Value};

impl Lines<'_> {
    /// Gives a tree the places of its values in its text.
    ///
    /// # Errors
    /// A key that stands twice in an object: readers of JSON differ in which of the values they take.
    pub(super) fn place_json(&self, tree: &mut Node, text: &str) -> Result<(), Problem> {
        let read = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default());
        // The text has been read before. Nothing in it has a place where this reader knows less.
        let Some(whole) = read.ok().and_then(|read| read.value) else {
            return Ok(());
        };
        self.place(tree, &whole)?;
        // What is missing in a scene is missing everywhere in it.
        tree.place = Some(TextSpan::line(1));
        Ok(())
    }

    fn place(&self, node: &mut Node, json: &Json<'_>) -> Result<(), Problem> {
        let of = |part: &dyn Ranged| Some(self.at(part.start()..part.end()));
        node.place = of(json);
        match (&mut node.value, json) {
            (Value::List(items), Json::Array(array)) => {
                for (item, json) in items.iter_mut().zip(&array.elements) {
                    self.place(item, json)?;
                }
            }
            (Value::Table(entries), Json::Object(object)) => {
                let mut known = HashSet::new();
                for property in &object.properties {
                    let key = property.name.as_str();
                    if !known.insert(key) {
                        let message = format!("the key `{key}` stands twice in this table");
                        let problem = Problem::new("", of(&property.name), message);
                        return Err(problem.hint("keep one of them"));
                    }
                }
                // Entries that are null are absent.
                let present = |json: &Json<'_>| json.as_null_keyword().is_none();
                let properties = object.properties.iter().filter(|it| present(&it.value));
                for (entry, property) in entries.iter_mut().zip(properties) {
                    entry.place = of(&property.name);
                    self.place(&mut entry.node, &property.value)?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}
