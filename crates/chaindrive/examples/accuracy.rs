//! Method and step that keep an error of 2 %, and what they cost: `cargo run --release --example accuracy`.

use std::io::Write;

use chaindrive::{Memory, Request, Scene, SettingValue, Settings, execute};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let settings = Settings::default()
        .with("until", SettingValue::Number(20e-3))
        .with("run_in", SettingValue::Number(0.0))
        .with("accuracy", SettingValue::Number(0.02));
    let request = Request::new(&Scene::preset("marine_two_sprockets")?, &settings)?;
    let report = execute(&request, &mut Memory::default(), &|| false)?;
    let mut out = std::io::stdout();
    if let Some(choice) = report.choice {
        writeln!(out, "{}", choice.reason())?;
    }
    writeln!(out, "{} steps", report.simulation.statistics().steps)?;
    Ok(())
}
