//! `chaindrive replay`: a recorded run as one page to look at.

use std::path::{Path, PathBuf};

use chaindrive::SimulationError;
use chaindrive::record::RecordedRun;
use chaindrive_replay::{AnimationError, MOST_FRAMES, Selection, film, page};
use clap::Args;

use super::output::new_file;
use crate::DrawingRequest;
use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::some;
use crate::terminal::say;

const PAGES: &str = "\
The page:
  One HTML file that a browser shows without a network: play, pause, scrub, zoom, follow a roller, go from contact
  to contact; `?` lists the keys. Rollers are exact to 0.05 mm or better, channels to 0.125 % of their largest value.
  Record link_tension for colours, contact_force for arrows, and tensioner_position where there is a tensioner.

Movies:
  The Python package makes them, with this command and --mp4, --gif, or an output that ends so:
  pip install 'chaindrive[movie]'. Of a movie --frames is the number of pictures, 250 unless given.";

/// Makes one HTML page of a recorded run, in which the drive moves.
#[derive(Debug, Args)]
#[command(after_help = PAGES)]
pub(crate) struct Arguments {
    /// The Zarr result of the run, running, complete or killed
    #[arg(value_name = "RESULT")]
    result: PathBuf,

    /// The page (.html); the name of the result with this ending unless given
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,

    /// Channels to plot beside the picture, separated by commas; the tension of the spans unless given
    #[arg(long, value_name = "CHANNELS", value_delimiter = ',')]
    plot: Option<Vec<String>>,

    /// Largest number of frames, 5001 unless given; of more samples every n-th is taken
    #[arg(long, value_name = "NUMBER", value_parser = some::<usize>)]
    frames: Option<usize>,

    #[command(flatten)]
    movie: Movie,

    /// Replaces an earlier page of the same name
    #[arg(long)]
    overwrite: bool,

    /// Prints errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Movies instead of a page.
#[derive(Clone, Copy, Debug, Args)]
struct Movie {
    /// Makes a movie instead (.mp4), by the command of the Python package
    #[arg(long, conflicts_with_all = ["gif", "plot"])]
    mp4: bool,

    /// Makes a movie instead (.gif), by the command of the Python package
    #[arg(long, conflicts_with = "plot")]
    gif: bool,
}

impl Arguments {
    /// The file to make.
    fn output(&self) -> PathBuf {
        let kind = match (self.movie.mp4, self.movie.gif) {
            (true, _) => "mp4",
            (_, true) => "gif",
            _ => "html",
        };
        let given = self.output.clone();
        given.unwrap_or_else(|| self.result.with_extension(kind))
    }

    /// The movie that is asked for, if it is one.
    pub(crate) fn movie(self) -> Option<DrawingRequest> {
        let output = self.output();
        let wanted = self.movie.mp4 || self.movie.gif || is_movie(&output);
        (wanted && self.plot.is_none()).then_some(DrawingRequest {
            source: self.result,
            output,
            frames: self.frames,
            overwrite: self.overwrite,
            quiet: self.quiet,
        })
    }
}

pub(crate) fn replay(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let output = arguments.output();
    if is_movie(&output) && arguments.plot.is_some() {
        let name = output.display();
        return Err(Failure::Argument(format!(
            "{name}: a movie has no plots, leave --plot out"
        )));
    }
    check_name(&output)?;
    let place = new_file(&output, arguments.overwrite)?;
    let selection = Selection {
        frames: arguments.frames.unwrap_or(MOST_FRAMES),
        plots: arguments.plot.clone(),
    };
    let wanted = |channel: &str| selection.wants(channel);
    let recorded = RecordedRun::open(&arguments.result, &wanted, selection.frames)?;
    let film = waiting("drawing", interrupted, |stop| {
        film(&recorded, &selection, stop)
    });
    let film = film.map_err(|error| no_film(error, &arguments.result))?;
    let text = page(&film);
    place.write(text.as_bytes())?;
    if !arguments.quiet {
        let (name, size) = (output.display(), text.len() as f64 * 1e-6);
        let (frames, samples) = (film.frames.times.len(), recorded.samples);
        let taken = match recorded.stride {
            1 => format!("{frames} frames, every sample"),
            stride => format!("{frames} frames, one in {stride} of {samples} samples"),
        };
        say(format_args!("{name}: {taken}, {size:.2} MB"));
    }
    Ok(())
}

fn is_movie(output: &Path) -> bool {
    output
        .extension()
        .is_some_and(|it| it == "mp4" || it == "gif")
}

/// Refuses a name that is not that of a page.
fn check_name(output: &Path) -> Result<(), Failure> {
    let name = output.display();
    match output.extension().and_then(|extension| extension.to_str()) {
        Some("html" | "htm") => Ok(()),
        _ if is_movie(output) => Err(Failure::Argument(format!(
            "{name}: this program makes pages (.html); movies are made by the command of the Python package: \
                 pip install 'chaindrive[movie]'"
        ))),
        _ => Err(Failure::Argument(format!(
            "{name}: the name must end in .html, or with the Python package in .mp4 or .gif"
        ))),
    }
}

fn no_film(error: AnimationError, result: &Path) -> Failure {
    match error {
        AnimationError::Scene(error) => error.into(),
        AnimationError::Stopped(SimulationError::Interrupted) => Failure::Interrupted,
        error => Failure::Argument(format!("{}: {error}", result.display())),
    }
}
