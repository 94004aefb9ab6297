//! Method and step that keep an error of 2 %, and what they cost: `cargo run --release --example accuracy`.

use std::io::Write;

use chaindrive::{Given, Memory, Request, Scene, Settings, execute};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let settings = Settings::default()
        .with("until", Given::Number(20e-3))
        .with("run_in", Given::Number(0.0))
        .with("accuracy", Given::Number(0.02));
    let request = Request::new(&Scene::preset("marine_two_sprockets")?, &settings)?;
    let report = execute(&request, &mut Memory::default(), &|| false)?;
    let mut out = std::io::stdout();
    if let Some(choice) = report.choice {
        writeln!(out, "{}", choice.reason())?;
    }
    writeln!(out, "{} steps", report.simulation.statistics().steps)?;
    Ok(())
}
