//! What would make a chain close that does not, by name: another order or side of its stops, a tensioner or a sprocket that moves, sag.

use chaindrive_geometry::{GeometryError, Remedy, Search, WheelKind, close_nearest};

use super::rearranging::{RouteOf, advice};
use super::wheels::{shifted, wheels};
use crate::AssemblyError;
use crate::drive::{Adjust, Fit, Parts, Stop};

/// Farthest that a tensioner is moved in search of a place at which the chain closes \[pitches\], and widest \[rad\].
const FARTHEST: f64 = 20.0;
const WIDEST: f64 = 1.0;

/// Share by which the range that is told exceeds the travel that is needed.
const ROOM: f64 = 1.25;

/// Times that a route is longer or shorter than its chain from which lengths must be in different units.
const FAR_OFF: f64 = 50.0;

/// Elongation \[–\] beyond which a chain is called worn.
const WORN: f64 = 1e-4;

/// The error of a route with what would mend it.
pub(super) fn told(error: AssemblyError, parts: &Parts, chain: usize, fit: &Fit) -> AssemblyError {
    let (AssemblyError::Route { problem, source }, Some(route)) =
        (&error, RouteOf::chain(parts, chain))
    else {
        return error;
    };
    let mut ways = Vec::new();
    match source {
        GeometryError::DoesNotClose { links, taut, .. }
            if !(1.0 / FAR_OFF..FAR_OFF).contains(&(taut / f64::from(*links))) =>
        {
            ways.extend(farthest(&route));
        }
        GeometryError::DoesNotClose { slack, remedy, .. } => {
            ways.extend(worn(&route));
            ways.extend(advice(&route, loose(&route, fit)));
            if fit.adjust == Adjust::Nothing {
                let moves = moving(&route, *slack, remedy.as_deref());
                ways.extend(moves);
            }
        }
        GeometryError::RouteTurns { .. } | GeometryError::NoTangent { .. } => {
            ways.extend(advice(&route, loose(&route, fit)));
        }
        _ => {}
    }
    let problem = std::iter::once(problem.clone()).chain(ways);
    AssemblyError::Route {
        problem: problem.collect::<Vec<_>>().join("; "),
        source: source.clone(),
    }
}

/// The two neighbours on the route that stand farthest apart.
fn farthest(route: &RouteOf<'_>) -> Option<String> {
    let wheels = wheels(
        route.parts,
        &route.parts.chains[route.chain].chain,
        route.stops,
    )
    .ok()?;
    let apart = |stop: usize| {
        let next = (stop + 1) % wheels.len();
        (wheels[next].centre - wheels[stop].centre).norm()
    };
    let stop = (0..wheels.len()).max_by(|&a, &b| apart(a).total_cmp(&apart(b)))?;
    let distance = apart(stop);
    Some(format!(
        "{} stands {distance} m from {}: for millimetres write \"{distance} mm\"",
        route.name((stop + 1) % wheels.len()),
        route.name(stop)
    ))
}

/// Links \[–\] that the adjusted body takes up at most on either side: a stop that moves by s lengthens the route by 2 s at most.
fn loose(route: &RouteOf<'_>, fit: &Fit) -> f64 {
    let pitch = route.parts.chains[route.chain].chain.pitch;
    match fit.adjust {
        Adjust::Nothing => 0.0,
        Adjust::Sprocket { within, .. } => 2.0 * within / pitch,
        Adjust::Tensioner { tensioner, within } => {
            2.0 * within * route.parts.tensioners[tensioner].carrier.reach() / pitch
        }
    }
}

/// That a worn chain is longer than its route was made for.
fn worn(route: &RouteOf<'_>) -> Option<String> {
    let chain = &route.parts.chains[route.chain].chain;
    let mean = chain.lengths.iter().sum::<f64>() / chain.links() as f64;
    let elongation = mean / chain.pitch - 1.0;
    (elongation > WORN).then(|| {
        format!(
            "the chain is worn: its links are {:.2} % longer than the pitch, and something has to take that up",
            elongation * 100.0
        )
    })
}

/// What can be moved: each tensioner on the route, or else the most effective sprocket; and sag, where the chain is too long.
fn moving(route: &RouteOf<'_>, slack: f64, remedy: Option<&Remedy>) -> Option<String> {
    let tensioners = 0..route.parts.tensioners.len();
    let mut ways: Vec<String> = tensioners
        .filter_map(|it| by_tensioner(route, it))
        .collect();
    if ways.is_empty() {
        ways.extend(remedy.and_then(|it| by_sprocket(route, it)));
    }
    if ways.is_empty() {
        return None;
    }
    let sags = if slack > 0.0 {
        ", and with `sag = \"10 mm\"` beside it instead of a pretension the slack span hangs by so much"
    } else {
        ""
    };
    Some(format!("or give the route {}{sags}", ways.join(" or ")))
}

/// The tensioner as what is adjusted, where it can make the chain close.
fn by_tensioner(route: &RouteOf<'_>, tensioner: usize) -> Option<String> {
    if route.carried_by(tensioner).is_empty() {
        return None;
    }
    let placed = &route.parts.chains[route.chain].chain;
    let own = &route.parts.tensioners[tensioner];
    let links = u32::try_from(placed.links()).ok()?;
    let pitch = placed.lengths.iter().sum::<f64>() / placed.links() as f64;
    let reach = own.carrier.reach();
    let travels = own.carrier.coordinate_unit() == "m";
    let mut wheels_at = |travel: f64| {
        let moved = shifted(
            route.parts,
            &Adjust::Tensioner {
                tensioner,
                within: 1.0,
            },
            travel,
        );
        let moved = moved.and_then(|parts| wheels(&parts, placed, route.stops));
        moved.unwrap_or_default()
    };
    let search = Search {
        start: 0.0,
        step: 0.1 * pitch / reach,
        within: if travels {
            FARTHEST * pitch
        } else {
            (FARTHEST * pitch / reach).min(WIDEST)
        },
    };
    let (travel, ..) = close_nearest(pitch, 0.0, links, 0.5, &mut wheels_at, search).ok()?;
    let within = if travels {
        format!("{:.0} mm", (travel.abs() * ROOM * 1e3).ceil())
    } else {
        format!("{:.0} deg", (travel.abs() * ROOM).to_degrees().ceil())
    };
    Some(format!(
        "`adjust = {{ kind = \"{}\", name = \"{}\", within = \"{within}\" }}`",
        own.carrier.name(),
        own.name
    ))
}

/// The most effective sprocket as what is adjusted.
fn by_sprocket(route: &RouteOf<'_>, remedy: &Remedy) -> Option<String> {
    let wheels = wheels(
        route.parts,
        &route.parts.chains[route.chain].chain,
        route.stops,
    )
    .ok()?;
    let from = wheels.get(remedy.wheel)?;
    let (Stop::Sprocket(index), WheelKind::Toothed { .. }) = (route.stops[remedy.wheel], from.kind)
    else {
        return None;
    };
    let way = (remedy.centre - from.centre).try_normalize(0.0)?;
    Some(format!(
        "`adjust = {{ kind = \"sprocket\", name = \"{}\", direction = [{}, {}], within = \"{:.0} mm\" }}`",
        route.parts.sprockets[index].name,
        short(way.x),
        short(way.y),
        (remedy.travel.abs() * ROOM * 1e3).ceil()
    ))
}

/// A component of a direction with two digits, without needless ones.
fn short(component: f64) -> f64 {
    // −0 would be told as such.
    (component * 100.0).round() / 100.0 + 0.0
}
