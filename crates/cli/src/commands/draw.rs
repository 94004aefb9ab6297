//! `chaindrive draw`: a picture of a drive.

use std::path::{Path, PathBuf};

use chaindrive::draw::svg;
use chaindrive::record::RecordedRun;
use chaindrive::{Figure, Instant, Pose, Scene, patiently};
use clap::Args;

use chaindrive::scene::read_time;

use super::output::new_file;
use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::SceneArguments;
use crate::terminal::{print, say};

/// Draws a drive as SVG: teeth, rollers, plates, guides and tensioners in millimetres, at the start or at an instant of a result.
///
/// A drive that does not assemble is drawn as it is laid, with gaps and clashes marked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Draws the sample nearest to a time, such as "0.1 s"; of the folder of a result, which stands in the place of the scene
    #[arg(long, value_name = "TIME", conflicts_with_all = ["laid", "set"])]
    at: Option<String>,

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
    let output = arguments.output.as_deref();
    let place = output.map(|path| new_file(path, arguments.overwrite));
    let place = place.transpose()?;
    let scene = arguments.scene.load(interrupted)?;
    let recorded = match &arguments.at {
        None => None,
        Some(time) => Some(sample(arguments.scene.name(), time)?),
    };
    let run_in = recorded.as_ref().map_or(0.0, |sample| sample.run_in);
    let figure = figure(&scene, arguments.laid, run_in, interrupted)?;
    let (pose, title) = match &recorded {
        None => (figure.start(), scene.title().to_owned()),
        Some(sample) => (sample.pose(&figure)?, sample.title(&scene)),
    };
    let picture = svg(&figure, &pose, &title);
    if let Some(problem) = &figure.problem {
        say(format_args!("{}: {problem}", scene.name()));
    }
    match place {
        None => print(picture.trim_end()),
        Some(place) => Ok(place.write(picture.as_bytes())?),
    }
}

fn figure(
    scene: &Scene,
    laid: bool,
    run_in: f64,
    interrupted: &dyn Fn() -> bool,
) -> Result<Figure, Failure> {
    let drive = scene.drive()?;
    let work = move || {
        let drive = if run_in > 0.0 {
            drive.beginning(-run_in)?
        } else {
            drive
        };
        if laid {
            drive.figure_as_laid()
        } else {
            drive.figure()
        }
    };
    let figure = waiting("drawing", interrupted, |stop| patiently(work, stop));
    let figure = figure.and_then(|figure| figure.map_err(Into::into));
    Failure::or_interrupted(figure, scene.name())
}

/// A sample of a result.
struct Sample {
    recorded: RecordedRun,
    index: usize,
    run_in: f64,
}

/// The sample of a result that is nearest to a time.
fn sample(result: &str, time: &str) -> Result<Sample, Failure> {
    let time = read_time(time).map_err(|problem| Failure::Argument(format!("--at: {problem}")))?;
    let wanted = |name: &str| Instant::CHANNELS.contains(&name);
    let recorded = RecordedRun::open(Path::new(result), &wanted, usize::MAX)?;
    let times = recorded.time.iter().enumerate();
    let nearest = times.min_by(|(_, a), (_, b)| (*a - time).abs().total_cmp(&(*b - time).abs()));
    let Some((index, _)) = nearest else {
        return Err(Failure::Argument(format!("{result}: there is no sample")));
    };
    let run_in = recorded.attributes.get("run_in");
    let run_in = run_in.and_then(serde_json::Value::as_f64).unwrap_or(0.0);
    Ok(Sample {
        recorded,
        index,
        run_in,
    })
}

impl Sample {
    fn pose(&self, figure: &Figure) -> Result<Pose, Failure> {
        let values = |name: &str| self.recorded.channel(name)?.sample(self.index);
        let at = Instant::recorded(self.recorded.time[self.index], values);
        let pose = figure.pose(&at);
        pose.map_err(|missing| Failure::Argument(missing.to_string()))
    }

    fn title(&self, scene: &Scene) -> String {
        format!(
            "{}, t = {} s",
            scene.title(),
            self.recorded.time[self.index]
        )
    }
}
