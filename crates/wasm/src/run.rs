//! Whole runs, judged.

use chaindrive::{Memory, Request, SettingValue, Settings, Stop, execute};
use js_sys::Function;
use serde_json::Value;
use wasm_bindgen::prelude::*;

use crate::drive::Drive;
use crate::thrown::thrown;

/// A run that has ended, with what it says of itself.
#[wasm_bindgen]
#[derive(Debug)]
pub struct RunReport {
    attributes: Value,
    failure: Option<String>,
}

/// Tells a page how far a run is.
struct Told(Option<Function>);

impl chaindrive::Onlooker for Told {
    fn stop(&self) -> bool {
        false
    }

    fn see(&self, simulation: &chaindrive::Simulation) {
        if let Some(told) = &self.0 {
            // What a page does with it does not concern the run.
            told.call1(&JsValue::NULL, &simulation.progress().into())
                .ok();
        }
    }
}

#[wasm_bindgen]
impl RunReport {
    /// Carries out a run from start to end: run-in, choice of method and step, samples, estimate of the error, verdict.
    ///
    /// @param until end of the run \[s\]; that of the scene when absent
    /// @param progress called with the share done, 0 to 1
    ///
    /// # Errors
    /// The run cannot begin.
    #[wasm_bindgen(constructor)]
    pub fn new(
        drive: &Drive,
        until: Option<f64>,
        progress: Option<Function>,
    ) -> Result<Self, JsValue> {
        let settings = match until {
            Some(until) => Settings::default().with("until", SettingValue::Number(until)),
            None => Settings::default(),
        };
        let request = Request::new(&drive.scene, &settings).map_err(thrown)?;
        let mut memory = Memory::default();
        let report = execute(&request, &mut memory, &Told(progress)).map_err(thrown)?;
        let failure = match report.stop {
            Stop::Failed(error) => Some(error.to_string()),
            Stop::End | Stop::Interrupted => None,
        };
        Ok(Self {
            attributes: Value::Object(report.attributes),
            failure,
        })
    }

    /// The page of the run: what a chain engineer asks of it, verdict first.
    #[wasm_bindgen(getter)]
    pub fn summary(&self) -> String {
        self.attributes["summary"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }

    /// Attributes of the result, as in its stores: JSON.
    #[wasm_bindgen(getter)]
    pub fn attributes(&self) -> String {
        self.attributes.to_string()
    }

    /// Reason why the run broke off; undefined where it did not.
    #[wasm_bindgen(getter)]
    pub fn failure(&self) -> Option<String> {
        self.failure.clone()
    }
}
