//! `chaindrive design`: how many links, and where does everything touch?

use chaindrive::catalogue::Number;
use chaindrive::chain_verdict::against_practice;
use chaindrive::design::{ChainLayout, clashes, of, of_two_sprockets};
use chaindrive::scene::{chain_named, read_length};
use clap::{ArgGroup, Args};
use schemars::JsonSchema;
use serde::Serialize;

use crate::answer::answer;
use crate::failure::Failure;
use crate::request::{load, some};
use crate::terminal::print;

/// Lays out the chains of a scene, or a chain on two sprockets: links, spans, points of tangency, wraps, seats, clashes.
///
/// Nothing is assembled. Where the chain does not close it says which numbers of links would, and where a sprocket would have to stand.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("what").required(true).args(["scene", "sprockets"]))]
pub(crate) struct Arguments {
    /// Scene file (TOML or JSON, `-` for stdin) or name of an embedded scene
    #[arg(value_name = "SCENE|PRESET")]
    scene: Option<String>,

    /// Replaces a value of the scene, such as chain.links=80; may be repeated
    #[arg(long, value_name = "PATH=VALUE", requires = "scene")]
    set: Vec<String>,

    /// Teeth of two sprockets, such as 19,38
    #[arg(
        long,
        value_name = "TEETH,TEETH",
        value_delimiter = ',',
        num_args = 1,
        requires = "of",
        value_parser = some::<u32>
    )]
    sprockets: Vec<u32>,

    /// Chain of the catalogue, such as 16B-1, which has the pitch
    #[arg(long, value_name = "NAME", requires = "sprockets", group = "of")]
    chain: Option<String>,

    /// Pitch of the chain, such as "12.7 mm"
    #[arg(long, value_name = "LENGTH", requires = "sprockets", group = "of")]
    pitch: Option<String>,

    /// Distance of the centres of the two sprockets, such as "400 mm"
    #[arg(long, value_name = "LENGTH", requires = "sprockets")]
    centre_distance: Option<String>,

    /// Number of links, for which the distance is found
    #[arg(long, value_name = "LINKS", requires = "sprockets", value_parser = some::<u32>)]
    links: Option<u32>,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn design(arguments: &Arguments, interrupted: &dyn Fn() -> bool) -> Result<(), Failure> {
    let Some(scene) = &arguments.scene else {
        let layouts = [of_two(arguments)?];
        let remarks = against_practice(&layouts, None);
        return show(&layouts, &[], &remarks, arguments.json);
    };
    let mut scene = load(scene, interrupted)?;
    for change in &arguments.set {
        let Some((path, value)) = change.split_once('=') else {
            return Err(Failure::Argument(format!(
                "--set {change}: a path and a value are needed, such as chain.links=80"
            )));
        };
        scene = scene.replace(path.trim(), value.trim())?;
    }
    let drive = scene.drive()?;
    let found = of(&drive).and_then(|layouts| Ok((layouts, clashes(&drive)?)));
    let (layouts, clashes) = found.map_err(|error| Failure::Start {
        scene: scene.name().to_owned(),
        source: error.into(),
    })?;
    if layouts.is_empty() {
        let name = scene.name();
        return Err(Failure::Argument(format!(
            "{name}: no chain runs around sprockets, so there is nothing to lay out"
        )));
    }
    let clashes: Vec<String> = clashes.iter().map(ToString::to_string).collect();
    let remarks = against_practice(&layouts, Some(&drive));
    show(&layouts, &clashes, &remarks, arguments.json)
}

/// The layout of two sprockets.
fn of_two(arguments: &Arguments) -> Result<ChainLayout, Failure> {
    let length = |option: &str, text: &Option<String>| {
        let text = text.as_deref();
        let read = text.map(|text| {
            read_length(text).map_err(|error| Failure::Argument(format!("--{option}: {error}")))
        });
        read.transpose()
    };
    let chain = arguments.chain.as_deref().map(|name| {
        chain_named(name).map_err(|problem| Failure::Argument(format!("--chain: {problem}")))
    });
    let of_chain = chain
        .transpose()?
        .and_then(|chain| chain.number(Number::Pitch));
    let given = length("pitch", &arguments.pitch)?;
    let pitch = given.or(of_chain).unwrap_or_default();
    let [first, second] = arguments.sprockets[..] else {
        let count = arguments.sprockets.len();
        return Err(Failure::Argument(format!(
            "--sprockets: {count} numbers of teeth, must be two, such as 19,38; more sprockets are laid out from a scene"
        )));
    };
    let distance = length("centre-distance", &arguments.centre_distance)?;
    if distance.is_none() && arguments.links.is_none() {
        return Err(Failure::Argument(
            "give --centre-distance, or --links for which it is found".to_owned(),
        ));
    }
    of_two_sprockets([first, second], pitch, distance, arguments.links)
        .map_err(|error| Failure::Argument(error.to_string()))
}

/// Answer of `chaindrive design --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Layouts<'a> {
    /// Closed chains, laid out.
    chains: &'a [ChainLayout],
    /// Bodies in each other's way.
    clashes: &'a [String],
    /// Departures of the layouts from good practice, each with the limit and its source.
    against_practice: &'a [String],
}

fn show(
    layouts: &[ChainLayout],
    clashes: &[String],
    against_practice: &[String],
    json: bool,
) -> Result<(), Failure> {
    if json {
        return answer(&Layouts {
            chains: layouts,
            clashes,
            against_practice,
        });
    }
    for layout in layouts {
        print(layout.to_string().trim_end())?;
    }
    for clash in clashes {
        print(format_args!("warning: {clash}"))?;
    }
    for remark in against_practice {
        print(format_args!("good practice: {remark}"))?;
    }
    Ok(())
}
