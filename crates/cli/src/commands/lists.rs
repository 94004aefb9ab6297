//! `chaindrive scenes`, `schema` and `channels`: what there is.

use chaindrive::scene::{presets, schema as scene_schema};
use chaindrive::{Channel, Scene};
use clap::Args;

use crate::failure::Failure;
use crate::stdout::print;

/// Lists the embedded scenes, or prints one of them as TOML.
#[derive(Debug, Args)]
pub(crate) struct Scenes {
    /// Scene to print
    name: Option<String>,
}

pub(crate) fn scenes(arguments: &Scenes) -> Result<(), Failure> {
    if let Some(name) = &arguments.name {
        return print(Scene::preset(name)?.text().trim_end());
    }
    for (name, what) in presets() {
        print(format_args!("{name:22} {what}"))?;
    }
    Ok(())
}

pub(crate) fn schema() -> Result<(), Failure> {
    print(format_args!("{:#}", scene_schema()))
}

pub(crate) fn channels() -> Result<(), Failure> {
    for channel in Channel::ALL {
        let default = if Channel::DEFAULT.contains(channel) {
            "*"
        } else {
            " "
        };
        let dimension = channel.axis().name().unwrap_or("");
        print(format_args!(
            "{default} {:20} {:6} {dimension:10} {}",
            channel.name(),
            channel.unit(),
            channel.description()
        ))?;
    }
    print("* recorded unless asked otherwise")
}
