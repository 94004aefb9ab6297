//! A preset for one second, with its summary:
//! `cargo run --release --example marine_engine [PRESET]`.

use std::io::Write;

use chaindrive::{Run, Scene, Simulation, Summary};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1);
    let scene = Scene::preset(name.as_deref().unwrap_or("marine_engine"))?;
    let run = Run::suggested(&scene.run_defaults());
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
    }
    writeln!(std::io::stdout(), "{}", summary.report(&simulation))?;
    Ok(())
}
