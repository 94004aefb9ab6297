//! Straight-edged link plates on a guide.
//!
//! A plate touches a bulging rail where the line between its pins comes nearest to the centre of
//! the arc; the force is shared between the two pins by the lever rule. At an eye, where two
//! plates end, each of them carries half of the contact.

use chaindrive_geometry::{Point, Vector};

use super::window::{FAR, Places};
use super::{ContactMemory, Frame, LaneTally, MemoryLanes, SurfaceLaw, Wrench};
use crate::drive::Surface;
use crate::lanes::Wide;
use crate::profile::{Probe, RailFace};

/// Where the pins of the link plates are, whatever the chain is made of.
pub(crate) trait PlatePlaces {
    /// Place of a link's first (0) or second (1) pin.
    fn place(&self, link: usize, end: usize) -> Point;
}

/// How they move, and what they bear.
pub(crate) trait PlatePins: PlatePlaces {
    /// Velocity of a link's first (0) or second (1) pin.
    fn velocity(&self, link: usize, end: usize) -> Vector;
    /// Takes a force \[N\] on that pin.
    fn push(&mut self, link: usize, end: usize, force: Vector);
}

/// Contacts of all links with one rail.
#[derive(Clone, Debug)]
pub(crate) struct PlateContact {
    pub(crate) face: RailFace,
    /// Where the frame's origin lies in the face's own coordinates.
    pub(crate) reference: Point,
    /// Box around the face (low, high).
    pub(crate) bounds: [Point; 2],
    pub(crate) surface: Surface,
    /// The same, ready for lanes.
    law: SurfaceLaw,
    /// Half the plate height \[m\].
    pub(crate) half_height: f64,
    /// Links that can touch before the next look.
    pub(super) near: Vec<usize>,
    /// State of each link at the last accepted step.
    pub(crate) memory: ContactMemory,
    /// When that was \[s\].
    pub(crate) accepted: f64,
}

/// Where on its edge a plate touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlatePoint {
    /// Share of the way from the first pin to the second.
    pub(crate) share: f64,
    /// What the edge faces there.
    pub(crate) probe: Probe,
    /// Share of the contact that this plate carries: a half at an eye.
    pub(crate) weight: f64,
}

impl PlateContact {
    pub(crate) fn new(
        face: RailFace,
        reference: Point,
        bounds: [Point; 2],
        surface: Surface,
        half_height: f64,
        links: usize,
    ) -> Self {
        Self {
            face,
            reference,
            bounds,
            surface,
            law: SurfaceLaw::new(&surface, None),
            half_height,
            near: Vec::new(),
            memory: ContactMemory::open(links),
            accepted: 0.0,
        }
    }

    /// Where a plate between pins `a` and `b`, in the face's coordinates, comes nearest.
    pub(crate) fn nearest(&self, a: Point, b: Point) -> PlatePoint {
        let edge = b - a;
        let length_squared = edge.norm_squared().max(f64::MIN_POSITIVE);
        let at = |share: f64| PlatePoint {
            share,
            probe: self.face.probe(a + edge * share, self.half_height),
            weight: if share > 0.0 && share < 1.0 { 1.0 } else { 0.5 },
        };
        let ends = [0.0, 1.0].into_iter();
        let feet = self
            .face
            .features_along(a, b)
            .filter(|f| f.sign > 0.0 && f.straight == Vector::zeros());
        let feet = feet.map(|f| ((f.centre - a).dot(&edge) / length_squared).clamp(0.0, 1.0));
        ends.chain(feet)
            .map(at)
            .min_by(|p, q| p.probe.gap.total_cmp(&q.probe.gap))
            .unwrap_or_else(|| at(0.5))
    }

    /// Looks which links can touch before the next look: none of their pins crosses the margin until then.
    pub(crate) fn renew(&mut self, frame: &Frame, places: Places<'_>, margin: f64) {
        let mut near = std::mem::take(&mut self.near);
        let far = |roller: usize| {
            let pin = Point::new(places.x[roller], places.y[roller]);
            self.beyond(frame.local(pin, self.reference), margin)
        };
        let links = 0..self.memory.gap.len();
        let all = links.filter(|&link| !(far(link) && far((link + 1) % places.count)));
        near.clear();
        near.extend(all);
        self.near = near;
    }

    fn far(&self, p: Point) -> bool {
        self.beyond(p, 0.0)
    }

    /// Whether a place in the face's coordinates is farther from its box than a plate reaches, by a margin \[m\].
    fn beyond(&self, p: Point, margin: f64) -> bool {
        let reach = 4.0 * self.half_height + margin;
        (0..2).any(|axis| {
            p[axis] < self.bounds[0][axis] - reach || p[axis] > self.bounds[1][axis] + reach
        })
    }

    /// Pushes the pins and returns what the rail receives.
    ///
    /// The edges are looked at one by one, so that the lanes of the laws are one wide.
    pub(crate) fn act(
        &self,
        t: f64,
        frame: &Frame,
        pins_of: &mut impl PlatePins,
        links: usize,
        touch: &mut ContactMemory,
    ) -> Wrench {
        if touch.gap.len() != links {
            touch.reopen(links);
        }
        let w = Wide(pulp::Scalar);
        let dt = t - self.accepted;
        let mut memory = MemoryLanes::new(w, &self.memory, touch, links);
        let mut tally = LaneTally::new(w);
        let mut wrench = Wrench::default();
        for &link in &self.near {
            let pins = [0, 1].map(|end| pins_of.place(link, end));
            let [a, b] = pins.map(|pin| frame.local(pin, self.reference));
            if self.far(a) && self.far(b) {
                memory.look(link, w.splat(FAR), w.splat(0.0));
                memory.open(w, link);
                continue;
            }
            let point = self.nearest(a, b);
            let normal = frame.outward(point.probe.normal);
            let shares = [1.0 - point.share, point.share];
            let speed = |pin: usize| pins_of.velocity(link, pin);
            let d = (pins[0] - frame.origin) * shares[0] + (pins[1] - frame.origin) * shares[1];
            // u = v − v_o − ω ẑ × d
            let u = speed(0) * shares[0] + speed(1) * shares[1]
                - frame.velocity
                - Vector::new(-d.y, d.x) * frame.spin;
            let surfaces = [point.probe.gap, -normal.dot(&u)].map(|number| w.splat(number));
            let weight = Some(w.splat(point.weight));
            let pressed = self.law.press(
                w,
                &mut memory,
                link,
                surfaces,
                None,
                weight,
                None,
                &mut tally,
            );
            let Some(pressed) = pressed else { continue };
            let tangent = Vector::new(-normal.y, normal.x);
            let slip = w.splat(tangent.dot(&u) + frame.spin * self.half_height);
            let rubbing = self
                .law
                .rub(w, &mut memory, link, dt, &pressed, slip, &mut tally);
            let force = pressed.force.sum();
            let push = normal * force + tangent * rubbing.force.sum();
            for (pin, share) in shares.into_iter().enumerate() {
                pins_of.push(link, pin, push * share);
            }
            let foot = d - normal * self.half_height;
            wrench.force[0] -= push.x;
            wrench.force[1] -= push.y;
            wrench.moment -= foot.x * push.y - foot.y * push.x;
            let across = rubbing.drag.sum().max(self.law.friction.at_rest(force));
            let damping = self.law.steepest(w, &pressed).sum() + across;
            wrench.damping = wrench.damping.max(damping);
        }
        tally.total(self.law.friction.acts(), wrench)
    }

    /// Sum of the elastic energies \[J\].
    pub(crate) fn stored(&self, pins_of: &impl PlatePlaces, frame: &Frame, links: usize) -> f64 {
        (0..links)
            .map(|link| {
                let [a, b] =
                    [0, 1].map(|end| frame.local(pins_of.place(link, end), self.reference));
                if self.far(a) && self.far(b) {
                    return 0.0;
                }
                let point = self.nearest(a, b);
                point.weight * self.surface.law.energy(-point.probe.gap)
            })
            .sum()
    }
}
