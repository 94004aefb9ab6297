//! `chaindrive scenes`, `schema`, `channels`, `catalogue` and `--version`: what there is.

use chaindrive::catalogue::{CatalogueChain, Number, catalogue as chains};
use chaindrive::figure::{Measure, with_digits};
use chaindrive::scene::{chain_named, presets, schema as scene_schema};
use chaindrive::{Build, Channel, InstructionSet, Origin, Scene};
use clap::Args;

use crate::failure::Failure;
use crate::terminal::print;

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
        } else if Channel::WHERE_BODIES_MOVE.contains(channel) {
            "+"
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
    print(
        "* recorded unless asked otherwise\n+ recorded with them where tensioners or centres move",
    )
}

/// Prints the version; with `verbose` the identity of the build, and its instruction sets.
pub(crate) fn version(verbose: bool) -> Result<(), Failure> {
    let build = Build::here();
    print(format_args!("chaindrive {}", build.version))?;
    if !verbose {
        return Ok(());
    }
    let names = |sets: &mut dyn Iterator<Item = InstructionSet>| {
        sets.map(InstructionSet::name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    print(build)?;
    print(format_args!(
        "kernels for   {}",
        names(&mut InstructionSet::built())
    ))?;
    print(format_args!(
        "processor has {}",
        names(&mut InstructionSet::available())
    ))?;
    InstructionSet::in_use().map_err(|error| Failure::Argument(error.to_string()))?;
    print(format_args!(
        "in use        {}",
        Origin::here().instruction_set
    ))
}

/// Lists the chains that a scene can name, or all that is known of one.
#[derive(Debug, Args)]
pub(crate) struct Catalogue {
    /// Chain to look up, such as 16B-1 or 80
    name: Option<String>,
}

/// Quantity in the list, and how many of its units make one of SI.
const SHOWN: [(Number, &str, f64); 8] = [
    (Number::Pitch, "pitch mm", 1e3),
    (Number::RollerDiameter, "roller mm", 1e3),
    (Number::InnerWidth, "width mm", 1e3),
    (Number::PinDiameter, "pin mm", 1e3),
    (Number::PlateHeight, "plate mm", 1e3),
    (Number::BreakingLoad, "break kN", 1e-3),
    (Number::MassPerLength, "mass kg/m", 1.0),
    (Number::LinkStiffness, "link MN/m", 1e-6),
];

pub(crate) fn catalogue(arguments: &Catalogue) -> Result<(), Failure> {
    if let Some(name) = &arguments.name {
        let chain = chain_named(name).map_err(|problem| Failure::Argument(problem.to_string()));
        return entry(chain?);
    }
    let heading = SHOWN.map(|(_, heading, _)| format!("{heading:>10}"));
    print(format_args!(
        "{:8} {:>5} {:>6} {}",
        "chain",
        "ANSI",
        "kind",
        heading.join(" ")
    ))?;
    for chain in chains() {
        let cells = SHOWN.map(|(number, _, per)| match chain.number(number) {
            Some(value) => format!("{:>10}", with_digits(value * per, DIGITS)),
            None => format!("{:>10}", "–"),
        });
        print(format_args!(
            "{:8} {:>5} {:>6} {}",
            chain.name,
            chain.ansi,
            chain.kind,
            cells.join(" ")
        ))?;
    }
    print("`chaindrive catalogue NAME` tells all, and where it is from")
}

/// Digits of the table, at most.
const DIGITS: i32 = 5;

/// A number of the catalogue in the unit of the trade.
fn told(number: Number, value: f64) -> String {
    match Measure::of_unit(number.unit()) {
        Some(quantity) => quantity.told_with(value, DIGITS),
        None => format!("{} {}", with_digits(value, DIGITS), number.unit()),
    }
}

fn entry(chain: &CatalogueChain) -> Result<(), Failure> {
    print(&chain.name)?;
    for number in Number::ALL {
        let value = chain
            .number(number)
            .map_or_else(|| "–".to_owned(), |value| told(number, value));
        print(format_args!(
            "  {:16} {value:>19}  {} [{}]",
            number.name(),
            number.description(),
            chain.status(number.status())
        ))?;
    }
    if !chain.makers_differ.is_empty() {
        print(format_args!("  makers differ: {}", chain.makers_differ))?;
    }
    Ok(())
}
