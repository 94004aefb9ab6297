//! Samples of channels, one row after the other.

use std::time::Duration;

use chaindrive::channel::labels;
use chaindrive::{Channel, SimulationError, View};
use js_sys::Float64Array;
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;
use web_time::Instant;

use crate::memory::view;
use crate::simulation::Simulation;
use crate::thrown::thrown;

/// Channels of a simulation, sampled at even intervals while it is moved on.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Recorder {
    seen: View,
    labels: String,
    every: f64,
    /// Time of sample 0 \[s\].
    begin: f64,
    /// Samples taken so far.
    taken: u64,
    times: Vec<f64>,
    rows: Vec<f64>,
}

#[wasm_bindgen]
impl Recorder {
    /// A recorder from the last reading on.
    ///
    /// @param channels their names, with commas between them
    /// @param every interval of samples \[s\]
    ///
    /// # Errors
    /// A channel that is unknown, or that the drive does not have.
    #[wasm_bindgen(constructor)]
    pub fn new(simulation: &mut Simulation, channels: &str, every: f64) -> Result<Self, JsValue> {
        let named = channels
            .split(',')
            .map(|name| Channel::from_name(name.trim()));
        let channels: Vec<Channel> = named.collect::<Result<_, _>>().map_err(thrown)?;
        if !(every > 0.0 && every.is_finite()) {
            let error = SimulationError::Setting {
                name: "every",
                value: every,
                allowed: "positive",
            };
            return Err(thrown(error));
        }
        let system = simulation.moving.system();
        let labels = channels.iter().map(|channel| {
            json!({
                "channel": channel.name(),
                "name": channel.description(),
                "unit": channel.unit_in(system),
                "labels": labels(channel.axis(), system),
            })
        });
        Ok(Self {
            labels: labels.collect::<Value>().to_string(),
            begin: simulation.moving.read_at(),
            seen: simulation.moving.view(&channels).map_err(thrown)?,
            every,
            taken: 0,
            times: Vec::new(),
            rows: Vec::new(),
        })
    }

    /// Numbers in a sample.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> usize {
        self.seen.all().len()
    }

    /// First number of every channel in a sample, and the end of the last one.
    pub fn columns(&self) -> Vec<usize> {
        let channels = 0..self.seen.channels().len();
        let mut columns: Vec<usize> = channels.map(|it| self.seen.range(it).start).collect();
        columns.push(self.width());
        columns
    }

    /// Names of the numbers of a sample, in the order of `columns`: JSON, `[{"channel", "name", "unit", "labels"}]`. Labels are null for a scalar; where
    /// units differ from entry to entry, all of them stand in `unit`, with commas between them.
    pub fn labels(&self) -> String {
        self.labels.clone()
    }

    /// Moves a simulation on to a time \[s\] and takes the samples on the way, for at most about `budget` of wall time \[ms\]; tells whether the time
    /// is reached.
    ///
    /// # Errors
    /// A time before the last reading; the motion ceases to be finite.
    pub fn advance(
        &mut self,
        simulation: &mut Simulation,
        until: f64,
        budget: f64,
    ) -> Result<bool, JsValue> {
        let budget = Duration::try_from_secs_f64(1e-3 * budget).unwrap_or_default();
        let begun = Instant::now();
        let stop = || begun.elapsed() >= budget;
        loop {
            // Counted, not summed.
            let next = self.begin + self.taken as f64 * self.every;
            let to = next.min(until);
            match simulation.moving.move_to(to, &stop) {
                Ok(()) => {}
                Err(SimulationError::Interrupted) => return Ok(false),
                Err(error) => return Err(thrown(error)),
            }
            if next > until {
                return Ok(true);
            }
            simulation.moving.read_into(&mut self.seen);
            self.times.push(to);
            self.rows.extend_from_slice(self.seen.all());
            self.taken += 1;
            if stop() {
                return Ok(to >= until);
            }
        }
    }

    /// Times of the samples since the last `clear` \[s\], (samples,).
    pub fn times(&self) -> Float64Array {
        view(&self.times)
    }

    /// Values of the samples since the last `clear`, (samples, width).
    pub fn rows(&self) -> Float64Array {
        view(&self.rows)
    }

    /// Forgets the samples; the next ones go on at even intervals.
    pub fn clear(&mut self) {
        self.times.clear();
        self.rows.clear();
    }
}
