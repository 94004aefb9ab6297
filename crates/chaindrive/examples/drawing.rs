//! A drive as it stands before it moves, as SVG: `cargo run --release --example drawing > drive.svg`.

use std::io::Write;

use chaindrive::{Scene, draw};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::preset("timing_drive")?;
    let figure = scene.drive()?.figure()?;
    let picture = draw::svg(&figure, &figure.start(), scene.title());
    write!(std::io::stdout(), "{picture}")?;
    Ok(())
}
