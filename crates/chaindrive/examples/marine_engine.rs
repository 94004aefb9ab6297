//! The marine engine drive for one second: `cargo run --release --example marine_engine`.

use chaindrive::{Run, Scene, Simulation, Summary};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "marine_engine".into());
    let drive = Scene::preset(&name)?.drive()?;
    let run = Run {
        until: 1.0,
        every: 1e-3,
        step: std::env::args().nth(2).and_then(|s| s.parse().ok()),
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run)?;
    for s in &simulation.assembled().statics {
        println!("{} {} {:.1e}", s.stage, s.iterations, s.residual);
    }
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
    }
    println!("{}", summary.report(&simulation));
    Ok(())
}
