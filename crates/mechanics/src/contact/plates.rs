//! Straight-edged link plates on a guide.
//!
//! A plate touches a bulging rail where the line between its pins comes nearest to the centre of
//! the arc; the force is shared between the two pins by the lever rule. At an eye, where two
//! plates end, each of them carries half of the contact.
//!
//! Links are looked at in lanes of consecutive ones, as the chain has them: lanes near the guide are listed anew with the windows.
//! Lanes that nothing can reach for a while rest, where the chain says how its pins are accelerated.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::kernel;
use pulp::Simd;

use super::memory::FAR;
use super::predicted::PredictedLane;
use super::resting_lanes::Clear;
use super::window::Places;
use super::wrench::Sums;
use super::{AWAKE, Frame, MemoryField, MemoryLanes, SurfaceLaw, Touch, Wrench};
use crate::lanes::{LANES, Lane, Wide, padded};
use crate::profile::{Probe, RailFace};
use crate::surface::Surface;

/// A vector for each of the two pins of the links of a lane.
pub(crate) type OfPins<S> = [[Lane<S>; 2]; 2];

/// Accelerations of the pins of a lane of links, where pins are point masses.
#[derive(Clone, Copy)]
pub(crate) struct PinAccelerations<S: Simd> {
    /// Accelerations \[m/s²\] by all that was found so far.
    pub(crate) by: OfPins<S>,
    /// Inverse masses \[1/kg\].
    pub(crate) inverse_masses: [Lane<S>; 2],
    /// Half of the step \[s\] at whose end velocities are predicted; zero where they are what they are.
    pub(crate) half_step: f64,
}

/// Pins of lanes of consecutive links: positions, velocities, and forces on them.
pub(crate) trait PlatePins {
    /// Places \[m\] of the pins of the lane that begins with a link.
    fn places<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S>;
    /// Velocities \[m/s\].
    fn velocities<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S>;
    /// Accelerations of pins that are point masses; none for others, whose lanes may not rest.
    fn drawn<S: Simd>(&self, w: Wide<S>, link: usize) -> Option<PinAccelerations<S>>;
    /// Takes forces \[N\] on the pins; those on links after the last one are nothing.
    fn push<S: Simd>(&mut self, w: Wide<S>, link: usize, forces: OfPins<S>);
}

kernel!(
    /// All contacts with one rail as one call: kernels that call it stay short.
    pub(crate) fn pressing<'a, S: Simd, P: PlatePins>(
        w: Wide<S>,
        plates: &'a PlateContact,
        t: f64,
        frame: Frame,
        pins: &'a mut P,
        /// By how much the guide yields to one plate \[1/kg\].
        yielding: f64,
        touch: &'a mut Touch,
    ) -> Wrench {
        plates.act(w, t, &frame, pins, yielding, touch)
    }
);

/// Contacts of all links with one rail.
#[derive(Clone, Debug)]
pub(crate) struct PlateContact {
    pub(crate) face: RailFace,
    /// Origin of the frame in the coordinates of the face.
    pub(crate) reference: Point,
    /// Box around the face (low, high).
    pub(crate) bounds: [Point; 2],
    pub(crate) surface: Surface,
    /// The same, ready for lanes.
    law: SurfaceLaw,
    /// Half the plate height \[m\].
    pub(crate) half_height: f64,
    /// Number of links.
    pub(super) links: usize,
    /// First links of the lanes of eight in which some can touch before the next look.
    pub(super) near: Vec<usize>,
    /// State of each link at the last accepted step, whole lanes.
    pub(crate) memory: Box<Touch>,
    /// When that was \[s\].
    pub(crate) accepted: f64,
}

/// Point of a plate's edge that touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlatePoint {
    /// Share of the way from the first pin to the second.
    pub(crate) share: f64,
    /// Surface that the edge faces there.
    pub(crate) probe: Probe,
    /// Share of the contact that this plate carries: a half at an eye.
    pub(crate) weight: f64,
}

/// The same for a lane of plates.
#[derive(Clone, Copy)]
struct LanePlatePoint<S: Simd> {
    share: Lane<S>,
    gap: Lane<S>,
    /// Outward normal in the face's coordinates.
    nx: Lane<S>,
    ny: Lane<S>,
}

/// Half heights around the box of a face within which a plate is looked at.
const REACH: f64 = 4.0;

/// A lane of links.
#[derive(Clone, Copy)]
struct PlateLane {
    lane: usize,
    link: usize,
    /// By how much the guide yields to all plates \[1/kg\].
    yielding: f64,
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
            links,
            near: Vec::new(),
            memory: {
                let mut memory = Box::<Touch>::default();
                memory.open(padded(links));
                memory
            },
            accepted: 0.0,
        }
    }

    /// Nearest point of a plate between pins `a` and `b`, in the coordinates of the face.
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

    /// Looks which lanes can touch before the next look: none of the pins of the others crosses the margin until then.
    pub(crate) fn renew(&mut self, frame: &Frame, places: Places<'_>, margin: f64) {
        let mut near = std::mem::take(&mut self.near);
        let far = |roller: usize| {
            let pin = Point::new(places.x[roller], places.y[roller]);
            self.room(frame, pin) > margin
        };
        let reached = |link: usize| !(far(link) && far((link + 1) % places.count));
        near.clear();
        let lanes = (0..self.links).step_by(LANES);
        near.extend(lanes.filter(|&first| {
            let behind = self.links.min(first + LANES);
            (first..behind).any(reached)
        }));
        self.near = near;
    }

    fn far(&self, p: Point) -> bool {
        self.beyond(p) > 0.0
    }

    /// Least distance \[m\] of a pin at a place from touching with its plates; nothing or less where they may touch.
    pub(crate) fn room(&self, frame: &Frame, place: Point) -> f64 {
        self.beyond(frame.local(place, self.reference))
    }

    /// Distance \[m\] of a place in the face's coordinates from its box, less the reach of a plate.
    fn beyond(&self, p: Point) -> f64 {
        let beside = |axis: usize| {
            f64::max(
                self.bounds[0][axis] - p[axis],
                p[axis] - self.bounds[1][axis],
            )
        };
        beside(0).max(beside(1)) - REACH * self.half_height
    }

    /// Pushes the pins and returns what the rail receives.
    #[inline(always)]
    fn act<S: Simd>(
        &self,
        w: Wide<S>,
        t: f64,
        frame: &Frame,
        pins: &mut impl PlatePins,
        yielding: f64,
        touch: &mut Touch,
    ) -> Wrench {
        let count = padded(self.links);
        if touch.wake.len() != count {
            touch.open(count);
        }
        let dt = t - self.accepted;
        let Touch { state, wake, .. } = touch;
        let mut memory = MemoryLanes::new(w, &self.memory.state, state, count);
        let mut sums = Sums::new(w);
        let mut touching = false;
        // All that may press on the guide count, whether they do or not.
        let yielding = yielding * (LANES * self.near.len()) as f64;
        // A copy: what may change while contacts are written is read from memory again for every lane.
        let frame = *frame;
        for &first in &self.near {
            for link in (first..first + LANES).step_by(Wide::<S>::COUNT) {
                let lane = link / Wide::<S>::COUNT;
                let until = self.memory.wake[link];
                // The lane rests: nothing can reach it before this time.
                if link >= self.links || until > t {
                    // What was written at the beginning of the rest is as open.
                    if wake[link] < until {
                        memory.look(lane, w.splat(FAR), w.splat(0.0));
                        memory.open(w, lane);
                    }
                    wake[link] = until;
                    continue;
                }
                let at = PlateLane {
                    lane,
                    link,
                    yielding,
                };
                let rest = self.lane(w, dt, &frame, at, pins, &mut memory, &mut sums);
                touching |= rest.is_none();
                wake[link] = rest.map_or(AWAKE, |rest| t + rest);
            }
        }
        if touching {
            sums.total(self.law.friction.acts())
        } else {
            Wrench {
                first_share: 1.0,
                ..Wrench::default()
            }
        }
    }

    /// One lane; how long \[s\] it may rest, if none of its plates touches.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn lane<S: Simd, P: PlatePins>(
        &self,
        w: Wide<S>,
        dt: f64,
        frame: &Frame,
        PlateLane {
            lane,
            link,
            yielding,
        }: PlateLane,
        pins: &mut P,
        memory: &mut MemoryLanes<'_, S>,
        sums: &mut Sums<S>,
    ) -> Option<f64> {
        let law = &self.law;
        let [one, half, far] = [1.0, 0.5, FAR].map(|number| w.splat(number));
        let height = w.splat(self.half_height);
        let valid = w.first(self.links - link);
        let [c, s] = frame.turn.map(|number| w.splat(number));
        let [ox, oy] = [frame.origin.x, frame.origin.y].map(|number| w.splat(number));
        let [rx, ry] = [self.reference.x, self.reference.y].map(|number| w.splat(number));
        // d = p − o,   p' = reference + Rᵀ d
        // The line between the pins in the coordinates of the face.
        let [[px, py], [qx, qy]] = pins.places(w, link);
        let (dx, dy, ex, ey) = (px - ox, py - oy, qx - px, qy - py);
        let a = [c * dx + s * dy + rx, c * dy - s * dx + ry];
        let along = [c * ex + s * ey, c * ey - s * ex];
        let square = ex * ex + ey * ey;
        let b = [a[0] + along[0], a[1] + along[1]];
        // Plates far from the box of the face are open, without a look at the face.
        let apart = self.outside(w, a).min(self.outside(w, b));
        let near = w.splat(REACH * self.half_height).greater(apart) & valid;
        // No part of an edge is nearer to the box than its nearer end, less half of its length.
        let clear = apart - half * square.root() - height;
        let [[vx, vy], [wx, wy]] = pins.velocities(w, link);
        if !near.any() {
            memory.look(lane, far, w.splat(0.0));
            memory.open(w, lane);
            let speeds = [[vx, vy], [wx, wy]];
            return Some(self.rest(w, dt, frame, link, clear, speeds, pins));
        }
        // Where the edge comes nearest to the face, and the normal there in the plane.
        let found = self.nearest_of(w, a, along, square);
        let gap = near.select(found.gap, far);
        let (nx, ny) = (c * found.nx - s * found.ny, s * found.nx + c * found.ny);
        // u = v − v_o − ω ẑ × d, at the touching point of the line between the pins
        let share = found.share;
        let spin = w.splat(frame.spin);
        let (dx, dy) = (dx + share * ex, dy + share * ey);
        let ux = vx + share * (wx - vx) - w.splat(frame.velocity.x) + spin * dy;
        let uy = vy + share * (wy - vy) - w.splat(frame.velocity.y) - spin * dx;
        let closing = -(nx * ux + ny * uy);
        // Between its pins a plate touches alone; at an eye two plates share the contact.
        let inside = share.greater(w.splat(0.0)) & one.greater(share);
        let weight = inside.select(one, half);
        // What the contact would do to its own closing speed by the end of the step: damping is taken there.
        let ahead = match pins.drawn(w, link) {
            Some(drawn) => {
                // All plates beside one another press alike, each on two pins: a pin bears as much as one plate.
                let [first, second] = drawn.inverse_masses;
                let [[ax, ay], [bx, by]] = drawn.by;
                let mobility = first + share * (second - first) + w.splat(yielding);
                let (ax, ay) = (ax + share * (bx - ax), ay + share * (by - ay));
                Some(PredictedLane {
                    thrust: -(nx * ax + ny * ay),
                    half_step: w.splat(drawn.half_step),
                    // 1/weight, of one and a half
                    mobility: mobility * (w.splat(3.0) - (weight + weight)),
                })
            }
            None => None,
        };
        let (weight, tally) = (Some(weight), &mut sums.tally);
        // Force of oil and metal. None of it, where no plate touches: then the lane may rest.
        let seen = law.see::<S, true>(w, memory, lane, gap, dt, None);
        let Some(pressed) =
            law.press::<S, true>(w, memory, lane, seen, closing, None, weight, ahead, tally)
        else {
            let clear = near.select(found.gap, clear);
            let speeds = [[vx, vy], [wx, wy]];
            return Some(self.rest(w, dt, frame, link, clear, speeds, pins));
        };
        let force = pressed.force;
        let (mut fx, mut fy) = (force * nx, force * ny);
        // M = −d × F
        let mut moment = dy * fx - dx * fy;
        let mut damping = SurfaceLaw::steepest(w, &pressed);
        if law.friction.acts() {
            // slip = t·u + ω h
            let slip = nx * uy - ny * ux + spin * height;
            let rubbing = law.rub::<S, true>(w, memory, lane, dt, &pressed, slip, tally);
            let rub = rubbing.force;
            fx += -(rub * ny);
            fy += rub * nx;
            // M = −(d − h n) × F
            moment = dy * fx - dx * fy + rub * height;
            let across = rubbing.steepest.max(law.friction.at_rest(w, force));
            damping += across;
            sums.across = sums.across.max(across);
        }
        // The lever rule shares the force between the pins, and the guide receives the opposite.
        let [first, second] = [one - share, share].map(|share| [share * fx, share * fy]);
        pins.push(w, link, [first, second]);
        sums.fx += -fx;
        sums.fy += -fy;
        sums.moment += moment;
        sums.damping = sums.damping.max(damping);
        None
    }

    /// Time \[s\] for which a lane may rest whose plates are clear by at least these distances \[m\].
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn rest<S: Simd, P: PlatePins>(
        &self,
        w: Wide<S>,
        dt: f64,
        frame: &Frame,
        link: usize,
        clear: Lane<S>,
        speeds: OfPins<S>,
        pins: &P,
    ) -> f64 {
        let Some(PinAccelerations { by: thrusts, .. }) = pins.drawn(w, link) else {
            return 0.0;
        };
        let valid = w.first(self.links - link);
        let zero = w.splat(0.0);
        let origin = [frame.origin.x, frame.origin.y].map(|number| w.splat(number));
        let velocity = [frame.velocity.x, frame.velocity.y].map(|number| w.splat(number));
        let spin = w.splat(frame.spin);
        let places = pins.places(w, link);
        let [mut speed, mut thrust, mut lever] = [zero; 3];
        // What an edge does is between what its ends do.
        for end in 0..2 {
            let [dx, dy] = [places[end][0] - origin[0], places[end][1] - origin[1]];
            let ux = speeds[end][0] - velocity[0] + spin * dy;
            let uy = speeds[end][1] - velocity[1] - spin * dx;
            let [ax, ay] = thrusts[end];
            speed = speed.max(ux * ux + uy * uy);
            thrust = thrust.max(ax * ax + ay * ay);
            lever = lever.max(dx * dx + dy * dy);
        }
        let rests = Clear {
            gap: valid.select(clear, w.splat(f64::MAX)),
            closing: None,
            speed: valid.select(speed, zero),
            thrust: valid.select(thrust, zero),
            lever: valid.select(lever, zero),
        };
        rests.rest(w, dt, frame.spin)
    }

    /// Distances \[m\] of places in the face's coordinates from its box, along the axis where they are longest; negative inside.
    #[inline(always)]
    fn outside<S: Simd>(&self, w: Wide<S>, [x, y]: [Lane<S>; 2]) -> Lane<S> {
        let [low, high] = &self.bounds;
        let x = (w.splat(low.x) - x).max(x - w.splat(high.x));
        let y = (w.splat(low.y) - y).max(y - w.splat(high.y));
        x.max(y)
    }

    /// Nearest points of plates, as in [`nearest`](Self::nearest): edges begin at `a`, and go `along` as far as the root of `square`.
    #[inline(always)]
    fn nearest_of<S: Simd>(
        &self,
        w: Wide<S>,
        a: [Lane<S>; 2],
        along: [Lane<S>; 2],
        square: Lane<S>,
    ) -> LanePlatePoint<S> {
        let [zero, one] = [0.0, 1.0].map(|number| w.splat(number));
        // Both ends first, then every bulging arc that the line passes: the nearest foot counts.
        let inverse_square = square.max(w.splat(f64::MIN_POSITIVE)).recip();
        let mut best = self.touched(w, a, along, zero);
        best = self.touched(w, a, along, one).or(best);
        let b = [a[0] + along[0], a[1] + along[1]];
        for index in 0..self.face.rows() {
            for feature in self.face.row(index).passed_by([a, b]) {
                if feature.sign < 0.0 || feature.straight != Vector::zeros() {
                    continue;
                }
                // s = (c − a)·e/|e|²
                let cx = w.splat(feature.centre.x) - a[0];
                let cy = w.splat(feature.centre.y) - a[1];
                let foot = (cx * along[0] + cy * along[1]) * inverse_square;
                // Beyond the ends these are nearest.
                let inside = foot.greater(zero) & one.greater(foot);
                if inside.any() {
                    let share = foot.max(zero).min(one);
                    best = self.touched(w, a, along, share).or(best);
                }
            }
        }
        best
    }

    /// Surfaces that edges face at some shares of their length.
    #[inline(always)]
    fn touched<S: Simd>(
        &self,
        w: Wide<S>,
        a: [Lane<S>; 2],
        along: [Lane<S>; 2],
        share: Lane<S>,
    ) -> LanePlatePoint<S> {
        let at = [a[0] + share * along[0], a[1] + share * along[1]];
        let nearest = self.face.nearest(w, at, self.half_height);
        LanePlatePoint {
            share,
            gap: nearest.gap,
            nx: nearest.nx,
            ny: nearest.ny,
        }
    }

    /// Sum of the elastic energies \[J\], where contacts were found as `touch` has them.
    pub(crate) fn stored(
        &self,
        pin: impl Fn(usize, usize) -> Point,
        frame: &Frame,
        touch: &Touch,
    ) -> f64 {
        let law = &self.surface.law;
        // What stands open stores nothing: the face is looked at again where plates touch, or are about to.
        let gaps = touch.state.each(MemoryField::Gap).take(self.links);
        let close = gaps.enumerate().filter(|(_, gap)| *gap < CLEAR);
        close
            .map(|(link, _)| {
                let [a, b] = [0, 1].map(|end| frame.local(pin(link, end), self.reference));
                if self.far(a) && self.far(b) {
                    return 0.0;
                }
                let point = self.nearest(a, b);
                point.weight * law.energy(-point.probe.gap)
            })
            .sum()
    }
}

/// Gap \[m\] from which on a plate is open, however it is rounded.
const CLEAR: f64 = 1e-9;

impl<S: Simd> LanePlatePoint<S> {
    /// The nearer of two; the other where both are as near.
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        let nearer = other.gap.greater(self.gap);
        Self {
            share: nearer.select(self.share, other.share),
            gap: nearer.select(self.gap, other.gap),
            nx: nearer.select(self.nx, other.nx),
            ny: nearer.select(self.ny, other.ny),
        }
    }
}
