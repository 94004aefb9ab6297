//! Another order of the stops of a route, or another side of one of them, with which a chain would close.

use std::f64::consts::TAU;

use crate::{Route, Side, Span, Wheel, WheelKind};

/// Wrap \[rad\] beyond which a stop is on the wrong strand or side. *Assumed*: no chain wraps a wheel by more than eleven twelfths of a turn.
const MOST_WRAP: f64 = 11.0 / 12.0 * TAU;

/// Stops beyond which no other order is tried: there are too many.
const MOST_STOPS: usize = 12;

/// Share of a link below which two routes are equally good.
const ALIKE: f64 = 1e-6;

/// A way in which a chain can lie around the stops of a route.
#[derive(Clone, Debug, PartialEq)]
pub struct Rearranged {
    /// The stops in order, by the places at which they were written.
    pub order: Vec<usize>,
    /// The sprocket that lies on the other side than was written, by its place there, and that side.
    pub turned: Option<(usize, Side)>,
    /// Number of changes \[–\]: a stop elsewhere in the order, two stops exchanged, a sprocket on the other side.
    pub changes: usize,
    /// The wheels in this order.
    pub wheels: Vec<Wheel>,
    /// Links of the taut route \[–\].
    pub pitches: f64,
}

impl Rearranged {
    /// The one of some that a chain of so many links misses least, the first of those that are alike.
    pub fn nearest<'r>(ways: impl Iterator<Item = &'r Self>, links: f64) -> Option<&'r Self> {
        let misfit = |it: &Self| ((it.pitches - links).abs() / ALIKE).round();
        ways.min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
    }

    /// The stop that stands elsewhere than was written, if it is one alone: with those before and after it, by the places at which they were written.
    pub fn moved(&self) -> Option<[usize; 3]> {
        let count = self.order.len();
        let without = |stop: usize| self.order.iter().copied().filter(move |it| *it != stop);
        let in_order = |stop: &usize| without(*stop).is_sorted();
        if self.order.is_sorted() || count < 3 {
            return None;
        }
        // Of two neighbours that are exchanged either has moved.
        let place = (0..count).rfind(|&place| in_order(&self.order[place]))?;
        let at = |step: usize| self.order[(place + step) % count];
        Some([at(count - 1), at(0), at(1)])
    }
}

/// The route as written and all with one or two changes, as far as a chain can lie along them: without crossing itself, and without going round a
/// wheel.
///
/// `lay` makes the wheels of an order of the places at which stops were written. As written comes first, then what has fewer changes.
pub fn rearrangements(
    stops: usize,
    lay: &dyn Fn(&[usize]) -> Option<Vec<Wheel>>,
    pitch: f64,
) -> Vec<Rearranged> {
    let written: Vec<usize> = (0..stops).collect();
    let mut orders = vec![written];
    if (3..=MOST_STOPS).contains(&stops) {
        orders.extend(other_orders(stops));
    }
    let mut found = Vec::new();
    for (index, order) in orders.into_iter().enumerate() {
        let moved = usize::from(index > 0);
        let wheels = lay(&order).unwrap_or_default();
        let turned = (0..wheels.len()).filter_map(|place| turn(&wheels, place));
        let turned =
            turned.map(|(place, wheels)| (Some((order[place], wheels[place].side)), wheels));
        let both = std::iter::once((None, wheels.clone())).chain(turned);
        found.extend(both.filter_map(|(turned, wheels)| {
            let pitches = can_lie(&wheels)?.pitches(pitch);
            Some(Rearranged {
                order: order.clone(),
                turned,
                changes: moved + usize::from(turned.is_some()),
                wheels,
                pitches,
            })
        }));
    }
    // Most sprockets lie on the left: that is what a scene takes where it names no side.
    let to_right = |it: &Rearranged| it.turned.is_some_and(|(_, side)| side == Side::Right);
    found.sort_by_key(|it| (it.changes, to_right(it)));
    found
}

/// The route of wheels that a chain can lie along without crossing itself or going round one of them.
fn can_lie(wheels: &[Wheel]) -> Option<Route> {
    let route = Route::taut(wheels).ok()?;
    let wraps = route.wraps.iter().all(|wrap| *wrap < MOST_WRAP);
    let spans = &route.spans;
    let crosses = (0..spans.len()).any(|i| (0..i).any(|j| cross(&spans[i], &spans[j])));
    (wraps && !crosses).then_some(route)
}

/// Whether two spans cross.
fn cross(a: &Span, b: &Span) -> bool {
    let (u, v) = (a.arrives - a.leaves, b.arrives - b.leaves);
    let parts = |w: crate::Vector, from: crate::Point, [p, q]: [crate::Point; 2]| {
        w.perp(&(p - from)) * w.perp(&(q - from)) < 0.0
    };
    parts(u, a.leaves, [b.leaves, b.arrives]) && parts(v, b.leaves, [a.leaves, a.arrives])
}

/// The wheels with one sprocket on the other side.
fn turn(wheels: &[Wheel], place: usize) -> Option<(usize, Vec<Wheel>)> {
    let mut wheels = wheels.to_vec();
    let wheel = &mut wheels[place];
    if wheel.kind == WheelKind::Smooth {
        return None;
    }
    wheel.side = match wheel.side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    };
    Some((place, wheels))
}

/// Orders in which one stop stands elsewhere or two are exchanged, the first one staying: a loop has no beginning.
fn other_orders(stops: usize) -> Vec<Vec<usize>> {
    let written: Vec<usize> = (0..stops).collect();
    let mut orders: Vec<Vec<usize>> = Vec::new();
    for from in 1..stops {
        for to in 1..stops {
            let mut moved = written.clone();
            let stop = moved.remove(from);
            moved.insert(to, stop);
            let mut exchanged = written.clone();
            exchanged.swap(from, to);
            for order in [moved, exchanged] {
                if order != written && !orders.contains(&order) {
                    orders.push(order);
                }
            }
        }
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;

    const PITCH: f64 = 12.7e-3;

    /// Two sprockets, and an idler outside of the run that comes back.
    fn wheels(side: Side) -> [Wheel; 3] {
        let sprocket = |x, y, teeth, side| Wheel::toothed(Point::new(x, y), teeth, PITCH, side);
        [
            sprocket(0.0, 0.0, 19, Side::Left),
            sprocket(0.45, 0.0, 38, Side::Left),
            sprocket(0.2, 0.02, 15, side),
        ]
    }

    fn lay(wheels: &[Wheel], order: [usize; 3]) -> impl Fn(&[usize]) -> Option<Vec<Wheel>> {
        move |places| Some(places.iter().map(|at| wheels[order[*at]]).collect())
    }

    /// An idler between the wrong two stops makes a route of 103.6 links, one between the right two of 101.2.
    #[test]
    fn a_stop_goes_to_another_strand() {
        let wheels = wheels(Side::Right);
        let found = rearrangements(3, &lay(&wheels, [0, 2, 1]), PITCH);
        assert_eq!(found[0].changes, 0);
        let moved = found
            .iter()
            .find(|it| it.order == [0, 2, 1] && it.turned.is_none());
        let moved = moved.expect("the chain can lie so");
        assert!((moved.pitches - 101.2).abs() < 0.1 && moved.pitches + 2.0 < found[0].pitches);
    }

    #[test]
    fn a_sprocket_goes_to_the_other_side() {
        let mut wheels = wheels(Side::Right);
        wheels[1].side = Side::Right;
        let found = rearrangements(3, &lay(&wheels, [0, 1, 2]), PITCH);
        let first = found.first().expect("one is possible");
        assert_eq!((first.changes, first.turned), (1, Some((1, Side::Left))));
    }
}
