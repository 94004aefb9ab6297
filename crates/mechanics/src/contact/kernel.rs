//! The inner loop: eight rollers against one profile.

use chaindrive_contact::dissipation::RATIO_LIMIT;
use chaindrive_contact::{Friction, Rub};
use pulp::Simd;

use super::answer::{Answer, LaneElastic};
use super::rest::{CLOSE, Clear};
use super::wrench::{Sums, Wrench};
use super::{Contacts, Frame, Shape, Teeth, Touch};
use crate::lanes::{LANES, Lane, Mask, Wide, padded};
use crate::profile::Profile;
use crate::system::Rollers;

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
        let mut sums = Sums::new(w);
        let mut touching = false;
        let mut base = 0;
        for run in &self.runs {
            for offset in (0..padded(run.count)).step_by(Wide::<S>::COUNT) {
                let slot = base + offset;
                if offset >= run.count || self.memory.wake[slot] > t {
                    self.leave_open(w, slot, self.memory.wake[slot], touch);
                    continue;
                }
                let here = Here {
                    slot,
                    roller: run.start + offset,
                    valid: w.first(run.count - offset),
                };
                touching |= self.lane(w, dt, frame, here, rollers, touch, &mut sums);
            }
            base += padded(run.count);
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
        here: Here<S>,
        rollers: &mut Rollers<'_>,
        touch: &mut Touch,
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
        let (place, near) = match &self.shape {
            Shape::Teeth(teeth) => {
                let reach = teeth.tip_radius + self.radius;
                let away = dx * dx + dy * dy - w.splat(reach * reach);
                let near = w.splat(0.0).greater(away) & here.valid;
                if !near.any() {
                    // |d| − R ≥ (d² − R²)/(3 R) up to |d| = 2 R
                    let gap = away * w.splat(1.0 / (3.0 * reach));
                    let clear = here.clear(w, gap, None, &motion, rollers);
                    let rest = clear.rest(w, dt, 0.0);
                    self.leave_open(w, here.slot, self.accepted + dt + rest, touch);
                    return false;
                }
                (self.fold(w, teeth, frame, here.slot, dx, dy), near)
            }
            Shape::Rail { reference, .. } => {
                // q' = reference + Rᵀ d; the frame's y axis is (−s, c)
                let (c, s) = (w.splat(frame.turn[0]), w.splat(frame.turn[1]));
                let place = Place {
                    x: c * dx + s * dy + w.splat(reference.x),
                    y: c * dy - s * dx + w.splat(reference.y),
                    ax: -s,
                    ay: c,
                };
                (place, here.valid)
            }
        };
        let mut touching = false;
        let mut open = w.splat(f64::MAX);
        let mut approach = None;
        for side in 0..self.sides() {
            let face = self.face(w, side, &place);
            let mut found = look(w, face.profile, face.sign * place.x, place.y, self.radius);
            let flank = self.answer.flank.map(|flank| {
                let beyond = beyond_hollow(w, face.profile, face.sign * place.x, place.y);
                flank.elastic_and_share(w, beyond)
            });
            if face.seat_across {
                // A seat across the axis belongs to the right half alone.
                let wrong = w.splat(0.0).greater(face.sign * place.x) & found.in_first;
                found.gap = wrong.select(w.splat(1.0), found.gap);
            }
            found.nx = face.sign * found.nx;
            let hit = place.world(&found, near);
            let slot = side * self.slots + here.slot;
            let closing = self.respond(w, dt, flank, &motion, &hit, slot, i, rollers, touch, sums);
            touching |= closing.is_none();
            open = open.min(hit.gap);
            approach = closing;
        }
        touch.wake[here.slot] = 0.0;
        if touching {
            return true;
        }
        let (close, convex) = match &self.shape {
            Shape::Teeth(_) => {
                let close = w.splat(CLOSE * self.radius).greater(open) & here.valid;
                (close.any(), false)
            }
            Shape::Rail { profile, .. } => (false, profile.bulges && frame.spin == 0.0),
        };
        if !close {
            let approach = approach.filter(|_| convex);
            let clear = here.clear(w, open, approach, &motion, rollers);
            touch.wake[here.slot] = self.accepted + dt + clear.rest(w, dt, frame.spin);
        }
        false
    }

    /// What a side of the slots looks at: the whole rail, the half of a symmetric gap on the
    /// roller's side, or one half of a gap that must be looked at twice.
    #[inline(always)]
    fn face<S: Simd>(&self, w: Wide<S>, side: usize, place: &Place<S>) -> Face<'_, S> {
        let (one, zero) = (w.splat(1.0), w.splat(0.0));
        match &self.shape {
            Shape::Rail { profile, .. } => Face {
                profile,
                sign: one,
                seat_across: false,
            },
            Shape::Teeth(teeth) if teeth.halves.two_sided => {
                let profile = [&teeth.halves.right, &teeth.halves.left][side];
                Face {
                    profile,
                    sign: if side == 0 { one } else { -one },
                    seat_across: profile.features[0].sign < 0.0,
                }
            }
            Shape::Teeth(teeth) => Face {
                profile: &teeth.halves.right,
                sign: place.x.greater(zero).select(one, -one),
                seat_across: false,
            },
        }
    }

    /// The rollers in the frames of the gaps they are nearest to.
    #[inline(always)]
    fn fold<S: Simd>(
        &self,
        w: Wide<S>,
        teeth: &Teeth,
        frame: &Frame,
        slot: usize,
        dx: Lane<S>,
        dy: Lane<S>,
    ) -> Place<S> {
        let (c, s) = (w.splat(frame.turn[0]), w.splat(frame.turn[1]));
        let ex = w.load(&self.axis_x, slot);
        let ey = w.load(&self.axis_y, slot);
        // a = R(θ) e,   x = d × a,   y = d · a
        let ax = c * ex - s * ey;
        let ay = s * ex + c * ey;
        let x = dx * ay - dy * ax;
        let y = dx * ax + dy * ay;
        // Beyond the middle of a tooth the next gap is meant: turn the axis by one pitch.
        let beyond = x.abs().greater(y * w.splat(teeth.tan_half));
        let (one, zero) = (w.splat(1.0), w.splat(0.0));
        let sign = x.greater(zero).select(one, -one);
        let cp = beyond.select(w.splat(teeth.pitch_turn[0]), one);
        let sp = beyond.select(sign * w.splat(teeth.pitch_turn[1]), zero);
        let ax2 = cp * ax + sp * ay;
        let ay2 = cp * ay - sp * ax;
        Place {
            x: dx * ay2 - dy * ax2,
            y: dx * ax2 + dy * ay2,
            ax: ax2,
            ay: ay2,
        }
    }

    /// Friction of any law: force along the tangent, and damping.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn rub<S: Simd>(
        &self,
        w: Wide<S>,
        friction: &Friction,
        dt: f64,
        force: Lane<S>,
        slip: Lane<S>,
        slot: usize,
        touch: &mut Touch,
    ) -> (Lane<S>, Lane<S>) {
        let slots = slot..slot + Wide::<S>::COUNT;
        let [mut rubs, mut drags] = [[0.0; LANES]; 2];
        force.store(&mut rubs, 0);
        slip.store(&mut drags, 0);
        let before = &self.memory.stick[slots.clone()];
        rub_one_by_one(
            friction,
            dt,
            before,
            &mut rubs,
            &mut drags,
            &mut touch.stick[slots],
        );
        (w.load(&rubs, 0), w.load(&drags, 0))
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
        flank: Option<(LaneElastic, Lane<S>)>,
        motion: &Motion<S>,
        hit: &Hit<S>,
        slot: usize,
        roller: usize,
        rollers: &mut Rollers<'_>,
        touch: &mut Touch,
        sums: &mut Sums<S>,
    ) -> Option<Lane<S>> {
        let Answer {
            elastic, numbers, ..
        } = &self.answer;
        let zero = w.splat(0.0);
        let gap = hit.near.select(hit.gap, w.splat(1.0));
        // δ̇ = −n·u
        let closing = -(hit.nx * motion.ux + hit.ny * motion.uy);
        gap.store(&mut touch.gap, slot);
        closing.store(&mut touch.closing, slot);
        let depth = (-gap).max(zero);
        let closed = depth.greater(zero);
        if !closed.any() {
            zero.store(&mut touch.inverse_onset, slot);
            zero.store(&mut touch.force, slot);
            return Some(closing);
        }
        let before = w.load(&self.memory.inverse_onset, slot);
        let mut inverse = closed.select(before, zero);
        let fresh = closed & w.splat(f64::MIN_POSITIVE).greater(before);
        if fresh.any() {
            // v = v_a + s (v_b − v_a),   s = g_a/(g_a − g_b)
            let gap_before = w.load(&self.memory.gap, slot).max(zero);
            let closing_before = w.load(&self.memory.closing, slot);
            let share = gap_before * (gap_before + depth).recip();
            let onset = closing_before + share * (closing - closing_before);
            let inverse_onset = onset.max(w.splat(numbers.floor)).recip();
            inverse = fresh.select(inverse_onset, inverse);
            sums.fresh = true;
            let fresh_depth = fresh.select(depth, zero);
            sums.first_depth = sums.first_depth.max(fresh_depth);
            sums.first_share = sums.first_share.min(fresh.select(share, w.splat(1.0)));
        }
        inverse.store(&mut touch.inverse_onset, slot);

        // F = max(0, g + χ g min(δ̇/v, 4) + c δ̇)
        let mut stored = elastic.force(w, depth);
        if let Some((on_flank, share)) = flank {
            // g = (1 − s) g_seat + s g_flank
            stored = stored + share * (on_flank.force(w, depth) - stored);
            share.store(&mut touch.share, slot);
        }
        let ratio = (closing * inverse).min(w.splat(RATIO_LIMIT));
        let damping = w.splat(numbers.factor) * stored;
        let viscous = w.splat(numbers.damping) * closing;
        let raw = stored + damping * ratio + viscous;
        let force = closed.select(raw.max(zero), zero);
        force.store(&mut touch.force, slot);

        let (tx, ty) = (-hit.ny, hit.nx);
        let (mut fx, mut fy) = (force * hit.nx, force * hit.ny);
        // M = −d × F
        let mut moment = motion.dy * fx - motion.dx * fy;
        if numbers.friction > 0.0 {
            // slip = t·u + ω r,   f = −μ F slip/√(slip² + v_s²)
            let radius = w.splat(self.radius);
            let slip = tx * motion.ux + ty * motion.uy + motion.spin * radius;
            let reach = (slip * slip + w.splat(numbers.slip_speed_squared)).sqrt();
            let rub = -(w.splat(numbers.friction) * force * slip * reach.recip());
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
            let (rub, drag) = self.rub(w, &friction, dt, force, slip, slot, touch);
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
        let normal = damping * inverse + closed.select(w.splat(numbers.damping), zero);
        sums.damping = sums.damping.max(normal + across);
        None
    }
}

/// The surface that each lane faces, in the frame of the profile.
#[inline(always)]
fn look<S: Simd>(w: Wide<S>, profile: &Profile, x: Lane<S>, y: Lane<S>, radius: f64) -> Found<S> {
    let zero = w.splat(0.0);
    let first = &profile.features[0];
    let mut cx = w.splat(first.centre.x);
    let mut cy = w.splat(first.centre.y);
    let mut r = w.splat(first.radius);
    let mut sign = w.splat(first.sign);
    let mut mx = w.splat(first.straight.x);
    let mut my = w.splat(first.straight.y);
    let mut passed = w.first(Wide::<S>::COUNT);
    let mut in_first = w.first(Wide::<S>::COUNT);
    for (index, f) in profile.features.iter().enumerate().skip(1) {
        let ahead = (x - w.splat(f.start.x)) * w.splat(f.along.x)
            + (y - w.splat(f.start.y)) * w.splat(f.along.y);
        if index == 1 {
            in_first = zero.greater(ahead);
        }
        passed = passed & ahead.greater(zero);
        cx = passed.select(w.splat(f.centre.x), cx);
        cy = passed.select(w.splat(f.centre.y), cy);
        r = passed.select(w.splat(f.radius), r);
        sign = passed.select(w.splat(f.sign), sign);
        if profile.has_straights {
            mx = passed.select(w.splat(f.straight.x), mx);
            my = passed.select(w.splat(f.straight.y), my);
        }
    }
    let (ex, ey) = (x - cx, y - cy);
    let [distance, inverse] = (ex * ex + ey * ey).roots();
    let scale = sign * inverse;
    let contact_radius = w.splat(radius);
    let mut found = Found {
        // g = ±(|q − c| − R) − r
        gap: sign * (distance - r) - contact_radius,
        nx: scale * ex,
        ny: scale * ey,
        in_first,
    };
    if profile.has_straights {
        // g = n·(q − p) − r
        let straight = (mx * mx + my * my).greater(zero);
        let gap = mx * ex + my * ey - contact_radius;
        found.gap = straight.select(gap, found.gap);
        found.nx = straight.select(mx, found.nx);
        found.ny = straight.select(my, found.ny);
    }
    found
}

/// How far beyond the hollow the rollers are; infinite where there is none.
#[inline(always)]
fn beyond_hollow<S: Simd>(w: Wide<S>, profile: &Profile, x: Lane<S>, y: Lane<S>) -> Lane<S> {
    match profile.flank {
        Some(index) => {
            let f = &profile.features[index];
            (x - w.splat(f.start.x)) * w.splat(f.along.x)
                + (y - w.splat(f.start.y)) * w.splat(f.along.y)
        }
        None => w.splat(f64::MAX),
    }
}

/// The profile that a lane looks at.
struct Face<'a, S: Simd> {
    profile: &'a Profile,
    /// Mirrors x so that the profile's half is at x ≥ 0.
    sign: Lane<S>,
    seat_across: bool,
}

/// Where a lane of slots stands.
#[derive(Clone, Copy)]
struct Here<S: Simd> {
    slot: usize,
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

/// Roller centres in gap frames, and the gap axes in the world.
struct Place<S: Simd> {
    x: Lane<S>,
    y: Lane<S>,
    ax: Lane<S>,
    ay: Lane<S>,
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn world(&self, found: &Found<S>, near: Mask<S>) -> Hit<S> {
        // The gap's x axis is its y axis turned by −90°.
        Hit {
            gap: found.gap,
            nx: found.nx * self.ay + found.ny * self.ax,
            ny: found.ny * self.ay - found.nx * self.ax,
            near,
        }
    }
}

struct Found<S: Simd> {
    gap: Lane<S>,
    nx: Lane<S>,
    ny: Lane<S>,
    in_first: Mask<S>,
}

struct Hit<S: Simd> {
    gap: Lane<S>,
    nx: Lane<S>,
    ny: Lane<S>,
    near: Mask<S>,
}
