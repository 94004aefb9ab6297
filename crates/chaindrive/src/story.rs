//! Attributes of a result, and its ending.

use serde_json::{Map, Value};

use crate::{Build, Origin};

/// Tells a result of this program from any other group.
pub(crate) const FORMAT: &str = "chaindrive";

/// Ending of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Ending {
    /// It has not.
    #[default]
    None,
    /// The end was reached.
    Complete,
    /// Somebody stopped it.
    Interrupted,
    /// The simulation could not go on; with the reason.
    Failed(String),
}

impl Ending {
    /// Its word in results.
    pub fn status(&self) -> &'static str {
        match self {
            Self::None => "running",
            Self::Complete => "complete",
            Self::Interrupted => "interrupted",
            Self::Failed(_) => "failed",
        }
    }
}

/// Attributes in the order of their telling.
#[derive(Default)]
pub(crate) struct Story(pub(crate) Map<String, Value>);

impl Story {
    /// Title and format, and how far the result is.
    pub(crate) fn of(title: &str, ending: &Ending) -> Self {
        let mut story = Self(Map::new());
        story.text("title", title);
        story.text("format", FORMAT);
        let origin = Origin::here();
        story.text("chaindrive_version", Build::here().version);
        story.text("chaindrive_build", &origin.build);
        story.text("chaindrive_profile", Build::here().profile);
        story.text("instruction_set", &origin.instruction_set);
        story.text("status", ending.status());
        story.count("complete", u64::from(*ending == Ending::Complete));
        if let Ending::Failed(reason) = ending {
            story.text("failure", reason);
        }
        story
    }

    pub(crate) fn text(&mut self, name: &str, text: &str) {
        self.0.insert(name.into(), text.into());
    }

    pub(crate) fn count(&mut self, name: &str, count: u64) {
        self.0.insert(name.into(), count.into());
    }

    /// A number; JSON has none for infinity, such as the smallest of no steps.
    pub(crate) fn number(&mut self, name: &str, number: f64) {
        if number.is_finite() {
            self.0.insert(name.into(), number.into());
        }
    }

    pub(crate) fn list<T: Into<Value>>(&mut self, name: &str, items: impl IntoIterator<Item = T>) {
        let items = items.into_iter().map(Into::into).collect();
        self.0.insert(name.into(), Value::Array(items));
    }
}
