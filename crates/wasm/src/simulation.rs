//! A drive in motion.

use chaindrive::{Control, Course, Run, RunIn};
use serde_json::json;
use wasm_bindgen::prelude::*;

use crate::drive::Drive;
use crate::thrown::thrown;

/// A drive in motion: read at any time, inputs set, states kept.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Simulation {
    pub(crate) moving: chaindrive::Simulation,
}

/// A simulation as it was.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Snapshot(chaindrive::Snapshot);

#[wasm_bindgen]
impl Snapshot {
    /// The snapshot that was written down.
    ///
    /// # Errors
    /// The bytes are damaged, or of another version.
    #[wasm_bindgen(constructor)]
    pub fn new(bytes: &[u8]) -> Result<Self, JsValue> {
        chaindrive::Snapshot::from_bytes(bytes)
            .map(Self)
            .map_err(thrown)
    }

    /// Its bytes, for a file or another instance of the module.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self) -> Vec<u8> {
        self.0.to_bytes()
    }
}

#[wasm_bindgen]
impl Simulation {
    /// Assembles a drive and starts it, with the method and step of its `[run]`, or those that suit its chain.
    ///
    /// @param runIn time simulated before t = 0 \[s\]; 0 begins at rest in the chain
    ///
    /// # Errors
    /// The chain does not close or settle, a setting is out of range, the step is unstable.
    #[wasm_bindgen(constructor)]
    pub fn new(
        drive: &Drive,
        #[wasm_bindgen(js_name = runIn)] run_in: f64,
    ) -> Result<Self, JsValue> {
        let run_in = if run_in == 0.0 {
            RunIn::None
        } else {
            RunIn::Time(run_in)
        };
        let run = Run {
            run_in,
            ..drive.run()
        };
        let mut moving = chaindrive::Simulation::start(&drive.drive, &run).map_err(thrown)?;
        // The ledger counts from here.
        moving.advance_to(0.0).map_err(thrown)?;
        Ok(Self { moving })
    }

    /// Time of the last reading \[s\].
    #[wasm_bindgen(getter)]
    pub fn time(&self) -> f64 {
        self.moving.read_at()
    }

    /// Takes a number of steps of the method; tells the time there \[s\].
    ///
    /// # Errors
    /// The motion ceases to be finite.
    pub fn step(&mut self, steps: u32) -> Result<f64, JsValue> {
        self.moving.step(steps.into()).map_err(thrown)
    }

    /// Moves on to a time \[s\], which is read there.
    ///
    /// # Errors
    /// A time before the last reading; the motion ceases to be finite.
    #[wasm_bindgen(js_name = advanceTo)]
    pub fn advance_to(&mut self, time: f64) -> Result<(), JsValue> {
        self.moving.move_to(time, &|| false).map_err(thrown)
    }

    /// Sets what acts on the drive, from the last reading on.
    ///
    /// @param kind `torque` \[N m\], `speed` \[rad/s\], `angle` \[rad\] of a shaft; `force` \[N, N m\] on a tensioner; `force_x`, `force_y` \[N\] on the
    /// centre of a sprocket or on a roller; `centre_x`, `centre_y` \[m/s²\] of a sprocket; `parameter`, one that the scene lists under `tunable`
    /// @param name of the shaft, sprocket or tensioner; `rollers.NUMBER`; or place of the parameter
    /// @param value in SI units
    /// @param over time within which it comes there, along a straight line \[s\]; it jumps when absent
    ///
    /// # Errors
    /// Nothing has this name, or it cannot be set; a value that is not finite.
    pub fn set(
        &mut self,
        kind: &str,
        name: &str,
        value: f64,
        over: Option<f64>,
    ) -> Result<(), JsValue> {
        self.set_at(self.time(), kind, name, value, over)
    }

    /// Plans a change for a time \[s\] not before the last reading; see `set`.
    ///
    /// # Errors
    /// As `set`; a time before the last reading.
    #[wasm_bindgen(js_name = setAt)]
    pub fn set_at(
        &mut self,
        time: f64,
        kind: &str,
        name: &str,
        value: f64,
        over: Option<f64>,
    ) -> Result<(), JsValue> {
        let control = Control::named(kind, name).map_err(thrown)?;
        let course = Course {
            over: over.unwrap_or(0.0),
            ..Course::from(value)
        };
        self.moving.set_at(time, &control, course).map_err(thrown)
    }

    /// The state, to come back to or to write down.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(self.moving.snapshot())
    }

    /// Goes back to a state of this drive.
    ///
    /// # Errors
    /// The snapshot is of another drive or method.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), JsValue> {
        self.moving.restore(&snapshot.0).map_err(thrown)
    }

    /// Method and counts of the time stepping: JSON, `{"method", "step" [s], "steps", "evaluations", "rejections", "stepping_time" [s]}`.
    pub fn statistics(&self) -> String {
        let counts = self.moving.statistics();
        let method = self.moving.method();
        json!({
            "method": chaindrive::Stepping::from(method).name(),
            "step": method.step(),
            "steps": counts.steps,
            "evaluations": counts.evaluations,
            "rejections": counts.rejections,
            "stepping_time": self.moving.stepping_time(),
        })
        .to_string()
    }
}
