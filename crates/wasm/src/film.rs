//! The last while of a drive in motion, as a page that plays it.

use chaindrive_replay::{LastFrames, page};
use wasm_bindgen::prelude::*;

use crate::picture::Picture;
use crate::simulation::Simulation;

/// The last frames that were taken of a picture.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Film(LastFrames);

#[wasm_bindgen]
impl Film {
    /// A film without frames.
    ///
    /// @param most frames that it keeps; of more than these the first are forgotten
    #[wasm_bindgen(constructor)]
    pub fn new(picture: &Picture, simulation: &Simulation, most: u32) -> Self {
        let spans = simulation.moving.assembled().system.span_names();
        Self(LastFrames::of(&picture.shown, &spans, most as usize))
    }

    /// Takes the frame that the picture shows, of the last reading of the simulation.
    pub fn take(&mut self, picture: &Picture, simulation: &Simulation) {
        let seen = simulation.moving.observation();
        self.0.take(&picture.shown, seen);
    }

    /// The replay: HTML that needs nothing else.
    pub fn page(&self, title: &str) -> String {
        page(&self.0.film(title))
    }
}
