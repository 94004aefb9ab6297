//! Good practice of layouts, which is known before anything runs.

use chaindrive_mechanics::{Drive, Layout, PlacedChain, Rotation, Stop, Support};

use super::{Check, CheckOutcome, Limit};
use crate::design::ChainLayout;

/// Centre distance in pitches from which on a chain conveys. *Assumed*: no drive is as long.
const CONVEYS: f64 = 80.0;

/// Checks of the layout of every chain; `wraps` of every sprocket \[rad\], where it is known.
///
/// Silent about chains with guides, with cages of a tensioner, and about conveyors: their rules are others.
pub fn layout_checks(drive: &Drive, wraps: &[Option<f64>]) -> Vec<Check> {
    let chains = drive.chains.iter();
    chains
        .flat_map(|placed| of_chain(drive, placed, wraps))
        .collect()
}

fn of_chain(drive: &Drive, placed: &PlacedChain, wraps: &[Option<f64>]) -> Vec<Check> {
    let of = placed.name.as_deref().unwrap_or_default();
    let Layout::Route { stops: route, .. } = &placed.layout else {
        return Vec::new();
    };
    let on_route: Vec<usize> = route
        .iter()
        .filter_map(|stop| match stop {
            Stop::Sprocket(index) => Some(*index),
            Stop::Guide(_) => None,
        })
        .collect();
    let carried =
        |index: &&usize| matches!(drive.sprockets[**index].support, Support::Tensioner(_));
    let is_caged = on_route.iter().filter(carried).count() > 1;
    let is_guided = !placed.guides.is_empty();
    let carries_power = |index: &&usize| carries_power(drive, **index);
    let powered: Vec<usize> = on_route.iter().filter(carries_power).copied().collect();
    if is_guided || is_caged || powered.len() < 2 {
        return Vec::new();
    }
    let centres = || {
        let [first, second] = powered[..] else {
            return None;
        };
        let [a, b] = [first, second].map(|index| drive.sprockets[index].centre);
        Some((b - a).norm() / placed.chain.pitch)
    };
    let centres = centres();
    if centres.is_some_and(|it| it > CONVEYS) {
        return Vec::new();
    }
    let powered = powered.iter().map(|index| Powered {
        name: &drive.sprockets[*index].name,
        teeth: drive.sprockets[*index].gap.teeth,
        wrap: wraps.get(*index).copied().flatten(),
    });
    practice(of, &powered.collect::<Vec<_>>(), centres)
}

/// A sprocket that carries power, with its wrap \[rad\] where that is known.
struct Powered<'a> {
    name: &'a str,
    teeth: u32,
    wrap: Option<f64>,
}

/// Checks of the chain of this name on its sprockets that carry power; `centres`: their distance \[pitches\], where there are two.
fn practice(of: &str, powered: &[Powered<'_>], centres: Option<f64>) -> Vec<Check> {
    let smallest = powered.iter().min_by_key(|it| it.teeth);
    let largest = powered.iter().map(|it| it.teeth).max();
    let (Some(smallest), Some(largest)) = (smallest, largest) else {
        return Vec::new();
    };
    let least = f64::from(smallest.teeth);
    let mut checks = vec![
        Check::of(Limit::Teeth, smallest.name, least).with(if least < LEAST_TEETH {
            "11 at the least: assumed, Tsubaki recommends more than 13"
        } else {
            ""
        }),
        Check::of(Limit::Ratio, of, f64::from(largest) / least),
    ];
    let wrap = smallest.wrap.map(f64::to_degrees);
    checks.extend(wrap.map(|wrap| Check::of(Limit::Wrap, smallest.name, wrap)));
    checks.extend(centres.map(|pitches| Check::of(Limit::Centres, of, pitches)));
    checks
}

/// Departures of layouts from good practice, in words. Without a drive all sprockets carry power.
pub fn against_practice(layouts: &[ChainLayout], drive: Option<&Drive>) -> Vec<String> {
    let stops = || layouts.iter().flat_map(|it| &it.stops);
    let checks = match drive {
        Some(drive) => {
            let wrap = |name: &str| stops().find(|it| it.name == name).map(|it| it.wrap);
            let wraps = drive.sprockets.iter().map(|it| wrap(&it.name));
            layout_checks(drive, &wraps.collect::<Vec<_>>())
        }
        None => layouts.iter().flat_map(of_layout).collect(),
    };
    remarks(checks)
}

fn of_layout(layout: &ChainLayout) -> Vec<Check> {
    let toothed = layout.stops.iter().filter_map(|it| {
        it.teeth.map(|teeth| Powered {
            name: &it.name,
            teeth,
            wrap: Some(it.wrap),
        })
    });
    let centres = match &layout.stops[..] {
        [first, second] => {
            let [x, y] = [0, 1].map(|axis| second.centre[axis] - first.centre[axis]);
            Some(x.hypot(y) / layout.pitch)
        }
        _ => None,
    };
    practice("", &toothed.collect::<Vec<_>>(), centres)
}

/// Checks that warn, in words with the source of their limit.
pub fn remarks(checks: Vec<Check>) -> Vec<String> {
    let warned = checks.into_iter();
    let warned = warned.filter(|check| check.outcome == CheckOutcome::Warning);
    warned
        .map(|check| format!("{check} ({})", check.limit.source()))
        .collect()
}

/// Teeth below which the warning has another word.
const LEAST_TEETH: f64 = 11.0;

/// A sprocket carries power where its shaft is driven, loaded or joined to another one. An idler is none of these.
fn carries_power(drive: &Drive, sprocket: usize) -> bool {
    let index = drive.sprockets[sprocket].shaft;
    let shaft = &drive.shafts[index];
    let is_given = matches!(shaft.rotation, Rotation::Prescribed(_));
    let shares = drive
        .sprockets
        .iter()
        .filter(|it| it.shaft == index)
        .count()
        > 1;
    let coupled = drive.couplings.iter().any(|it| it.shafts.contains(&index));
    let geared = drive.gears.iter().any(|it| it.shafts.contains(&index));
    is_given || shares || coupled || geared || shaft.torques().next().is_some()
}
