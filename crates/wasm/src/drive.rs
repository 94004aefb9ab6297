//! Drives: from text, changed, described, laid out, drawn.

use chaindrive::scene::tunable_places;
use chaindrive::{Description, Run, Scene, assemble, design, draw, precision};
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

use crate::thrown::{of_scene, thrown};

/// A scene, and the drive that it describes.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Drive {
    pub(crate) scene: Scene,
    pub(crate) drive: chaindrive::Drive,
}

impl Drive {
    fn of(scene: Scene) -> Result<Self, JsValue> {
        let drive = scene.drive().map_err(of_scene)?;
        Ok(Self { scene, drive })
    }

    /// The run that the scene suggests.
    pub(crate) fn run(&self) -> Run {
        Run::suggested(&self.scene.run_defaults())
    }
}

#[wasm_bindgen]
impl Drive {
    /// Reads a scene, TOML, or JSON where it begins with a brace.
    ///
    /// @param name what messages call the text
    ///
    /// # Errors
    /// Thrown as `SceneError`: `problems` has every mistake with `path`, `message`, `hint`, `line`, `columns` \[first, last\] from 1 and `excerpt`, the
    /// line with a caret.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str, name: &str) -> Result<Self, JsValue> {
        Self::of(Scene::from_text(text, name).map_err(of_scene)?)
    }

    /// A preset.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn preset(name: &str) -> Result<Self, JsValue> {
        Self::of(Scene::preset(name).map_err(of_scene)?)
    }

    /// A drive with one value replaced.
    ///
    /// @param path such as `sprockets.driver.teeth`
    /// @param json its value as JSON, numbers in SI units, texts with a unit
    ///
    /// # Errors
    /// As the constructor.
    pub fn replace(&self, path: &str, json: &str) -> Result<Self, JsValue> {
        let value = serde_json::from_str(json).map_err(thrown)?;
        Self::of(self.scene.replace_json(path, &value).map_err(of_scene)?)
    }

    /// A drive with several values replaced, which may be right together only, as teeth and links.
    ///
    /// @param changes JSON, `[[path, value], …]`, as `replace` has them
    ///
    /// # Errors
    /// As the constructor.
    #[wasm_bindgen(js_name = replaceAll)]
    pub fn replace_all(&self, changes: &str) -> Result<Self, JsValue> {
        let changes: Vec<(String, Value)> = serde_json::from_str(changes).map_err(thrown)?;
        let mut scene = self.scene.clone();
        for (path, value) in changes {
            scene = scene.replace_json(&path, &value).map_err(of_scene)?;
        }
        Self::of(scene)
    }

    /// The text that reproduces the drive.
    #[wasm_bindgen(getter)]
    pub fn text(&self) -> String {
        self.scene.text().to_owned()
    }

    /// Its name in messages.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.scene.name().to_owned()
    }

    /// Its title, in a line; may be empty.
    #[wasm_bindgen(getter)]
    pub fn title(&self) -> String {
        self.scene.title().to_owned()
    }

    /// The scene with every default written out, in SI units: JSON.
    ///
    /// # Errors
    /// As the constructor.
    pub fn resolved(&self) -> Result<String, JsValue> {
        let resolved = self.scene.resolved().map_err(of_scene)?;
        Ok(resolved.json().to_string())
    }

    /// Places of the parameters that may be listed under `tunable`, to be set while the drive moves: JSON, a list of texts.
    pub fn tunables(&self) -> String {
        json!(tunable_places(&self.drive)).to_string()
    }

    /// Description of the drive at rest, to print.
    ///
    /// # Errors
    /// The chain does not close, or does not settle.
    pub fn describe(&self) -> Result<String, JsValue> {
        Ok(self.description()?.to_string())
    }

    /// The same as JSON.
    ///
    /// # Errors
    /// As `describe`.
    #[wasm_bindgen(js_name = describeJson)]
    pub fn describe_json(&self) -> Result<String, JsValue> {
        serde_json::to_string(&self.description()?).map_err(thrown)
    }

    fn description(&self) -> Result<Description, JsValue> {
        let described = Description::of(&self.drive, &self.run()).map_err(thrown)?;
        Ok(described.unless_chosen_for(self.scene.run_defaults().chosen_accuracy()))
    }

    /// Layouts of its chains, also where one does not close: JSON, `[{"pitch", "links", "misfit", "counts", "stops", "spans", "fits", …}]`, lengths in
    /// m, angles in rad.
    ///
    /// # Errors
    /// A route that no chain can be laid along.
    pub fn layout(&self) -> Result<String, JsValue> {
        let layouts = design::of(&self.drive).map_err(thrown)?;
        serde_json::to_string(&layouts).map_err(thrown)
    }

    /// Drawing of the drive at rest, as it is laid where it does not settle: SVG.
    ///
    /// # Errors
    /// An outline that is none.
    pub fn svg(&self) -> Result<String, JsValue> {
        let figure = self.drive.figure().map_err(thrown)?;
        Ok(draw::svg(&figure, &figure.start(), self.scene.title()))
    }

    /// Horizon of its waveforms, by a twin that starts 1e-12 m apart: JSON, `{"time" [s], "sentence"}`, time null where there is no end. It
    /// takes the time of two runs.
    ///
    /// @param follow time for which the twins are followed \[s\]
    ///
    /// # Errors
    /// The drive does not assemble, or its motion does not go on.
    pub fn horizon(&self, follow: f64) -> Result<String, JsValue> {
        let start = assemble(&self.drive, &|| false).map_err(thrown)?;
        let found = precision::horizon(&start, &self.run(), follow, &|| false);
        let found = found.map_err(thrown)?;
        Ok(json!({ "time": found.all.time(), "sentence": found.sentence() }).to_string())
    }
}
