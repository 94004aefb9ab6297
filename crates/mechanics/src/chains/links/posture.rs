//! Positions and velocities of the links and rollers of a linkage.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, kernel};
use serde::{Deserialize, Serialize};

use super::Linkage;
use crate::End;
use crate::joints::{Mate, Part, Sides, Tip};
use crate::lanes::{LANES, Lane, Wide, padded};
use crate::seam::Pose;

/// Places and velocities that follow from the coordinates.
///
/// Link i lies between the joints i and i + 1; after the last link of a closed chain comes joint 0 again, once more
/// under the number after the last.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Posture {
    /// At every joint the end of the link before it.
    pub(crate) before: Sides,
    /// At every joint the end of the link after it.
    pub(crate) after: Sides,
    /// Centres of the circles that run on the teeth, (stride,), and their velocities; after the last
    /// roller of a closed chain stand copies of the first ones.
    pub(crate) x: Array,
    pub(crate) y: Array,
    pub(crate) vx: Array,
    pub(crate) vy: Array,
    /// Coordinates and velocities of the links, each by itself.
    links: [Array; 6],
}

/// Constants of the links, whole lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shapes {
    /// Both joint ends from the centre of mass, in the frame of the link \[m\].
    arms: [[Array; 2]; 2],
    /// Inverse mass \[1/kg\] and inertia \[1/(kg m²)\] of link i after place i + 1; before the first link of a
    /// closed chain comes the last, and beside those of an open one nothing that moves.
    pub(crate) mobility: Array,
    pub(crate) turning: Array,
    /// Inverse mass and inertia of every body, free rollers included.
    pub(crate) mobilities: Vec<[f64; 2]>,
    /// Their roots.
    pub(crate) roots: Vec<[f64; 2]>,
    /// Square of length between the joints over inertia of every link, p²/I² \[1/(kg² m²)\].
    pub(crate) swing: Array,
    /// Inertia of the link that turns most easily \[kg m²\].
    pub(crate) least_inertia: f64,
    /// Largest damping rate of a link by itself over its drag per length b \[m/kg\], its centre of mass e away from its middle.
    ///
    /// ```text
    /// D/b ≤ ℓ/m + ℓ (ℓ²/12 + e²)/I
    /// ```
    pub(crate) most_dragged: f64,
    /// Masses of the lightest link and the lightest free roller \[kg\]; infinite where there is none.
    pub(crate) lightest: [f64; 2],
}

impl Shapes {
    /// Reads them off the bodies, of which the first are links.
    pub(crate) fn of(bodies: &[super::Body], links: usize, closed: bool) -> Self {
        let mobilities: Vec<[f64; 2]> = bodies
            .iter()
            .map(|body| [1.0 / body.mass, 1.0 / body.inertia])
            .collect();
        let count = links;
        let links = &bodies[..count];
        let all = |value: &dyn Fn(&super::Body) -> f64| {
            let mut values: Array = links.iter().map(value).collect();
            values.resize(padded(links.len()), 0.0);
            values
        };
        let shifted = |value: &dyn Fn(&super::Body) -> f64| {
            let mut values = Array::zeros(padded(count + 1) + LANES);
            for (value_of, link) in values[1..].iter_mut().zip(links) {
                *value_of = value(link);
            }
            if closed {
                values[0] = values[count];
                values[count + 1] = values[1];
            }
            values
        };
        let inertias = links.iter().map(|link| link.inertia);
        let swing = |link: &super::Body| {
            (link.arms[1] - link.arms[0]).norm_squared() / (link.inertia * link.inertia)
        };
        let dragged = |link: &super::Body| {
            let length = (link.arms[1] - link.arms[0]).norm();
            let off = 0.25 * (link.arms[0] + link.arms[1]).norm_squared();
            length * (1.0 / link.mass + (length * length / 12.0 + off) / link.inertia)
        };
        Self {
            swing: links.iter().map(swing).collect(),
            least_inertia: inertias.fold(f64::INFINITY, f64::min),
            most_dragged: links.iter().map(dragged).fold(0.0, f64::max),
            lightest: [links, &bodies[count..]].map(|bodies| {
                let masses = bodies.iter().map(|body| body.mass);
                masses.fold(f64::INFINITY, f64::min)
            }),
            arms: [0, 1].map(|end| [all(&|link| link.arms[end].x), all(&|link| link.arms[end].y)]),
            mobility: shifted(&|link| 1.0 / link.mass),
            turning: shifted(&|link| 1.0 / link.inertia),
            roots: mobilities.iter().map(|all| all.map(f64::sqrt)).collect(),
            mobilities,
        }
    }
}

impl Shapes {
    /// Length of arrays by joint with one more at either end, in whole lanes.
    pub(crate) fn lanes(&self) -> usize {
        self.mobility.len()
    }
}

impl Posture {
    /// One end of a link: 0 towards the joint of its own number, 1 towards the next.
    #[inline]
    pub(crate) fn tip(&self, link: usize, end: usize) -> Tip {
        if end == 0 {
            self.after.tip(link)
        } else {
            self.before.tip(link + 1)
        }
    }

    /// The same end from the centre of mass \[m\].
    #[inline(always)]
    pub(crate) fn arm(&self, link: usize, end: usize) -> Vector {
        if end == 0 {
            self.after.arm(link)
        } else {
            self.before.arm(link + 1)
        }
    }

    /// The sides before and after the joints.
    pub(crate) fn sides(&self) -> [&Sides; 2] {
        [&self.before, &self.after]
    }

    /// Pose of the circles that run on the teeth.
    pub(crate) fn pose(&self) -> Pose<'_> {
        Pose {
            x: &self.x,
            y: &self.y,
            vx: &self.vx,
            vy: &self.vy,
        }
    }

    /// Length of the sides: whole lanes of joints, of which a strand has one more than links, are read from one joint further on.
    fn room(linkage: &Linkage) -> usize {
        padded(linkage.series.links + 1) + LANES
    }

    fn resize(&mut self, linkage: &Linkage) {
        let count = Self::room(linkage);
        let sides = [&mut self.before, &mut self.after];
        for values in sides.into_iter().flat_map(Sides::all) {
            values.resize(count, 0.0);
        }
        for values in &mut self.links {
            values.resize(padded(linkage.series.links), 0.0);
        }
        for values in [&mut self.x, &mut self.y, &mut self.vx, &mut self.vy] {
            values.resize(linkage.series.stride.max(padded(linkage.joints.len())), 0.0);
        }
    }
}

impl Linkage {
    /// Works out the posture of a state.
    pub(crate) fn pose_links(&self, at: Moment<'_>, posture: &mut Posture) {
        if posture.before.x.len() != Posture::room(self) {
            posture.resize(self);
        }
        let [x, y, angle, vx, vy, spin] = &mut posture.links;
        for (from, [a, b, c]) in [(at.q, [x, y, angle]), (at.v, [vx, vy, spin])] {
            let links = from[..3 * self.series.links].as_chunks::<3>().0;
            for (((from, a), b), c) in links.iter().zip(a).zip(b).zip(c) {
                [*a, *b, *c] = *from;
            }
        }
        self.series.registers.dispatch(link_ends(self, posture));
        self.pose_ends(at, posture);
        self.pose_rollers(at, posture);
    }

    /// Sets the neighbours of the first and the last link.
    fn pose_ends(&self, at: Moment<'_>, posture: &mut Posture) {
        let last = self.series.links;
        if self.series.is_closed() {
            let tip = posture.before.tip(last);
            let spin = posture.before.spin[last];
            posture.before.set(0, &Part::of_link(last - 1, tip, spin));
            let tip = posture.after.tip(0);
            let spin = posture.after.spin[0];
            posture.after.set(last, &Part::of_link(0, tip, spin));
        } else {
            posture.before.set(0, &self.ground(0, at));
            posture.after.set(last, &self.ground(1, at));
        }
    }

    fn pose_rollers(&self, at: Moment<'_>, posture: &mut Posture) {
        let joints = self.joints.len();
        let registers = self.series.registers;
        registers.dispatch(fixed_circles(&self.pairs.bush_after, posture));
        if let Some(free) = &self.free_rollers {
            for (joint, body) in free.body.iter().enumerate() {
                let Some(body) = *body else { continue };
                let part = free_part(body, at);
                posture.x[joint] = part.place.x;
                posture.y[joint] = part.place.y;
                posture.vx[joint] = part.velocity.x;
                posture.vy[joint] = part.velocity.y;
            }
        }
        for joint in joints..self.series.stride {
            for values in [
                &mut posture.x,
                &mut posture.y,
                &mut posture.vx,
                &mut posture.vy,
            ] {
                values[joint] = if self.series.is_closed() {
                    values[joint - joints]
                } else {
                    0.0
                };
            }
            if !self.series.is_closed() {
                // After a strand stand still points one pitch apart.
                posture.x[joint] = posture.x[joint - 1] + self.series.pitch;
                posture.y[joint] = posture.y[joint - 1];
            }
        }
    }

    /// The body that bears the circle at a joint that runs on the teeth, and the circle's centre from its centre of mass \[m\].
    pub(super) fn bearer(&self, joint: usize, posture: &Posture) -> (Option<usize>, Vector) {
        // After the last joint of a closed chain the first ones are repeated.
        let count = self.joints.len();
        let joint = if joint < count { joint } else { joint % count };
        if let Some(body) = self.free_rollers.as_ref().and_then(|free| free.body[joint]) {
            return (Some(body), Vector::zeros());
        }
        match self.joints[joint].carrier {
            Mate::Link { link, end } => (Some(link), posture.arm(link, end)),
            Mate::Ground(_) => (None, Vector::zeros()),
        }
    }

    /// One side of a joint.
    #[inline]
    pub(crate) fn part(&self, mate: Mate, at: Moment<'_>, posture: &Posture) -> Part {
        match mate {
            Mate::Link { link, end } => {
                Part::of_link(link, posture.tip(link, end), at.v[3 * link + 2])
            }
            Mate::Ground(end) => self.ground(end, at),
        }
    }

    /// A support at an end of the strand.
    pub(super) fn ground(&self, end: usize, at: Moment<'_>) -> Part {
        let held = self.series.ends.get(end);
        let (shift, velocity) = match held.map(|held| &held.end) {
            Some(End::Driven { x, y }) => {
                let (x, y) = (x.at(at.t), y.at(at.t));
                (
                    Vector::new(x.position, y.position),
                    Vector::new(x.rate, y.rate),
                )
            }
            Some(End::Free | End::Fixed | End::Pulled { .. }) | None => {
                (Vector::zeros(), Vector::zeros())
            }
        };
        Part {
            body: None,
            place: held.map_or_else(Point::origin, |held| held.place) + shift,
            velocity,
            arm: Vector::zeros(),
            spin: 0.0,
        }
    }
}

kernel!(
    /// The ends of all links.
    fn link_ends<'a, S: Simd>(w: Wide<S>, linkage: &'a Linkage, posture: &'a mut Posture) {
        let shapes = &linkage.shapes;
        let Posture {
            before,
            after,
            links,
            ..
        } = posture;
        let [x, y, angle, vx, vy, spin] = links;
        for start in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let [x, y, vx, vy, spin] = [&x, &y, &vx, &vy, &spin].map(|all| w.load(all, start));
            // Both ends of each link turn with it.
            let [s, c] = w.load(angle, start).sin_cos();
            // Link i begins at joint i and ends at the next.
            for (side, [arm_x, arm_y], joint) in [
                (&mut *after, &shapes.arms[0], start),
                (&mut *before, &shapes.arms[1], start + 1),
            ] {
                // P = r + R(φ) s,   Ṗ = ṙ + ω ẑ × R s
                let [a, b] = [w.load(arm_x, start), w.load(arm_y, start)];
                let [arm_x, arm_y] = [c * a - s * b, s * a + c * b];
                let put = |value: Lane<S>, to: &mut [f64]| value.store(to, joint);
                put(x + arm_x, &mut side.x);
                put(y + arm_y, &mut side.y);
                put(vx - spin * arm_y, &mut side.vx);
                put(vy + spin * arm_x, &mut side.vy);
                put(arm_x, &mut side.arm_x);
                put(arm_y, &mut side.arm_y);
                put(spin, &mut side.spin);
            }
        }
    }
);

kernel!(
    /// The circles of rollers that are fixed to their links.
    fn fixed_circles<'a, S: Simd>(
        w: Wide<S>,
        /// One where the bush is on the side after, zero elsewhere.
        bush_after: &'a [f64],
        posture: &'a mut Posture,
    ) {
        let Posture {
            before,
            after,
            x,
            y,
            vx,
            vy,
            ..
        } = posture;
        for start in (0..bush_after.len()).step_by(Wide::<S>::COUNT) {
            let on_after = w.load(bush_after, start).greater(w.splat(0.0));
            for (to, after, before) in [
                (&mut *x, &after.x, &before.x),
                (&mut *y, &after.y, &before.y),
                (&mut *vx, &after.vx, &before.vx),
                (&mut *vy, &after.vy, &before.vy),
            ] {
                on_after
                    .select(w.load(after, start), w.load(before, start))
                    .store(to, start);
            }
        }
    }
);

/// A free roller, whose circle is about its centre of mass.
pub(crate) fn free_part(body: usize, at: Moment<'_>) -> Part {
    let [x, y, vx, vy] = [
        at.q[3 * body],
        at.q[3 * body + 1],
        at.v[3 * body],
        at.v[3 * body + 1],
    ];
    Part {
        body: Some(body),
        place: Point::new(x, y),
        velocity: Vector::new(vx, vy),
        arm: Vector::zeros(),
        spin: at.v[3 * body + 2],
    }
}
