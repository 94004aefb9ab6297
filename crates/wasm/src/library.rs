//! Knowledge that needs no drive: presets, chains of the catalogue, layouts, channels.

use chaindrive::catalogue::{Number, catalogue};
use chaindrive::{Channel, InstructionSet, Scene, design, scene};
use serde_json::{Map, Value, json};
use wasm_bindgen::prelude::*;

use crate::thrown::{of_scene, thrown};

/// Version of chaindrive.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Vector registers that kernels run on: `simd128`, or `baseline` in a module without them.
#[wasm_bindgen(js_name = instructionSet)]
pub fn instruction_set() -> String {
    InstructionSet::in_use().map_or_else(ToString::to_string, |set| set.name().to_owned())
}

/// The presets: JSON, `[{"name", "about"}]`.
#[wasm_bindgen]
pub fn presets() -> String {
    let all = scene::presets()
        .iter()
        .map(|(name, about)| json!({ "name": name, "about": about }));
    all.collect::<Value>().to_string()
}

/// The text of a preset.
///
/// # Errors
/// There is none of this name.
#[wasm_bindgen(js_name = presetText)]
pub fn preset_text(name: &str) -> Result<String, JsValue> {
    let preset = Scene::preset(name).map_err(of_scene)?;
    Ok(preset.text().to_owned())
}

/// Chains of the catalogue in SI units: JSON, an object a chain with `name`, `ansi`, `kind` and the numbers that the trade knows of it.
#[wasm_bindgen(js_name = catalogueChains)]
pub fn catalogue_chains() -> String {
    let chains = catalogue().iter().map(|chain| {
        let mut told = Map::new();
        told.insert("name".into(), chain.name.clone().into());
        told.insert("ansi".into(), chain.ansi.clone().into());
        told.insert("kind".into(), chain.kind.clone().into());
        for number in Number::ALL {
            told.insert(number.name().into(), chain.number(number).into());
        }
        Value::Object(told)
    });
    chains.collect::<Value>().to_string()
}

/// Channels that a drive may have: JSON, `[{"name", "unit", "about"}]`.
#[wasm_bindgen]
pub fn channels() -> String {
    let all = Channel::ALL.iter().map(|channel| {
        json!({ "name": channel.name(), "unit": channel.unit(), "about": channel.description() })
    });
    all.collect::<Value>().to_string()
}

/// The layout of two sprockets: JSON, see `Drive.layout`.
///
/// @param pitch pitch of the chain \[m\]
/// @param distance of the centres \[m\]; for the number of links when absent
/// @param links number of links of the chain
///
/// # Errors
/// No chain lies around such sprockets.
#[wasm_bindgen(js_name = twoSprockets)]
pub fn two_sprockets(
    first: u32,
    second: u32,
    pitch: f64,
    distance: Option<f64>,
    links: Option<u32>,
) -> Result<String, JsValue> {
    let layout = design::of_two_sprockets([first, second], pitch, distance, links);
    serde_json::to_string(&layout.map_err(thrown)?).map_err(thrown)
}
