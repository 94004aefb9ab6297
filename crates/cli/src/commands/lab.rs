//! `chaindrive lab`: a drive that a browser computes.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::output::{beside_program, new_file};
use crate::failure::Failure;
use crate::request::SceneArguments;
use crate::terminal::say;

/// Name of the page that `make lab` builds.
const PAGE: &str = "lab.html";

const LIVE: &str = "\
The page:
  One HTML file that needs no network and no installation: the drive moves while it is computed. Speeds, loads and
  centres follow a slider; other values start the drive anew. `?` lists the keys.";

/// Makes one HTML page in which a drive is computed while one looks at it.
#[derive(Debug, Args)]
#[command(after_help = LIVE)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// The page (.html)
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,

    /// The page without a scene, as `make lab` builds it; the one beside the program where it is absent
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,

    /// Replaces an earlier page of the same name
    #[arg(long)]
    overwrite: bool,

    /// Prints errors only
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn lab(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let output = &arguments.output;
    if output.extension().is_none_or(|it| it != "html") {
        return Err(Failure::Argument(format!(
            "{}: the name must end in .html",
            output.display()
        )));
    }
    let place = new_file(output, arguments.overwrite)?;
    let source = match &arguments.page {
        Some(page) => page.clone(),
        None => beside_program(
            PAGE,
            "--page",
            "this build has no lab: take a wheel, which has one, or build it: make lab",
        )?,
    };
    let page = built(&source)?;
    let scene = arguments.scene.load(interrupted)?;
    // What is wrong with a drive is told here, and not to whoever opens the page.
    scene.drive()?;
    let page = chaindrive_lab::with_scene(&page, scene.text(), scene.name()).ok_or_else(|| {
        Failure::Argument(format!(
            "--page: {} is not the page that `make lab` builds",
            source.display()
        ))
    })?;
    place.write(page.as_bytes())?;
    if !arguments.quiet {
        let (name, size) = (output.display(), page.len() as f64 * 1e-6);
        say(format_args!("{name}: {size:.1} MB, opens in a browser"));
    }
    Ok(())
}

fn built(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|error| {
        let path = path.display();
        Failure::Argument(format!("--page: {path}: {error}; `make lab` builds it"))
    })
}
