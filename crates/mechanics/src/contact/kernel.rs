//! The inner loop: lanes of rollers against one body.

use chaindrive_integrate::kernel;
use pulp::Simd;

use super::faced_surface::{FacedSurface, GapPlaces, View};
use super::memory::FAR;
use super::predicted::PredictedLane;
use super::resting_lanes::{CLOSE, Clear};
use super::slots::Slots;
use super::wrench::{Sums, Wrench};
use super::{AWAKE, Contacts, Frame, Rollers, Shape, SurfaceLaw, Touch};
use crate::lanes::{LANES, Lane, Mask, Wide};
use crate::profile::SHARPEST;

impl Contacts {
    /// Adds the contact accelerations to `rollers`, and writes down what the body receives.
    ///
    /// Reads the memory of the last accepted state, writes the state here into `touch`. Where velocities are predicted, damping is
    /// taken at the end of the step if it is known by how much the body yields, 1/M \[1/kg\]: see [`PredictedLane`].
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the whole of a body, split for reading only"
    )]
    pub(crate) fn act<S: Simd>(
        &self,
        w: Wide<S>,
        t: f64,
        frame: &Frame,
        rollers: &mut Rollers<'_>,
        yielding: Option<f64>,
        touch: &mut Touch,
        wrench: &mut Wrench,
    ) {
        // Not one value of two calls: it would be put together in memory, and waited for.
        if self.law.is_long() {
            *wrench = w.call(long(self, t, frame, rollers, yielding, touch));
        } else {
            *wrench = self.all_lanes::<S, false>(w, t, frame, rollers, yielding, touch);
        }
    }

    /// One lane; whether any of its rollers touches.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn lane<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        frame: &Frame,
        view: View<'_>,
        slot: RollerSlot<S>,
        rollers: &mut Rollers<'_>,
        slots: &mut Slots<'_, S>,
        sums: &mut Sums<S>,
    ) -> bool {
        let i = slot.roller;
        // d = q − o,   u = v − v_o − ω ẑ × d
        let dx = w.load(rollers.x, i) - w.splat(frame.origin.x);
        let dy = w.load(rollers.y, i) - w.splat(frame.origin.y);
        let spin = w.splat(frame.spin);
        let motion = Motion {
            ux: (w.load(rollers.vx, i) - w.splat(frame.velocity.x)).plus(spin, dy),
            uy: (w.load(rollers.vy, i) - w.splat(frame.velocity.y)).minus(spin, dx),
            dx,
            dy,
            spin,
        };
        // Where the circles are in the coordinates of the face: of teeth each in the gap that it sits in, or in none, beyond the tips.
        let mut near = slot.valid;
        let place = match &self.shape {
            Shape::Teeth(teeth) => {
                let reach = teeth.tip_radius + self.largest;
                let away = (dx * dx - w.splat(reach * reach)).plus(dy, dy);
                near = w.splat(0.0).greater(away) & near;
                if !near.any() && self.writes_faces {
                    slots.leave_open(w, slot.lane, 0.0);
                    return false;
                }
                if !near.any() {
                    // |d| − R ≥ (d² − R²)/(3 R) up to |d| = 2 R
                    let gap = away * w.splat(1.0 / (3.0 * reach));
                    let clear = slot.clear(w, gap, None, &motion, rollers);
                    let rest = clear.rest(w, dt, 0.0);
                    slots.leave_open(w, slot.lane, self.accepted + dt + rest);
                    return false;
                }
                let mut turns = teeth.pitch_turns(w);
                if let Some(uneven) = &slots.uneven {
                    turns = uneven.turns(slot.axis);
                }
                GapPlaces::in_gap(w, teeth, frame, slots.axis(slot.axis), [dx, dy], turns)
            }
            Shape::Rail { reference, .. } => GapPlaces::at_rail(w, *reference, frame, [dx, dy]),
        };
        // What the circles face there, with the errors of single gaps.
        let mut faced = view.faced(w, &place, self.touching, self.law.flank.is_some());
        if let Some(uneven) = &slots.uneven {
            faced.gap = faced.gap - uneven.larger(slot.axis);
        }
        // Forces, if any circle touches; a lane that touches is looked at in the next step.
        let Some(closing) =
            self.respond::<S, LONG>(w, dt, &motion, &faced, near, slot, rollers, slots, sums)
        else {
            slots.set_wake(slot.lane, AWAKE);
            return true;
        };
        if self.writes_faces {
            slots.set_wake(slot.lane, AWAKE);
            return false;
        }
        // None touches: the lane rests as long as nothing can reach it. A circle close to its gap does not rest. Along a bulging face that
        // does not turn the gap is convex in time, and the closing speed bounds it.
        let (close, convex) = match &self.shape {
            Shape::Teeth(_) => {
                let close = w.splat(CLOSE * self.radius).greater(faced.gap) & slot.valid;
                (close.any(), false)
            }
            Shape::Rail { face, .. } => (false, face.bulges() && frame.spin == 0.0),
        };
        let rest = if close {
            0.0
        } else {
            let clear = slot.clear(w, faced.gap, convex.then_some(closing), &motion, rollers);
            clear.rest(w, dt, frame.spin)
        };
        slots.set_wake(slot.lane, self.accepted + dt + rest);
        false
    }

    /// Force, memory and sums of one lane of candidate contacts; the closing speeds if none is closed.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the inner loop, split for reading only"
    )]
    fn respond<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        motion: &Motion<S>,
        faced: &FacedSurface<S>,
        near: Mask<S>,
        slot: RollerSlot<S>,
        rollers: &mut Rollers<'_>,
        slots: &mut Slots<'_, S>,
        sums: &mut Sums<S>,
    ) -> Option<Lane<S>> {
        let RollerSlot {
            lane, axis, roller, ..
        } = slot;
        let law = &self.law;
        let gap = near.select(faced.gap, w.splat(FAR));
        // δ̇ = −n·u
        let closing = -(faced.nx * motion.ux).plus(faced.ny, motion.uy);
        // How much of the contact is on the flank.
        let share = law.share(w, faced.beyond);
        let inverse_mass = w.load(rollers.inverse_mass, roller);
        // Not a closure: one that is not inlined is compiled for the oldest processor.
        let ahead = match slot.yielding {
            Some(yielding) => {
                let (ax, ay) = (w.load(rollers.ax, roller), w.load(rollers.ay, roller));
                Some(PredictedLane {
                    thrust: -(faced.nx * ax).plus(faced.ny, ay),
                    half_step: w.splat(rollers.half_step),
                    mobility: inverse_mass + w.splat(yielding),
                })
            }
            None => None,
        };
        // Through the oil to the metal; none of it, where all are open.
        let (memory, tally) = (&mut slots.memory, &mut sums.tally);
        let seen = law.see::<S, LONG>(w, memory, lane, gap, dt, share);
        let Some(pressed) =
            law.press::<S, LONG>(w, memory, lane, seen, closing, share, None, ahead, tally)
        else {
            return Some(closing);
        };
        // The force along the normal, its moment on the body, and its damping.
        let force = pressed.force;
        let (tx, ty) = (-faced.ny, faced.nx);
        let (mut fx, mut fy) = (force * faced.nx, force * faced.ny);
        // M = −d × F
        let mut moment = (motion.dy * fx).minus(motion.dx, fy);
        let mut damping = SurfaceLaw::steepest(w, &pressed);
        if law.friction.acts() {
            // slip = t·u + ω r − ω_a r: the circle turns with its body.
            let radius = w.splat(self.radius);
            let mut slip = (motion.spin * radius)
                .plus(tx, motion.ux)
                .plus(ty, motion.uy);
            if !rollers.spin.is_empty() {
                slip = slip.minus(w.load(rollers.spin, roller), radius);
            }
            let rubbing = law.rub::<S, LONG>(w, memory, lane, dt, &pressed, slip, tally);
            let rub = rubbing.force;
            fx = fx.plus(rub, tx);
            fy = fy.plus(rub, ty);
            // M = −(d − r n) × F
            moment = (motion.dy * fx).minus(motion.dx, fy).plus(rub, radius);
            damping += rubbing.steepest;
            sums.across = sums.across.max(rubbing.steepest);
            if let Some(faces) = &mut slots.faces {
                faces.rub.set(lane, rub);
                faces.drag.set(lane, rubbing.drag);
                faces.secant.set(lane, rubbing.secant);
            }
        }
        // Circles are pushed by F, and the body receives −F: in sums over all lanes.
        let [ax, ay] = [w.load(rollers.ax, roller), w.load(rollers.ay, roller)];
        ax.plus(fx, inverse_mass).store(rollers.ax, roller);
        ay.plus(fy, inverse_mass).store(rollers.ay, roller);

        sums.fx = sums.fx - fx;
        sums.fy = sums.fy - fy;
        sums.moment += moment;
        sums.damping = sums.damping.max(damping);
        // Of a circle that touches several sides: with its forces on those before.
        let mut together = force;
        let mut other = axis;
        while other < lane {
            together += slots.memory.force(w, other);
            other += slots.lanes();
        }
        sums.greatest = sums.greatest.max(together);
        // What implicit steps and other elements of the chain ask of every contact.
        if let Some(faces) = &mut slots.faces {
            let [stiffness, damping] = law.slopes::<S, LONG>(w, &pressed, share);
            faces.stiffness.set(lane, stiffness);
            faces.damping.set(lane, damping);
            faces.normal_x.set(lane, faced.nx);
            faces.normal_y.set(lane, faced.ny);
            let sharpest = w.splat(SHARPEST);
            faces
                .bend
                .set(lane, faced.bend.min(sharpest).max(-sharpest));
        }
        None
    }
}

kernel!(
    /// One body and what touches it, as one call: long laws do not burden the kernel that others are in.
    fn long<'a, 'b, S: Simd>(
        w: Wide<S>,
        contacts: &'a Contacts,
        t: f64,
        frame: &'a Frame,
        rollers: &'a mut Rollers<'b>,
        yielding: Option<f64>,
        touch: &'a mut Touch,
    ) -> Wrench {
        contacts.all_lanes::<S, true>(w, t, frame, rollers, yielding, touch)
    }
);

impl Contacts {
    /// All lanes of rollers that can touch the body, and what it receives of them.
    #[inline(always)]
    fn all_lanes<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        t: f64,
        frame: &Frame,
        rollers: &mut Rollers<'_>,
        yielding: Option<f64>,
        touch: &mut Touch,
    ) -> Wrench {
        let dt = t - self.accepted;
        // Of one length that is seen here, places of lanes are checked once.
        let rollers = &mut rollers.of_one_length();
        touch.resize(self.slots * self.sides());
        let mut slots = Slots::new(w, self, touch);
        let mut sums = Sums::new(w);
        let mut touching = false;
        // A copy: what may change while slots are written is read from memory again for every lane.
        let eccentric = frame.eccentric;
        let frame = frame.at_centre();
        for side in 0..self.sides() {
            let view = self.view(side);
            for (eight, run) in self.runs.iter().enumerate() {
                for offset in (0..LANES).step_by(Wide::<S>::COUNT) {
                    let place = (eight * LANES + offset) / Wide::<S>::COUNT;
                    let lane = side * slots.lanes() + place;
                    let wake = slots.wake(lane);
                    if offset >= run.count || wake > t {
                        slots.leave_open(w, lane, wake);
                        continue;
                    }
                    let slot = RollerSlot {
                        lane,
                        axis: place,
                        roller: run.start + offset,
                        valid: w.first(run.count - offset),
                        yielding,
                    };
                    let (slots, sums) = (&mut slots, &mut sums);
                    touching |=
                        self.lane::<S, LONG>(w, dt, &frame, view, slot, rollers, slots, sums);
                }
            }
        }
        if touching {
            let wrench = sums.total(self.law.friction.acts());
            // About the axis: M = M_c + e × F
            let [fx, fy] = wrench.force;
            Wrench {
                moment: wrench.moment + (eccentric.x * fy - eccentric.y * fx),
                ..wrench
            }
        } else {
            Wrench {
                first_share: 1.0,
                ..Wrench::default()
            }
        }
    }
}

/// Position of a lane of slots in the arrays.
#[derive(Clone, Copy)]
struct RollerSlot<S: Simd> {
    /// Among all lanes, and among those of one side.
    lane: usize,
    axis: usize,
    roller: usize,
    valid: Mask<S>,
    /// By how much the body yields \[1/kg\], where steps look ahead.
    yielding: Option<f64>,
}

impl<S: Simd> RollerSlot<S> {
    /// Readings of open contacts from which follows how long they may rest.
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
            speed: only((motion.ux * motion.ux).plus(motion.uy, motion.uy)),
            thrust: only((ax * ax).plus(ay, ay)),
            lever: only((motion.dx * motion.dx).plus(motion.dy, motion.dy)),
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
