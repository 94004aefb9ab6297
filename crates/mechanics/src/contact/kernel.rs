//! The inner loop: lanes of rollers against one body.

use chaindrive_contact::dissipation::RATIO_LIMIT;
use chaindrive_contact::{Friction, Rub};
use pulp::Simd;

use super::answer::{Answer, LaneElastic};
use super::look::{Half, Hit, Place};
use super::rest::{CLOSE, Clear};
use super::slots::Slots;
use super::window::FAR;
use super::wrench::{Sums, Wrench};
use super::{Contacts, Frame, Shape, Touch};
use crate::chains::Rollers;
use crate::lanes::{LANES, Lane, Mask, Wide};

/// Turns normal forces into friction forces and slips into damping; kept out of line like the laws.
#[inline(never)]
fn rub_one_by_one(
    friction: &Friction,
    dt: f64,
    before: &[f64],
    force: &mut [f64],
    slip: &mut [f64],
    stick: &mut [f64],
) {
    let lanes = force.iter_mut().zip(slip).zip(before.iter().zip(stick));
    for ((force, slip), (before, stick)) in lanes {
        let rub = if *force > 0.0 {
            friction.rub(*force, *slip, *before, dt)
        } else {
            Rub::default()
        };
        (*force, *slip, *stick) = (rub.force, rub.damping, rub.state);
    }
}

/// Friction of any law: force along the tangent, and damping.
#[inline(always)]
fn rub<S: Simd>(
    w: Wide<S>,
    friction: &Friction,
    dt: f64,
    force: Lane<S>,
    slip: Lane<S>,
    (before, stick): (&[f64], &mut [f64]),
) -> [Lane<S>; 2] {
    let [mut rubs, mut drags] = [[0.0; LANES]; 2];
    force.store(&mut rubs, 0);
    slip.store(&mut drags, 0);
    rub_one_by_one(friction, dt, before, &mut rubs, &mut drags, stick);
    [w.load(&rubs, 0), w.load(&drags, 0)]
}

impl Contacts {
    /// Adds the contact accelerations to `rollers` and returns what the body receives.
    ///
    /// Reads the memory of the last accepted state, writes the state here into `touch`.
    #[inline(always)]
    pub(crate) fn act<S: Simd>(
        &self,
        w: Wide<S>,
        t: f64,
        frame: &Frame,
        rollers: &mut Rollers<'_>,
        touch: &mut Touch,
    ) -> Wrench {
        let dt = t - self.accepted;
        touch.resize(self.slots * self.sides());
        let mut slots = Slots::new(w, self, touch);
        let mut sums = Sums::new(w);
        let mut touching = false;
        // A copy: what may change while slots are written is read from memory again for every lane.
        let frame = *frame;
        for side in 0..self.sides() {
            let half = self.half(side);
            for (eight, run) in self.runs.iter().enumerate() {
                for offset in (0..LANES).step_by(Wide::<S>::COUNT) {
                    let place = (eight * LANES + offset) / Wide::<S>::COUNT;
                    let lane = side * slots.lanes() + place;
                    let wake = slots.wake(lane);
                    if offset >= run.count || wake > t {
                        slots.leave_open(w, lane, wake);
                        continue;
                    }
                    let here = Here {
                        lane,
                        axis: place,
                        roller: run.start + offset,
                        valid: w.first(run.count - offset),
                    };
                    let (slots, sums) = (&mut slots, &mut sums);
                    touching |= self.lane(
                        w,
                        dt,
                        &frame,
                        &half,
                        &self.answer,
                        here,
                        rollers,
                        slots,
                        sums,
                    );
                }
            }
        }
        if touching {
            sums.total(self.surface.friction != Friction::None)
        } else {
            Wrench {
                first_share: 1.0,
                ..Wrench::default()
            }
        }
    }

    /// One lane; whether any of its rollers touches.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn lane<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        frame: &Frame,
        half: &Half<'_>,
        answer: &Answer,
        here: Here<S>,
        rollers: &mut Rollers<'_>,
        slots: &mut Slots<'_, S>,
        sums: &mut Sums<S>,
    ) -> bool {
        let i = here.roller;
        // d = q − o,   u = v − v_o − ω ẑ × d
        let dx = w.load(rollers.x, i) - w.splat(frame.origin.x);
        let dy = w.load(rollers.y, i) - w.splat(frame.origin.y);
        let spin = w.splat(frame.spin);
        let motion = Motion {
            ux: w.load(rollers.vx, i) - w.splat(frame.velocity.x) + spin * dy,
            uy: w.load(rollers.vy, i) - w.splat(frame.velocity.y) - spin * dx,
            dx,
            dy,
            spin,
        };
        let mut near = here.valid;
        let place = match &self.shape {
            Shape::Teeth(teeth) => {
                let reach = teeth.tip_radius + self.radius;
                let away = dx * dx + dy * dy - w.splat(reach * reach);
                near = w.splat(0.0).greater(away) & near;
                if !near.any() && self.for_links {
                    slots.leave_open(w, here.lane, 0.0);
                    return false;
                }
                if !near.any() {
                    // |d| − R ≥ (d² − R²)/(3 R) up to |d| = 2 R
                    let gap = away * w.splat(1.0 / (3.0 * reach));
                    let clear = here.clear(w, gap, None, &motion, rollers);
                    let rest = clear.rest(w, dt, 0.0);
                    slots.leave_open(w, here.lane, self.accepted + dt + rest);
                    return false;
                }
                Place::in_gap(w, teeth, frame, slots.axis(here.axis), [dx, dy])
            }
            Shape::Rail { reference, .. } => Place::at_rail(w, *reference, frame, [dx, dy]),
        };
        let face = half.face(w, &place);
        let found = face.look(w, self.radius);
        // No closure: it would be compiled for the oldest processor.
        let flank = match &answer.flank {
            Some(flank) => {
                let beyond = face.beyond_hollow(w);
                Some(flank.elastic_and_share(w, beyond))
            }
            None => None,
        };
        let hit = place.world(&found);
        let Some(closing) = self.respond(
            w, dt, answer, flank, &motion, &hit, near, here, rollers, slots, sums,
        ) else {
            slots.set_wake(here.lane, 0.0);
            return true;
        };
        if self.for_links {
            slots.set_wake(here.lane, 0.0);
            return false;
        }
        let (close, convex) = match &self.shape {
            Shape::Teeth(_) => {
                let close = w.splat(CLOSE * self.radius).greater(hit.gap) & here.valid;
                (close.any(), false)
            }
            Shape::Rail { profile, .. } => (false, profile.bulges && frame.spin == 0.0),
        };
        let rest = if close {
            0.0
        } else {
            let clear = here.clear(w, hit.gap, convex.then_some(closing), &motion, rollers);
            clear.rest(w, dt, frame.spin)
        };
        slots.set_wake(here.lane, self.accepted + dt + rest);
        false
    }

    /// Force, memory and sums of one lane of candidate contacts; the closing speeds if none is closed.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn respond<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        answer: &Answer,
        flank: Option<(&LaneElastic, Lane<S>)>,
        motion: &Motion<S>,
        hit: &Hit<S>,
        near: Mask<S>,
        here: Here<S>,
        rollers: &mut Rollers<'_>,
        slots: &mut Slots<'_, S>,
        sums: &mut Sums<S>,
    ) -> Option<Lane<S>> {
        let Answer {
            elastic, numbers, ..
        } = answer;
        let Here { lane, roller, .. } = here;
        let zero = w.splat(0.0);
        let gap = near.select(hit.gap, w.splat(FAR));
        // δ̇ = −n·u
        let closing = -(hit.nx * motion.ux + hit.ny * motion.uy);
        slots.now.gap.set(lane, gap);
        slots.now.closing.set(lane, closing);
        let depth = (-gap).max(zero);
        let closed = depth.greater(zero);
        if !closed.any() {
            slots.now.inverse_onset.set(lane, zero);
            slots.now.force.set(lane, zero);
            return Some(closing);
        }
        let before = slots.before.inverse_onset.get(lane);
        let mut inverse = closed.select(before, zero);
        let fresh = closed & w.splat(f64::MIN_POSITIVE).greater(before);
        if fresh.any() {
            // v = v_a + s (v_b − v_a),   s = g_a/(g_a − g_b)
            let gap_before = slots.before.gap.get(lane).max(zero);
            let closing_before = slots.before.closing.get(lane);
            let share = gap_before * (gap_before + depth).recip();
            let onset = closing_before + share * (closing - closing_before);
            let inverse_onset = onset.max(w.splat(numbers.floor)).recip();
            inverse = fresh.select(inverse_onset, inverse);
            sums.fresh = true;
            let fresh_depth = fresh.select(depth, zero);
            sums.first_depth = sums.first_depth.max(fresh_depth);
            sums.first_share = sums.first_share.min(fresh.select(share, w.splat(1.0)));
        }
        slots.now.inverse_onset.set(lane, inverse);

        // F = max(0, g + χ g min(δ̇/v, 4) + c δ̇)
        let on_seat = elastic.force(w, depth);
        let mut stored = on_seat;
        if let Some((on_flank, share)) = flank {
            // g = (1 − s) g_seat + s g_flank
            stored = stored + share * (on_flank.force(w, depth) - stored);
            slots.now.share.set(lane, share);
        }
        let ratio = (closing * inverse).min(w.splat(RATIO_LIMIT));
        let factor = w.splat(numbers.factor);
        let viscous = w.splat(numbers.damping) * closing;
        let raw = stored * (w.splat(1.0) + factor * ratio) + viscous;
        let force = closed.select(raw.max(zero), zero);
        slots.now.force.set(lane, force);

        let (tx, ty) = (-hit.ny, hit.nx);
        let (mut fx, mut fy) = (force * hit.nx, force * hit.ny);
        // M = −d × F
        let mut moment = motion.dy * fx - motion.dx * fy;
        if numbers.friction > 0.0 {
            // slip = t·u + ω r,   f = −μ F slip/√(slip² + v_s²)
            let radius = w.splat(self.radius);
            let slip = tx * motion.ux + ty * motion.uy + motion.spin * radius;
            let reach = slip * slip + w.splat(numbers.slip_speed_squared);
            let rub = -(w.splat(numbers.friction) * force * slip * reach.inverse_root());
            fx += rub * tx;
            fy += rub * ty;
            // M = −(d − r n) × F
            moment = motion.dy * fx - motion.dx * fy + rub * radius;
            sums.friction_loss += -(rub * slip);
        }
        let mut across = w.splat(numbers.friction_slope) * force;
        if let Some(friction) = numbers.general {
            let radius = w.splat(self.radius);
            let slip = tx * motion.ux + ty * motion.uy + motion.spin * radius;
            let [rub, drag] = rub(w, &friction, dt, force, slip, slots.stick(lane));
            fx += rub * tx;
            fy += rub * ty;
            moment = motion.dy * fx - motion.dx * fy + rub * radius;
            sums.friction_loss += -(rub * slip);
            across = drag;
        }
        let inverse_mass = w.load(rollers.inverse_mass, roller);
        (w.load(rollers.ax, roller) + fx * inverse_mass).store(rollers.ax, roller);
        (w.load(rollers.ay, roller) + fy * inverse_mass).store(rollers.ay, roller);

        sums.fx += -fx;
        sums.fy += -fy;
        sums.moment += moment;
        sums.normal_loss += (force - closed.select(stored, zero)) * closing;
        sums.depth = sums.depth.max(depth);
        // −∂F/∂ġ = χ g/v + c, and μ F/v_s across
        let normal = factor * stored * inverse + closed.select(w.splat(numbers.damping), zero);
        sums.damping = sums.damping.max(normal + across);
        if let Some(faces) = &mut slots.faces {
            // ∂F/∂δ = k (1 + χ min(δ̇/v, 4)); both derivatives are zero where a limit holds the force.
            let mut slope = elastic.slope(w, depth, on_seat);
            if let Some((on_flank, share)) = flank {
                let other = on_flank.slope(w, depth, on_flank.force(w, depth));
                slope = slope + share * (other - slope);
            }
            let pressed = force.greater(zero);
            let free = w.splat(RATIO_LIMIT).greater(closing * inverse);
            let damping = free.select(factor * stored * inverse, zero) + w.splat(numbers.damping);
            let stiffness = slope * (w.splat(1.0) + factor * ratio);
            faces.stiffness.set(lane, pressed.select(stiffness, zero));
            faces.damping.set(lane, pressed.select(damping, zero));
            faces.normal_x.set(lane, hit.nx);
            faces.normal_y.set(lane, hit.ny);
            faces.bend.set(lane, hit.bend);
        }
        None
    }
}

/// Where a lane of slots stands.
#[derive(Clone, Copy)]
struct Here<S: Simd> {
    /// Among all lanes, and among those of one side.
    lane: usize,
    axis: usize,
    roller: usize,
    valid: Mask<S>,
}

impl<S: Simd> Here<S> {
    /// What open contacts with these gaps want to know before they rest.
    #[inline(always)]
    fn clear(
        self,
        w: Wide<S>,
        gap: Lane<S>,
        closing: Option<Lane<S>>,
        motion: &Motion<S>,
        rollers: &Rollers<'_>,
    ) -> Clear<S> {
        let zero = w.splat(0.0);
        let (ax, ay) = (
            w.load(rollers.ax, self.roller),
            w.load(rollers.ay, self.roller),
        );
        let only = |lane: Lane<S>| self.valid.select(lane, zero);
        Clear {
            gap: self.valid.select(gap, w.splat(f64::MAX)),
            closing: closing.map(only),
            speed: only(motion.ux * motion.ux + motion.uy * motion.uy),
            thrust: only(ax * ax + ay * ay),
            lever: only(motion.dx * motion.dx + motion.dy * motion.dy),
        }
    }
}

/// Velocity relative to the body at the roller centres, and the lever arms.
struct Motion<S: Simd> {
    ux: Lane<S>,
    uy: Lane<S>,
    dx: Lane<S>,
    dy: Lane<S>,
    spin: Lane<S>,
}
