//! `chaindrive resolve` and `diff`: what does a scene say in full, and what differs?

use chaindrive::scene::{Difference, diff as differences};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::answer::answer;
use crate::failure::Failure;
use crate::request::{SceneArguments, load};
use crate::terminal::print;

/// Prints a scene in full: every default with its value, and where it comes from.
///
/// The text is a scene too: it makes the same drive to the last bit, whatever the defaults of later versions are.
#[derive(Debug, Args)]
pub(crate) struct Resolve {
    #[command(flatten)]
    scene: SceneArguments,

    /// Prints JSON: the scene, and the inputs that are assumed
    #[arg(long)]
    json: bool,
}

/// Answer of `chaindrive resolve --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Resolved {
    /// The scene in full, of the form that `chaindrive schema scene` prints.
    scene: Map<String, Value>,
    /// The same as TOML, with the source of every default in a comment.
    text: String,
    /// Inputs that nobody measured or gave, as `path = value`.
    assumed: Vec<String>,
}

pub(crate) fn resolve(arguments: &Resolve, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let scene = arguments.scene.load(interrupted)?;
    let full = scene.resolved()?;
    if arguments.json {
        return answer(&Resolved {
            scene: match full.json() {
                Value::Object(scene) => scene,
                _ => Map::new(),
            },
            text: full.text().to_owned(),
            assumed: scene.assumed()?,
        });
    }
    print(full.text().trim_end())
}

/// Names what differs between two scenes, defaults included.
#[derive(Debug, Args)]
pub(crate) struct Diff {
    /// Scene file, embedded scene, or the folder of a result
    #[arg(value_name = "SCENE|PRESET|RESULT")]
    first: String,

    /// The other scene, preset or result
    #[arg(value_name = "SCENE|PRESET|RESULT")]
    second: String,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Answer of `chaindrive diff --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Differences {
    /// Values that the scenes do not have in common; empty where nothing differs.
    differences: Vec<Difference>,
}

pub(crate) fn diff(arguments: &Diff, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let read = |name: &str| load(name, interrupted);
    let (first, second) = (read(&arguments.first)?, read(&arguments.second)?);
    let found = differences(&first, &second)?;
    if arguments.json {
        return answer(&Differences { differences: found });
    }
    for difference in &found {
        print(difference)?;
    }
    if found.is_empty() {
        print("nothing differs")?;
    }
    Ok(())
}
