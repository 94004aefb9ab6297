//! A run goes back to where it was, bit for bit: `cargo run --release --example snapshot`.

use std::io::Write;

use chaindrive::{Run, Scene, Simulation, Snapshot};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drive = Scene::preset("marine_two_sprockets")?.drive()?;
    let mut simulation = Simulation::start(&drive, &Run::default())?;
    simulation.advance_to(1e-3)?;
    let bytes = simulation.snapshot().to_bytes();
    let first = simulation.advance_to(2e-3)?.link_tension.clone();

    // Another process of the same build could do this.
    let mut again = Simulation::start(&drive, &Run::default())?;
    again.restore(&Snapshot::from_bytes(&bytes)?)?;
    let second = again.advance_to(2e-3)?.link_tension.clone();
    let same = first
        .iter()
        .zip(&second)
        .all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same, "the same bits");
    writeln!(
        std::io::stdout(),
        "{} bytes hold the drive at 1 ms",
        bytes.len()
    )?;
    Ok(())
}
