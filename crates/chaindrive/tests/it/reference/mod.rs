//! The references in `tests/validation`, by their place in the file.
#![allow(dead_code, reason = "every test uses its part")]

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

/// One validation case.
pub(crate) struct Reference {
    id: String,
    value: Value,
}

impl Reference {
    /// Reads `tests/validation/<id>/reference.json`.
    pub(crate) fn read(id: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../tests/validation")
            .join(id)
            .join("reference.json");
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let value =
            serde_json::from_str(&text).unwrap_or_else(|error| panic!("{id} is no JSON: {error}"));
        Self {
            id: id.to_owned(),
            value,
        }
    }

    fn at(&self, place: &str) -> &Value {
        let mut pointer = String::new();
        for key in place.split('.') {
            write!(pointer, "/{key}").expect("a text grows");
        }
        let found = self.value.pointer(&pointer);
        found.unwrap_or_else(|| panic!("{} has no `{place}`", self.id))
    }

    /// A number, such as `inputs.pitch`.
    pub(crate) fn number(&self, place: &str) -> f64 {
        let found = self.at(place).as_f64();
        found.unwrap_or_else(|| panic!("{}: `{place}` is no number", self.id))
    }

    /// A list of numbers.
    pub(crate) fn list(&self, place: &str) -> Vec<f64> {
        serde_json::from_value(self.at(place).clone())
            .unwrap_or_else(|error| panic!("{}: `{place}`: {error}", self.id))
    }

    /// A list of lists of numbers, such as `expected.rows`.
    pub(crate) fn table(&self, place: &str) -> Vec<Vec<f64>> {
        serde_json::from_value(self.at(place).clone())
            .unwrap_or_else(|error| panic!("{}: `{place}`: {error}", self.id))
    }
}
