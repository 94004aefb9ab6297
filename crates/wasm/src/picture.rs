//! Frames of a drive in motion, as a page draws them.

use chaindrive::Instant;
use chaindrive_replay as replay;
use js_sys::Float64Array;
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

use crate::memory::view;
use crate::simulation::Simulation;
use crate::thrown::thrown;

/// The drive as it looks, at one instant after the other.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Picture {
    pub(crate) shown: replay::Picture,
    roller_x: Vec<f64>,
    roller_y: Vec<f64>,
    link_tension: Vec<f64>,
    contact_force: Vec<f64>,
}

#[wasm_bindgen]
impl Picture {
    /// The picture of a simulation, at its last reading.
    ///
    /// # Errors
    /// An outline that is none.
    #[wasm_bindgen(constructor)]
    pub fn new(simulation: &mut Simulation) -> Result<Self, JsValue> {
        // Nobody may have read it yet: a view alone is not what is shown.
        let now = simulation.moving.read_at();
        simulation.moving.advance_to(now).map_err(thrown)?;
        let figure = simulation.moving.assembled().figure().map_err(thrown)?;
        let mut picture = Self {
            shown: replay::Picture::of(figure).map_err(thrown)?,
            roller_x: Vec::new(),
            roller_y: Vec::new(),
            link_tension: Vec::new(),
            contact_force: Vec::new(),
        };
        picture.take(simulation)?;
        Ok(picture)
    }

    /// Constant parts of the picture: JSON, `{"bodies": [{"name", "kind", "outlines": [{"points" [m], "closed"}]}], "chains": [{"name", "rollers", "links",
    /// "pitch" [m], "roller_radius" [m], "plate_height" [m], …}]}`. Outlines are in the frame of their body.
    pub fn outlines(&self) -> String {
        let outline =
            |line: &replay::Outline| json!({ "points": line.points, "closed": line.is_closed });
        let bodies = self.shown.bodies.iter().map(|body| {
            let outlines: Value = body.outlines.iter().map(outline).collect();
            json!({ "name": body.name, "kind": body.kind, "outlines": outlines })
        });
        let bodies: Value = bodies.collect();
        json!({ "bodies": bodies, "chains": self.shown.chains }).to_string()
    }

    /// Takes the frame of the last reading of a simulation.
    ///
    /// # Errors
    /// The simulation is of another drive.
    pub fn take(&mut self, simulation: &mut Simulation) -> Result<(), JsValue> {
        simulation.moving.refresh();
        let seen = simulation.moving.observation();
        let moved = self
            .shown
            .move_to(&Instant::of(seen), Some(&seen.contact_force));
        moved.map_err(thrown)?;
        self.roller_x.clone_from(&seen.roller_x);
        self.roller_y.clone_from(&seen.roller_y);
        self.link_tension.clone_from(&seen.link_tension);
        self.contact_force.clone_from(&seen.contact_force);
        Ok(())
    }

    /// Place \[m\] and angle \[rad\] of every body, (bodies, 3).
    pub fn placements(&self) -> Float64Array {
        view(self.shown.placements())
    }

    /// Roller centres x \[m\], (rollers,).
    #[wasm_bindgen(js_name = rollerX)]
    pub fn roller_x(&self) -> Float64Array {
        view(&self.roller_x)
    }

    /// Roller centres y \[m\], (rollers,).
    #[wasm_bindgen(js_name = rollerY)]
    pub fn roller_y(&self) -> Float64Array {
        view(&self.roller_y)
    }

    /// Tension of the links \[N\], (links,).
    #[wasm_bindgen(js_name = linkTension)]
    pub fn link_tension(&self) -> Float64Array {
        view(&self.link_tension)
    }

    /// Force of teeth on rollers \[N\], (rollers,).
    #[wasm_bindgen(js_name = contactForce)]
    pub fn contact_force(&self) -> Float64Array {
        view(&self.contact_force)
    }

    /// Direction in which teeth press on rollers \[rad\], (rollers,); where nothing presses, the last one before.
    #[wasm_bindgen(js_name = contactDirection)]
    pub fn contact_direction(&self) -> Float64Array {
        view(self.shown.directions())
    }
}
