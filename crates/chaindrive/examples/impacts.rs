//! Impacts of rollers on teeth, one by one: `cargo run --release --example impacts`.

use std::io::Write;

use chaindrive::{Run, Scene, Simulation};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drive = Scene::preset("marine_two_sprockets")?.drive()?;
    let run = Run {
        until: 30e-3,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run)?;
    let names = simulation.system().sprocket_names();
    while simulation.next_sample()?.is_some() {
        for impact in simulation.impacts() {
            writeln!(
                std::io::stdout(),
                "{:6.2} ms  {:9} {:6.3} m/s {:7.1} kN",
                impact.time * 1e3,
                names[impact.sprocket],
                impact.speed,
                impact.peak_force * 1e-3
            )?;
        }
    }
    Ok(())
}
