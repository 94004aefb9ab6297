//! `chaindrive resolve` and `diff`: what does a scene say in full, and what differs?

use chaindrive::scene::diff as differences;
use clap::Args;

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
}

pub(crate) fn resolve(arguments: &Resolve, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let full = arguments.scene.load(interrupted)?.resolved()?;
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
}

pub(crate) fn diff(arguments: &Diff, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let read = |name: &str| load(name, interrupted);
    let (first, second) = (read(&arguments.first)?, read(&arguments.second)?);
    let found = differences(&first, &second)?;
    for difference in &found {
        print(difference)?;
    }
    if found.is_empty() {
        print("nothing differs")?;
    }
    Ok(())
}
