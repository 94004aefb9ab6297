//! `chaindrive check`: are these scenes sound?

use chaindrive::describe::{counted, warnings};
use chaindrive::{Run, assemble};
use clap::Args;

use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::load;
use crate::terminal::{print, say, tell};

/// Reads scenes, assembles their drives, and reports everything that is wrong.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Scene files, `-` for stdin, or names of embedded scenes
    #[arg(value_name = "SCENE|PRESET", required = true)]
    scenes: Vec<String>,
}

pub(crate) fn check(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let mut wrong = 0;
    for name in &arguments.scenes {
        match sound(name, interrupted) {
            Ok(what) => print(format_args!("{name}: {what}"))?,
            Err(Failure::Interrupted) => return Err(Failure::Interrupted),
            Err(failure) => {
                tell(&failure);
                wrong += 1;
            }
        }
    }
    let scenes = arguments.scenes.len();
    if wrong == 0 {
        Ok(())
    } else {
        Err(Failure::Scenes { wrong, scenes })
    }
}

/// Contents of a sound scene.
fn sound(name: &str, interrupted: &dyn Fn() -> bool) -> Result<String, Failure> {
    let scene = load(name, interrupted)?;
    let drive = scene.drive()?;
    let what = format!("{name}: assembling");
    let assembled = waiting(&what, interrupted, |stop| assemble(&drive, stop));
    let assembled = Failure::or_interrupted(assembled, scene.name())?;
    let run = Run::suggested(&scene.run_defaults());
    for warning in warnings(&assembled, run.until) {
        say(format_args!("warning: {name}: {warning}"));
    }
    let links = assembled.system.links();
    let chain = match drive.chains.len() {
        1 => counted(links, "link"),
        chains => format!("{chains} chains of {links} links"),
    };
    Ok(format!(
        "sound; {chain}, {}, {}, {}, {} of freedom",
        counted(drive.sprockets.len(), "sprocket"),
        counted(drive.guides.len(), "guide"),
        counted(drive.tensioners.len(), "tensioner"),
        counted(assembled.system.free_dofs(), "degree")
    ))
}
