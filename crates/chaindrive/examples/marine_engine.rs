//! A preset for one second, with its page:
//! `cargo run --release --example marine_engine [PRESET]`.

use std::io::Write;

use chaindrive::page::Page;
use chaindrive::{Run, Scene, Simulation, Summary, Verdict};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1);
    let scene = Scene::preset(name.as_deref().unwrap_or("marine_engine"))?;
    let run = Run {
        watched: true,
        ..Run::suggested(&scene.run_defaults())
    };
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    let mut summary = Summary::new(&simulation);
    while simulation.next_sample()?.is_some() {
        summary.take(&simulation);
    }
    summary.end(&simulation);
    let verdict = Verdict::of(&summary, &simulation, None, None, None);
    let page = Page::of(
        &verdict,
        &summary,
        &simulation,
        None,
        None,
        &scene.assumed()?,
    );
    writeln!(std::io::stdout(), "{page}")?;
    Ok(())
}
