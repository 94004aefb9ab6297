//! Orders and sides of the stops of a route in which its chain would close, in the words of a scene.

use chaindrive_geometry::{Rearranged, Side, rearrangements};

use super::wheels::wheels;
use crate::drive::{GuideSupport, Layout, Parts, Stop, Support};

/// Links \[–\] by which a chain may miss a taut route and still be meant for it: what a strain takes up.
const MEANT: f64 = 0.75;

/// The route of one chain of a drive.
pub(super) struct RouteOf<'p> {
    pub(super) parts: &'p Parts,
    pub(super) chain: usize,
    pub(super) stops: &'p [Stop],
}

impl<'p> RouteOf<'p> {
    /// The route of a chain; none where it lies along none.
    pub(super) fn chain(parts: &'p Parts, chain: usize) -> Option<Self> {
        match &parts.chains[chain].layout {
            Layout::Route { stops, .. } => Some(Self {
                parts,
                chain,
                stops,
            }),
            Layout::Points { .. } => None,
        }
    }

    /// Name of a stop, in quotation marks of messages.
    pub(super) fn name(&self, stop: usize) -> String {
        format!("`{}`", self.plain_name(stop))
    }

    fn plain_name(&self, stop: usize) -> &str {
        match self.stops[stop] {
            Stop::Sprocket(index) => &self.parts.sprockets[index].name,
            Stop::Guide(index) => &self.parts.guides[index].name,
        }
    }

    /// Links of the chain \[–\].
    pub(super) fn links(&self) -> f64 {
        self.parts.chains[self.chain].chain.links() as f64
    }

    /// The stops that a tensioner carries.
    pub(super) fn carried_by(&self, tensioner: usize) -> Vec<usize> {
        let carries = |stop: &usize| match self.stops[*stop] {
            Stop::Sprocket(index) => {
                self.parts.sprockets[index].support == Support::Tensioner(tensioner)
            }
            Stop::Guide(index) => {
                self.parts.guides[index].support == GuideSupport::Tensioner(tensioner)
            }
        };
        (0..self.stops.len()).filter(carries).collect()
    }

    /// The ways in which the chain can lie around its stops with one or two changes, and as written.
    pub(super) fn rearrangements(&self) -> Vec<Rearranged> {
        let chain = &self.parts.chains[self.chain].chain;
        let lay = |order: &[usize]| {
            let stops: Vec<Stop> = order.iter().map(|stop| self.stops[*stop]).collect();
            wheels(self.parts, chain, &stops).ok()
        };
        rearrangements(self.stops.len(), &lay, chain.pitch)
    }

    /// The parts with the stops in another way.
    pub(super) fn rearranged(&self, way: &Rearranged) -> Option<(Parts, usize)> {
        let mut parts = self.parts.clone();
        let Layout::Route { stops, .. } = &mut parts.chains[self.chain].layout else {
            return None;
        };
        *stops = way.order.iter().map(|stop| self.stops[*stop]).collect();
        if let Some((stop, side)) = way.turned
            && let Stop::Sprocket(index) = self.stops[stop]
        {
            parts.sprockets[index].side = side;
        }
        Some((parts, self.chain))
    }
}

/// The order or side with which the chain would close where it does not as written, give or take `loose` links \[–\]; or with which it would lie
/// around its stops, where it cannot as written.
pub(super) fn advice(route: &RouteOf<'_>, loose: f64) -> Option<String> {
    let found = route.rearrangements();
    let links = route.links();
    let misfit = |it: &Rearranged| (it.pitches - links).abs();
    let lies = found.first().is_some_and(|it| it.changes == 0);
    let closing = |changes: usize| {
        let tried = found.iter().filter(|it| it.changes == changes);
        Rearranged::nearest(tried.filter(|it| misfit(it) <= MEANT + loose), links)
    };
    let nearest = || {
        let fewest = found.first()?.changes;
        Rearranged::nearest(found.iter().filter(|it| it.changes == fewest), links)
    };
    let best = closing(1)
        .or_else(|| closing(2))
        .or_else(|| nearest().filter(|_| !lies))?;
    Some(told(route, best))
}

/// What a way of lying asks to be written, and what it takes.
pub(super) fn told(route: &RouteOf<'_>, way: &Rearranged) -> String {
    let mut changes = Vec::new();
    if way
        .order
        .iter()
        .enumerate()
        .any(|(place, stop)| place != *stop)
    {
        let names = way
            .order
            .iter()
            .map(|stop| format!("\"{}\"", route.plain_name(*stop)));
        let names: Vec<String> = names.collect();
        changes.push(format!("`stops = [{}]`", names.join(", ")));
    }
    if let Some((stop, side)) = way.turned {
        let side = match side {
            Side::Left => "left",
            Side::Right => "right",
        };
        changes.push(format!("`side = \"{side}\"` at {}", route.name(stop)));
    }
    let strand = way
        .moved()
        .map_or_else(String::new, |[before, own, after]| {
            let [before, own, after] = [before, own, after].map(|stop| route.name(stop));
            format!("{own} lies on the way from {before} to {after}: ")
        });
    format!(
        "{strand}with {} the taut route takes {:.3} links",
        changes.join(" and "),
        way.pitches
    )
}
