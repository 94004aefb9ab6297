//! `chaindrive check`: are these scenes sound?

use chaindrive::describe::{counted, foretold, warnings};
use chaindrive::plausibility::implausible;
use chaindrive::{Run, assemble, patiently};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use crate::answer::answer;
use crate::complaint::Trouble;
use crate::failure::Failure;
use crate::progress::waiting;
use crate::request::{Changes, load};
use crate::terminal::{print, say, tell};

/// Reads scenes, assembles their drives, and reports everything that is wrong.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Scene files, `-` for stdin, or names of embedded scenes
    #[arg(value_name = "SCENE|PRESET", required = true)]
    scenes: Vec<String>,

    #[command(flatten)]
    changes: Changes,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Answer of `chaindrive check --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Checked {
    /// The scenes, in the order in which they were given.
    scenes: Vec<SceneEntry>,
}

/// A scene, sound or wrong.
#[derive(Debug, Serialize, JsonSchema)]
struct SceneEntry {
    /// File or embedded scene.
    scene: String,
    /// Contents of a sound scene; absent for a wrong one.
    #[serde(skip_serializing_if = "Option::is_none")]
    sound: Option<Contents>,
    /// Mistakes; absent for a sound scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Trouble>,
}

/// Contents of a sound scene.
#[derive(Debug, Serialize, JsonSchema)]
struct Contents {
    /// Number of chains.
    chains: usize,
    /// Links of all chains.
    links: usize,
    /// Number of sprockets.
    sprockets: usize,
    /// Number of guides.
    guides: usize,
    /// Number of tensioners.
    tensioners: usize,
    /// Degrees of freedom that move.
    degrees_of_freedom: usize,
    /// Objections that do not keep it from running.
    warnings: Vec<String>,
    /// Implausible inputs, each with the limit and its source.
    implausible: Vec<String>,
}

/// Wall time of a run \[s\] that is worth a note.
const LONG: f64 = 3600.0;

pub(crate) fn check(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let mut wrong = 0;
    let mut entries = Vec::new();
    for name in &arguments.scenes {
        let mut entry = SceneEntry {
            scene: name.clone(),
            sound: None,
            error: None,
        };
        match sound(name, arguments, interrupted) {
            Ok(contents) => {
                if !arguments.json {
                    contents.show(name)?;
                }
                entry.sound = Some(contents);
            }
            Err(Failure::Interrupted) => return Err(Failure::Interrupted),
            Err(failure) => {
                if !arguments.json {
                    tell(&failure);
                }
                entry.error = Some(Trouble::of(&failure));
                wrong += 1;
            }
        }
        entries.push(entry);
    }
    if arguments.json {
        answer(&Checked { scenes: entries })?;
    }
    let scenes = arguments.scenes.len();
    if wrong == 0 {
        Ok(())
    } else {
        Err(Failure::Scenes { wrong, scenes })
    }
}

impl Contents {
    fn show(&self, name: &str) -> Result<(), Failure> {
        for warning in &self.warnings {
            say(format_args!("warning: {name}: {warning}"));
        }
        for note in &self.implausible {
            say(format_args!("note: {name}: hardly plausible: {note}"));
        }
        let chain = match self.chains {
            1 => counted(self.links, "link"),
            chains => format!("{chains} chains of {} links", self.links),
        };
        print(format_args!(
            "{name}: sound; {chain}, {}, {}, {}, {} of freedom",
            counted(self.sprockets, "sprocket"),
            counted(self.guides, "guide"),
            counted(self.tensioners, "tensioner"),
            counted(self.degrees_of_freedom, "degree")
        ))
    }
}

fn sound(
    name: &str,
    arguments: &Arguments,
    interrupted: &dyn Fn() -> bool,
) -> Result<Contents, Failure> {
    let changes = &arguments.changes;
    let scene = changes.made_in(load(name, interrupted)?)?;
    if !arguments.json {
        changes.notes(&scene).iter().for_each(say);
    }
    let drive = scene.drive()?;
    let what = format!("{name}: assembling");
    let assembled = waiting(&what, interrupted, |stop| assemble(&drive, stop));
    let assembled = Failure::or_interrupted(assembled, scene.name())?;
    let run = Run::suggested(&scene.run_defaults());
    let start = assembled.clone();
    let trial = run.clone();
    let time = waiting(&what, interrupted, |stop| {
        patiently(move || foretold(&start, &trial, LONG), stop)
    });
    // What goes wrong in the first steps is told by the run.
    let time = Failure::or_interrupted(time, scene.name())?;
    let time = time.ok().flatten();
    Ok(Contents {
        chains: drive.chains.len(),
        links: assembled.system.links(),
        sprockets: drive.sprockets.len(),
        guides: drive.guides.len(),
        tensioners: drive.tensioners.len(),
        degrees_of_freedom: assembled.system.free_dofs(),
        warnings: warnings(&assembled, run.until),
        implausible: implausible(&drive, time)
            .iter()
            .map(ToString::to_string)
            .collect(),
    })
}
