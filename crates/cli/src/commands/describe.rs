//! `chaindrive describe`: what would be simulated?

use chaindrive::precision::choose;
use chaindrive::{Description, Request, assemble, patiently};
use clap::Args;

use crate::answer::answer;
use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::{RunArguments, SceneArguments};
use crate::terminal::{print, say};

/// Describes what a run would simulate: route, statics, model, time scales, cost.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    #[command(flatten)]
    run: RunArguments,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn describe(
    arguments: &Arguments,
    interrupted: &dyn Fn() -> bool,
) -> Result<(), Failure> {
    let Request {
        scene,
        run,
        accuracy,
        accuracy_of,
        ..
    } = arguments.run.apply(&arguments.scene.load(interrupted)?)?;
    let drive = scene.drive()?;
    let notes = arguments.scene.notes(&scene);
    for note in notes.iter().filter(|_| !arguments.json) {
        say(note);
    }
    // Assembled once: long chains that sag take half a minute to settle.
    let described = waiting("describing", interrupted, |stop| {
        let start = assemble(&drive, stop)?;
        // What a run would do, it would do by the method that it would choose.
        let choice = accuracy
            .map(|accuracy| choose(&start, &run, (accuracy, accuracy_of), stop))
            .transpose()?;
        let run = choice.as_ref().map_or(run, |choice| choice.run.clone());
        let described = patiently(move || Description::of_assembled(&start, &run), stop)??;
        Ok((described, choice))
    });
    let (description, choice) = Failure::or_interrupted(described, scene.name())?;
    if arguments.json {
        answer(&description)
    } else {
        let title = scene.title();
        let title = if title.is_empty() {
            scene.name()
        } else {
            title
        };
        print(format_args!(
            "{title}\n{}{}",
            description.to_string().trim_end(),
            choice.map_or_else(String::new, |choice| format!("\n\n{choice}"))
        ))
    }
}
