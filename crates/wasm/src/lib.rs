//! The core for browsers and Node: texts become drives, drives move, and what they do is told.
//!
//! ```text
//! text ──Drive──► described, laid out, drawn
//!          │
//!          └──Simulation──► Recorder: samples of channels · Picture: frames that a page draws · Snapshot
//! ```
//!
//! Quantities are in SI units, angles and torques counter-clockwise positive, as everywhere. Numbers cross as f64, arrays as views of the
//! memory of the module: a call that allocates may move it, and views have to be asked for anew. Errors are thrown as `Error`; those of a scene
//! have its mistakes as `problems`. Elsewhere than in WebAssembly the crate is empty.

#![cfg(target_family = "wasm")]

pub mod drive;
mod film;
pub mod library;
mod memory;
pub mod picture;
pub mod recorder;
pub mod run;
pub mod simulation;
mod thrown;

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn tell(message: &str);
}

/// Has a panic, which ends the module, say what it was.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|panic| tell(&format!("chaindrive: {panic}"))));
}
