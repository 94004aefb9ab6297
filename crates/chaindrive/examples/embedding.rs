//! A program with parts lists of its own asks for a run, shows how far it is, and may stop it:
//! `cargo run --release --example embedding`.

use std::cell::Cell;
use std::io::Write;

use chaindrive::{
    Memory, Onlooker, Request, Scene, SettingValue, Settings, Simulation, Stop, execute,
};
use serde_json::{Value, json};

/// A drive as the program knows it.
struct Conveyor {
    chain: &'static str,
    teeth: [u32; 2],
    links: u32,
    /// Speed of the motor \[rpm\].
    speed: f64,
    /// Torque of the load \[N m\].
    load: f64,
}

impl Conveyor {
    /// The drive as a scene.
    fn scene(&self) -> Value {
        json!({
            "title": "Conveyor",
            "chain": {"type": self.chain, "links": self.links},
            "sprockets": [
                {"name": "motor", "teeth": self.teeth[0], "centre": [0, 0],
                    "motion": {"kind": "constant", "speed": format!("{} rpm", self.speed)}},
                {"name": "belt", "teeth": self.teeth[1], "centre": ["0.75 m", 0], "inertia": "0.5 kg m^2",
                    "load": [{"kind": "constant", "torque": -self.load}]},
            ],
            "route": {"pretension": "500 N",
                "adjust": {"kind": "sprocket", "name": "belt", "direction": [1, 0], "within": "20 mm"}},
        })
    }
}

/// The window of the program: a bar, and a button that stops.
struct Window {
    shown: Cell<u32>,
    stop: bool,
}

impl Onlooker for Window {
    fn stop(&self) -> bool {
        self.stop
    }

    fn see(&self, simulation: &Simulation) {
        let quarter = if simulation.progress() < 1.0 { 1 } else { 4 };
        self.shown.set(self.shown.get().max(quarter));
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let conveyor = Conveyor {
        chain: "16B-1",
        teeth: [19, 19],
        links: 78,
        speed: 300.0,
        load: 40.0,
    };
    let scene = Scene::from_data(&conveyor.scene().to_string(), "conveyor")?;
    let settings = Settings::default()
        .with("until", SettingValue::Number(20e-3))
        .with("run_in", SettingValue::Number(0.0))
        .with("record", SettingValue::Names(vec!["span_tension".into()]));
    let window = Window {
        shown: Cell::new(0),
        stop: false,
    };
    let mut memory = Memory::default();
    let report = execute(&Request::new(&scene, &settings)?, &mut memory, &window)?;
    let told = match report.stop {
        Stop::End => format!("{} samples", memory.recording.len()),
        Stop::Interrupted => "stopped".to_owned(),
        Stop::Failed(error) => error.to_string(),
    };
    let mut out = std::io::stdout();
    writeln!(out, "{told}, {}", report.verdict.written().verdict)?;
    let extremes = report.summary.span_extremes();
    for (span, seen) in report.summary.spans.iter().zip(extremes) {
        writeln!(
            out,
            "{}: {:.0} to {:.0} N",
            span.name, seen.least, seen.greatest
        )?;
    }
    Ok(())
}
