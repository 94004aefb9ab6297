//! Straight-edged link plates on a guide.
//!
//! A plate touches a bulging rail where the line between its pins comes nearest to the centre of
//! the arc; the force is shared between the two pins by the lever rule. At an eye, where two
//! plates end, each of them carries half of the contact.

use chaindrive_contact::{Approach, interpolated_onset};
use chaindrive_geometry::{Point, Vector};

use super::{Frame, LawNumbers, Wrench};
use crate::drive::Surface;
use crate::profile::{Probe, Profile};

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
    pub(crate) profile: Profile,
    /// Where the frame's origin lies in the profile's own coordinates.
    pub(crate) reference: Point,
    /// Box around the face (low, high).
    pub(crate) bounds: [Point; 2],
    pub(crate) surface: Surface,
    /// Half the plate height \[m\].
    pub(crate) half_height: f64,
    /// State of each link at the last accepted step.
    pub(crate) memory: Vec<PlateTouch>,
    /// When that was \[s\].
    pub(crate) accepted: f64,
}

/// Contact state of one plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlateTouch {
    /// Gap \[m\].
    pub(crate) gap: f64,
    /// Closing speed \[m/s\].
    pub(crate) closing: f64,
    /// Closing speed at touch \[m/s\]; zero while open.
    pub(crate) onset: f64,
    /// Normal force \[N\].
    pub(crate) force: f64,
    /// State of a friction law that has one.
    pub(crate) stick: f64,
}

impl PlateTouch {
    pub(crate) const FAR: Self = Self {
        gap: 1.0,
        closing: 0.0,
        onset: 0.0,
        force: 0.0,
        stick: 0.0,
    };
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
    /// Where a plate between pins `a` and `b`, in the profile's coordinates, comes nearest.
    pub(crate) fn nearest(&self, a: Point, b: Point) -> PlatePoint {
        let edge = b - a;
        let length_squared = edge.norm_squared().max(f64::MIN_POSITIVE);
        let at = |share: f64| PlatePoint {
            share,
            probe: self.profile.probe(a + edge * share, self.half_height),
            weight: if share > 0.0 && share < 1.0 { 1.0 } else { 0.5 },
        };
        let ends = [0.0, 1.0].into_iter();
        let feet = self
            .profile
            .features
            .iter()
            .filter(|f| f.sign > 0.0 && f.straight == Vector::zeros());
        let feet = feet.map(|f| ((f.centre - a).dot(&edge) / length_squared).clamp(0.0, 1.0));
        ends.chain(feet)
            .map(at)
            .min_by(|p, q| p.probe.gap.total_cmp(&q.probe.gap))
            .unwrap_or_else(|| at(0.5))
    }

    fn far(&self, p: Point) -> bool {
        let reach = 4.0 * self.half_height;
        (0..2).any(|axis| {
            p[axis] < self.bounds[0][axis] - reach || p[axis] > self.bounds[1][axis] + reach
        })
    }

    /// Pushes the pins and returns what the rail receives.
    pub(crate) fn act(
        &self,
        t: f64,
        frame: &Frame,
        pins_of: &mut impl PlatePins,
        links: usize,
        touch: &mut Vec<PlateTouch>,
    ) -> Wrench {
        touch.resize(links, PlateTouch::FAR);
        let numbers = LawNumbers::new(&self.surface);
        let mut wrench = Wrench {
            first_share: 1.0,
            ..Wrench::default()
        };
        for link in 0..links {
            let pins = [0, 1].map(|end| pins_of.place(link, end));
            let [a, b] = pins.map(|pin| frame.local(pin, self.reference));
            touch[link] = PlateTouch::FAR;
            if self.far(a) && self.far(b) {
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
            let closing = -normal.dot(&u);
            let gap = point.probe.gap;
            let mut state = PlateTouch {
                gap,
                closing,
                onset: 0.0,
                force: 0.0,
                stick: 0.0,
            };
            if gap < 0.0 {
                let before = &self.memory[link];
                state.onset = before.onset;
                if before.onset <= 0.0 {
                    state.onset = interpolated_onset(before.gap, before.closing, gap, closing)
                        .max(numbers.floor);
                    let opening = before.gap.max(0.0);
                    wrench.first_depth = wrench.first_depth.max(-gap);
                    wrench.first_share = wrench.first_share.min(opening / (opening - gap));
                }
                let approach = Approach {
                    penetration: -gap,
                    rate: closing,
                    onset_rate: state.onset,
                };
                let law = &self.surface.law;
                state.force = point.weight * law.force(approach);
                let tangent = Vector::new(-normal.y, normal.x);
                let slip = tangent.dot(&u) + frame.spin * self.half_height;
                let friction = &self.surface.friction;
                let rub = friction.rub(state.force, slip, before.stick, t - self.accepted);
                state.stick = rub.state;
                let push = normal * state.force + tangent * rub.force;
                for (pin, share) in shares.into_iter().enumerate() {
                    pins_of.push(link, pin, push * share);
                }
                let foot = d - normal * self.half_height;
                wrench.force[0] -= push.x;
                wrench.force[1] -= push.y;
                wrench.moment -= foot.x * push.y - foot.y * push.x;
                let stored = point.weight * law.elastic_force(-gap);
                wrench.normal_loss += (state.force - stored) * closing;
                wrench.friction_loss -= rub.force * slip;
                wrench.depth = wrench.depth.max(-gap);
                let across = rub.damping.max(friction.damping(state.force, 0.0));
                wrench.damping = wrench.damping.max(law.damping(approach) + across);
            }
            touch[link] = state;
        }
        wrench
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
