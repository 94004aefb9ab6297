//! Tensioners that push what they carry away from the chain: no equilibrium is to be had, whatever the pretension.
//!
//! ```text
//! Q = F ∂x/∂s + Σ m g·∂x/∂s + Σ F·∂x/∂s,   Q dL/ds < 0        L: length of the taut route, s: coordinate of the tensioner
//! ```

use chaindrive_geometry::{Point, Rearranged, Route, Vector};

use super::rearranging::{RouteOf, told};
use super::wheels::{shifted, wheels};
use crate::drive::{Adjust, Layout, Parts, Sprocket, Support};
use crate::tensioner::Weight;
use crate::{AssemblyError, Push};

/// Length of the route \[pitches\] that a push may give away until it is spent: less is adjustment.
const GIVEN_AWAY: f64 = 0.5;

/// Share of its links by which a chain may miss another route that is told: more is a route of another drive.
const ABOUT: f64 = 0.1;

/// Travel for the difference quotient \[pitches\].
const STEP: f64 = 1e-3;

/// Refuses the first tensioner that pushes away from every chain that passes what it carries.
pub(super) fn check(parts: &Parts, begin: f64) -> Result<(), AssemblyError> {
    for tensioner in 0..parts.tensioners.len() {
        let routes = (0..parts.chains.len()).filter_map(|chain| RouteOf::chain(parts, chain));
        let routes: Vec<RouteOf<'_>> = routes.collect();
        let force = force(parts, begin, tensioner);
        // Between two chains a push leaves one of them.
        if routes
            .iter()
            .any(|route| slope(route, tensioner) * force > 0.0)
        {
            continue;
        }
        for route in routes {
            if let Some(error) = away(&route, force, tensioner) {
                let name = parts.chains[route.chain].name.as_ref();
                return Err(error.of_chains(std::iter::once(name)));
            }
        }
    }
    Ok(())
}

fn away(route: &RouteOf<'_>, force: f64, tensioner: usize) -> Option<AssemblyError> {
    let parts = route.parts;
    let carried = route.carried_by(tensioner);
    let loosens = loosening(route, tensioner, force)?;
    let own = &parts.tensioners[tensioner];
    // A spring that is spent before the chain is slack only adjusts it.
    let lever = own.carrier.extension(0.0).lever;
    let stiffness = own.push.relaxed().stiffness(0.0) * lever * lever;
    if stiffness > 0.0 && force.abs() / stiffness * loosens < GIVEN_AWAY {
        return None;
    }
    let first = *carried.first()?;
    let better = |it: &&Rearranged| {
        it.changes > 0 && {
            let changed = route.rearranged(it);
            let other = changed.as_ref().map(|(parts, chain)| (parts, *chain));
            other.is_some_and(|(parts, chain)| {
                RouteOf::chain(parts, chain).is_some_and(|it| slope(&it, tensioner) * force > 0.0)
            })
        }
    };
    let found = route.rearrangements();
    // What puts the tensioner itself elsewhere is asked for before anything else is.
    let links = route.links();
    let near = |it: &&Rearranged| (it.pitches - links).abs() < ABOUT * links;
    let of_changes = |count: usize| {
        let tried = found.iter().filter(|it| it.changes == count);
        Rearranged::nearest(tried.filter(near).filter(better), links)
    };
    let fewest = of_changes(1).or_else(|| of_changes(2));
    let count = route.stops.len();
    let [before, after] = [count - 1, 1].map(|step| route.name((first + step) % count));
    let names: Vec<String> = carried.iter().map(|stop| route.name(*stop)).collect();
    let turn = match (own.carrier.coordinate_unit(), own.carrier.push_unit()) {
        ("m", _) => "turn its direction round",
        (_, "N") => "turn the direction of its plunger round",
        _ => "turn the sign of its preload",
    };
    let other = fewest.map_or_else(
        || format!("put {} elsewhere in `stops`", names.join(" and ")),
        |it| told(route, it),
    );
    Some(AssemblyError::PushesAway {
        tensioner: own.name.clone(),
        carried: names.join(" and "),
        between: Box::new([before, after]),
        remedy: format!("{turn}, or {other}"),
    })
}

/// Generalised force of push, weight and forces from outside on a tensioner where the drive is assembled \[N or N m\].
fn force(parts: &Parts, begin: f64, tensioner: usize) -> f64 {
    let own = &parts.tensioners[tensioner];
    let push = own.push.relaxed();
    let pushed = push
        .force(0.0, 0.0, push.settled(0.0).unwrap_or(0.0))
        .elastic;
    let carried = parts
        .sprockets
        .iter()
        .filter(|it| it.support == Support::Tensioner(tensioner));
    let carried: Vec<&Sprocket> = carried.collect();
    let weights: Vec<Weight> = carried.iter().map(|it| (it.mass, it.centre)).collect();
    let centres = carried.iter().map(|it| (&it.forces, it.centre));
    let own_point = own.forced_at.unwrap_or_else(Point::origin);
    let forced = centres.chain([(&own.forces, own_point)]);
    // Q = F·∂x/∂s
    let along = forced.filter(|(forces, _)| !forces.is_empty());
    let along = along.map(|(forces, at)| {
        Vector::from(forces.unturned(begin)).dot(&own.carrier.carry(0.0, at).1)
    });
    let along: f64 = along.sum();
    let own_force = pushed * own.carrier.extension(0.0).lever
        + own.carrier.weight(0.0, &weights, parts.gravity);
    own_force + along
}

/// Links \[–\] that the route becomes shorter by for every unit of the coordinate, where the push does that; none where it does not, or there is none.
fn loosening(route: &RouteOf<'_>, tensioner: usize, force: f64) -> Option<f64> {
    if route.parts.tensioners[tensioner].push == Push::Locked {
        return None;
    }
    let slope = slope(route, tensioner);
    (slope * force < 0.0).then_some(slope.abs())
}

/// Links \[–\] that the route grows by for every unit of the coordinate of a tensioner; 0 where it carries nothing of the route.
fn slope(route: &RouteOf<'_>, tensioner: usize) -> f64 {
    let placed = &route.parts.chains[route.chain];
    let Layout::Route { stops, .. } = &placed.layout else {
        return 0.0;
    };
    if route.carried_by(tensioner).is_empty() {
        return 0.0;
    }
    let pitch = placed.chain.pitch;
    let reach = route.parts.tensioners[tensioner].carrier.reach();
    let step = STEP * pitch / reach;
    let within = 1.0;
    let length = |travel: f64| {
        let moved = shifted(
            route.parts,
            &Adjust::Tensioner { tensioner, within },
            travel,
        )
        .ok()?;
        let wheels = wheels(&moved, &placed.chain, stops).ok()?;
        Some(Route::taut(&wheels).ok()?.pitches(pitch))
    };
    match (length(step), length(-step)) {
        (Some(ahead), Some(behind)) => (ahead - behind) / (2.0 * step),
        _ => 0.0,
    }
}
