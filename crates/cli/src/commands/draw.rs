//! `chaindrive draw`: a picture of a drive.

use std::fs;
use std::path::PathBuf;

use chaindrive::draw::svg;
use chaindrive::patiently;
use clap::Args;

use crate::failure::Failure;
use crate::request::SceneArguments;
use crate::stdout::print;

/// Draws a drive as it stands at the start, as SVG: teeth, rollers, plates, guides and tensioners in millimetres.
///
/// A drive that does not assemble is drawn as it is laid, with gaps and clashes marked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Draws the chain as it is laid, before it settles
    #[arg(long)]
    laid: bool,

    /// The picture (.svg); stdout unless given
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Replaces an earlier picture of the same name
    #[arg(long)]
    overwrite: bool,
}

pub(crate) fn draw(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let taken = arguments.output.as_ref().filter(|output| output.exists());
    if let Some(output) = taken.filter(|_| !arguments.overwrite) {
        return Err(Failure::Taken {
            path: output.display().to_string(),
            found: "there is already a file here",
            hint: ", or pass --overwrite",
        });
    }
    let scene = arguments.scene.load(interrupted)?;
    let drive = scene.drive()?;
    let laid = arguments.laid;
    let figure = patiently(
        move || {
            if laid {
                drive.figure_as_laid()
            } else {
                drive.figure()
            }
        },
        interrupted,
    );
    let figure = figure.and_then(|figure| figure.map_err(Into::into));
    let figure = Failure::or_interrupted(figure, scene.name())?;
    let picture = svg(&figure, &figure.start(), scene.title());
    if let Some(problem) = &figure.problem {
        eprintln!("{}: {problem}", scene.name());
    }
    match &arguments.output {
        None => print(picture.trim_end()),
        Some(path) => fs::write(path, picture).map_err(|source| Failure::File {
            path: path.display().to_string(),
            source,
        }),
    }
}
