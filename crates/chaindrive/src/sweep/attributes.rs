//! Attributes of the result of a sweep.

use serde_json::{Map, Value};

use super::{Sweep, VariantCounts};
use crate::record::Ending;
use crate::story::Story;

impl Sweep {
    /// Attributes of the result: scene, varied paths, methods, progress.
    pub fn attributes(
        &self,
        methods: &[String],
        finished: VariantCounts,
        ending: &Ending,
    ) -> Map<String, Value> {
        let scene = self.scene();
        let mut story = Story::of(scene.title(), ending);
        story.text("scene_name", scene.name());
        story.text("scene", scene.text());
        match methods {
            [] => {
                let suggested = scene.run_defaults().method.unwrap_or_default();
                story.text("method", suggested.name());
            }
            used => story.text("method", &used.join(", ")),
        }
        story.list("swept", self.dimensions().iter().map(|d| d.path.as_str()));
        story.count("variants", self.len() as u64);
        story.count("finished", finished.done as u64);
        story.count("failed", finished.failed as u64);
        story.count("distrusted", finished.distrusted as u64);
        story.0
    }
}
