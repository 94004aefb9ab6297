//! The lowest natural frequencies of a drive at rest: `cargo run --release --example modes`.

use std::io::Write;

use chaindrive::Scene;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drive = Scene::preset("marine_two_sprockets")?.drive()?;
    let modes = drive.assemble()?.modes()?;
    for frequency in modes.frequencies().iter().take(8) {
        writeln!(std::io::stdout(), "{frequency:8.2} Hz")?;
    }
    Ok(())
}
