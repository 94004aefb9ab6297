//! `chaindrive scenes`, `channels`, `catalogue` and `--version`: what there is.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use chaindrive::catalogue::{CatalogueChain, Number, catalogue as chains};
use chaindrive::figure::{Measure, with_digits};
use chaindrive::scene::{chain_named, presets};
use chaindrive::{Build, Channel, InstructionSet, Origin, Scene, aligned};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use crate::answer::answer;
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
    let lines = presets()
        .iter()
        .map(|(name, what)| format!("{name}\t{what}"));
    print(aligned(&lines.collect::<Vec<_>>().join("\n"), 22))
}

/// Lists what a run can record.
#[derive(Debug, Args)]
pub(crate) struct Channels {
    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Answer of `chaindrive channels --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ChannelList {
    /// All channels.
    channels: Vec<ChannelEntry>,
}

/// A channel of runs.
#[derive(Debug, Serialize, JsonSchema)]
struct ChannelEntry {
    /// Name, for `--record` and in results.
    name: &'static str,
    /// SI unit; of tensioners, that of sliders.
    unit: &'static str,
    /// Things to which its entries belong; absent for one number a sample.
    dimension: Option<&'static str>,
    /// One line of description.
    description: &'static str,
    /// When it is recorded unless asked otherwise.
    recorded: Recorded,
}

/// When a channel is recorded unless asked otherwise.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Recorded {
    /// In every run.
    Always,
    /// In runs of drives with moving tensioners or centres.
    WhereBodiesMove,
    /// On demand.
    OnDemand,
}

impl ChannelEntry {
    fn of(channel: Channel) -> Self {
        Self {
            name: channel.name(),
            unit: channel.unit(),
            dimension: channel.axis().name(),
            description: channel.description(),
            recorded: if Channel::DEFAULT.contains(&channel) {
                Recorded::Always
            } else if Channel::WHERE_BODIES_MOVE.contains(&channel) {
                Recorded::WhereBodiesMove
            } else {
                Recorded::OnDemand
            },
        }
    }
}

pub(crate) fn channels(arguments: &Channels) -> Result<(), Failure> {
    let entries = Channel::ALL.iter().copied().map(ChannelEntry::of);
    if arguments.json {
        return answer(&ChannelList {
            channels: entries.collect(),
        });
    }
    for channel in entries {
        let default = match channel.recorded {
            Recorded::Always => "*",
            Recorded::WhereBodiesMove => "+",
            Recorded::OnDemand => " ",
        };
        let (name, unit, what) = (channel.name, channel.unit, channel.description);
        let dimension = channel.dimension.unwrap_or("");
        print(format_args!(
            "{default} {name:20} {unit:6} {dimension:10} {what}"
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
    print(build)?;
    let built: Vec<_> = InstructionSet::built().map(InstructionSet::name).collect();
    print(format_args!("kernels for   {}", built.join(", ")))?;
    let available: Vec<_> = InstructionSet::available()
        .map(InstructionSet::name)
        .collect();
    print(format_args!("processor has {}", available.join(", ")))?;
    InstructionSet::in_use().map_err(|error| Failure::Argument(error.to_string()))?;
    let in_use = Origin::here().instruction_set;
    print(format_args!("in use        {in_use}"))
}

/// Lists the chains that a scene can name, or all that is known of one.
#[derive(Debug, Args)]
pub(crate) struct Catalogue {
    /// Chain to look up, such as 16B-1 or 80
    name: Option<String>,

    /// Prints JSON: all that is known of the chain, or of all chains
    #[arg(long)]
    json: bool,
}

/// Answer of `chaindrive catalogue --json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ChainList {
    /// The chains, or the one that was asked for.
    chains: Vec<ChainEntry>,
}

/// A chain that a scene can name.
#[derive(Debug, Serialize, JsonSchema)]
struct ChainEntry {
    /// ISO designation, or the name of the trade.
    name: &'static str,
    /// ANSI number; absent where there is none.
    ansi: Option<&'static str>,
    /// Part that runs on the teeth: roller or bush.
    kind: &'static str,
    /// What is known of it, by name.
    numbers: BTreeMap<&'static str, NumberEntry>,
    /// Where makers differ by more than a per cent; absent where they do not.
    makers_differ: Option<&'static str>,
}

/// A number of the catalogue.
#[derive(Debug, Serialize, JsonSchema)]
struct NumberEntry {
    /// Value in SI units.
    value: f64,
    /// The unit.
    unit: &'static str,
    /// One line of description.
    description: &'static str,
    /// Where it is from.
    source: &'static str,
}

impl ChainEntry {
    fn of(chain: &'static CatalogueChain) -> Self {
        let some = |text: &'static str| Some(text).filter(|text| !text.is_empty());
        let number = |number: Number| {
            let entry = NumberEntry {
                value: chain.number(number)?,
                unit: number.unit(),
                description: number.description(),
                source: chain.status(number.status()),
            };
            Some((number.name(), entry))
        };
        Self {
            name: &chain.name,
            ansi: some(&chain.ansi),
            kind: &chain.kind,
            numbers: Number::ALL.into_iter().filter_map(number).collect(),
            makers_differ: some(&chain.makers_differ),
        }
    }
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
    let known = arguments.name.as_deref().map(chain_named).transpose();
    let known = known.map_err(|problem| Failure::Argument(problem.to_string()))?;
    if arguments.json {
        let all = known.map_or(chains(), std::slice::from_ref);
        let chains = all.iter().map(ChainEntry::of).collect();
        return answer(&ChainList { chains });
    }
    if let Some(chain) = known {
        return entry(chain);
    }
    let headings = SHOWN.map(|(_, heading, _)| heading);
    // Texts take whatever is written.
    let mut text = format!("chain\tANSI\tkind\t{}", headings.join("\t"));
    for chain in chains() {
        let _ = write!(text, "\n{}\t{}\t{}", chain.name, chain.ansi, chain.kind);
        for (number, _, per) in SHOWN {
            let value = chain.number(number).map(|it| with_digits(it * per, DIGITS));
            let _ = write!(text, "\t{}", value.as_deref().unwrap_or("–"));
        }
    }
    print(aligned(&text, 0))?;
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
    let mut text = chain.name.clone();
    for number in Number::ALL {
        let value = chain.number(number).map(|it| told(number, it));
        let (name, value) = (number.name(), value.as_deref().unwrap_or("–"));
        let (what, source) = (number.description(), chain.status(number.status()));
        let _ = write!(text, "\n  {name}\t{value}\t{what} [{source}]");
    }
    if !chain.makers_differ.is_empty() {
        let _ = write!(text, "\n  makers differ: {}", chain.makers_differ);
    }
    print(aligned(&text, 0))
}
