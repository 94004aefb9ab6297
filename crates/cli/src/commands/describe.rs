//! `chaindrive describe`: what would be simulated?

use chaindrive::Description;
use clap::Args;

use crate::failure::Failure;
use crate::request::{Request, RunArguments, SceneArguments};
use crate::stdout::print;

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

pub(crate) fn describe(arguments: &Arguments) -> Result<(), Failure> {
    let Request { scene, run, .. } = arguments.run.apply(arguments.scene.load()?)?;
    let description = Description::of(&scene.drive()?, &run).map_err(|source| Failure::Start {
        scene: scene.name().to_owned(),
        source,
    })?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&description);
        print(json.map_err(|error| Failure::Argument(error.to_string()))?)
    } else {
        let title = scene.title();
        let title = if title.is_empty() {
            scene.name()
        } else {
            title
        };
        print(format_args!(
            "{title}\n{}",
            description.to_string().trim_end()
        ))
    }
}
