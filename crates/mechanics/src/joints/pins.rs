//! All pins of the chain in their bushes at once, on lanes.
//!
//! ```text
//! e = P_after − P_before,  n = e/|e|,   δ = |e| − c,   δ̇ = n·(v_after − v_before)
//! on the side after:  −F n + R t,   t = ẑ × n
//! ```
//!
//! Which side is the pin and which the bush matters for friction alone, whose levers differ.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, kernel};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{Element, JointMates, Mate, Partner, Sides};
use crate::contact::{BoreContact, ContactMemory, LaneTally, MemoryLanes, RelativeMotion, Tally};
use crate::lanes::{LANES, Lane, Mask, Wide, padded};

/// Forces of the joints, whole lanes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Pins {
    /// Gap \[m\] and normal force \[N\]. The memory has them too, but changes hands when a step is accepted.
    pub(crate) gap: Array,
    pub(crate) force: Array,
    /// n, from the centre of the side before to that of the side after.
    pub(crate) normal_x: Array,
    pub(crate) normal_y: Array,
    /// arm × n of both sides \[m\].
    pub(crate) turn_before: Array,
    pub(crate) turn_after: Array,
    /// ∂F/∂δ \[N/m\].
    pub(crate) stiffness: Array,
    /// ∂F/∂δ̇ \[N s/m\].
    pub(crate) damping: Array,
    /// Stiffness across, F/|e| \[N/m\].
    pub(crate) across: Array,
    /// Force on the side after \[N\]; the side before feels the opposite.
    pub(crate) push_x: Array,
    pub(crate) push_y: Array,
    /// Moments on both links about their centres of mass \[N m\].
    pub(crate) moment_before: Array,
    pub(crate) moment_after: Array,
    /// Friction of the pin along ẑ × (P_pin − P_hole) \[N\], −∂R/∂slip and the secant |R/slip| \[N s/m\].
    pub(crate) rub: Array,
    pub(crate) drag: Array,
    pub(crate) secant: Array,
    /// δ̇ \[m/s\], and what of F is not elastic \[N\].
    pub(crate) closing: Array,
    pub(crate) resisting: Array,
}

/// Which joints there are, and how they are put together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pairs {
    /// Number of joints.
    count: usize,
    /// One where there is a pin in a bush, zero elsewhere, whole lanes.
    present: Array,
    /// The same of the next joint, which after the last one is the first.
    present_next: Array,
    /// One where the side after has the pin, zero elsewhere, whole lanes; the number after the last joint stands for the first again.
    pin_after: Array,
    /// Bodies among the two sides, likewise.
    shares: Array,
    /// One where the side after has what carries the roller, zero elsewhere, whole lanes.
    pub(crate) bush_after: Array,
}

impl Pairs {
    pub(crate) fn of(joints: &[JointMates]) -> Self {
        let flags = |flag: &dyn Fn(&JointMates) -> bool| {
            let mut flags: Array = joints
                .iter()
                .map(|joint| f64::from(u8::from(flag(joint))))
                .collect();
            flags.resize(padded(joints.len()), 0.0);
            flags
        };
        let present = flags(&|joint| joint.pair.is_some());
        let mut present_next = present.clone();
        present_next[..joints.len()].rotate_left(1);
        let again = |mut all: Array| {
            all.resize(padded(joints.len()) + LANES, 0.0);
            all[joints.len()] = all[0];
            all
        };
        let bodies = |joint: &JointMates| {
            let mates = joint.pair.into_iter().flatten();
            mates
                .filter(|mate| matches!(mate, Mate::Link { .. }))
                .count() as f64
        };
        Self {
            count: joints.len(),
            shares: again(joints.iter().map(bodies).collect()),
            present,
            present_next,
            pin_after: again(flags(&|joint| {
                joint.pair.is_some_and(|[_, pin]| pin.is_after())
            })),
            bush_after: flags(&|joint| joint.carrier.is_after()),
        }
    }

    /// Where there are two sides, of the joints from one on.
    #[inline(always)]
    pub(crate) fn present<S: Simd>(&self, w: Wide<S>, joint: usize) -> Mask<S> {
        w.load(&self.present, joint).greater(w.splat(0.0))
    }

    /// Where there are two sides in a joint and in the next, of the joints from one on.
    #[inline(always)]
    pub(crate) fn both_present<S: Simd>(&self, w: Wide<S>, joint: usize) -> Mask<S> {
        let next = w.load(&self.present_next, joint).greater(w.splat(0.0));
        self.present(w, joint) & next
    }

    /// Where the side after has the pin, of the joints from one on.
    #[inline(always)]
    pub(crate) fn pins_after<S: Simd>(&self, w: Wide<S>, joint: usize) -> Mask<S> {
        w.load(&self.pin_after, joint).greater(w.splat(0.0))
    }

    /// How many bodies the two sides are, of the joints from one on.
    #[inline(always)]
    pub(crate) fn shares<S: Simd>(&self, w: Wide<S>, joint: usize) -> Lane<S> {
        w.load(&self.shares, joint)
    }

    /// Whether the side after a joint has the pin.
    pub(crate) fn pin_after(&self, joint: usize) -> bool {
        self.pin_after[joint] > 0.0
    }
}

impl Pins {
    fn all(&mut self) -> [&mut Array; 18] {
        [
            &mut self.gap,
            &mut self.force,
            &mut self.normal_x,
            &mut self.normal_y,
            &mut self.turn_before,
            &mut self.turn_after,
            &mut self.stiffness,
            &mut self.damping,
            &mut self.across,
            &mut self.push_x,
            &mut self.push_y,
            &mut self.moment_before,
            &mut self.moment_after,
            &mut self.rub,
            &mut self.drag,
            &mut self.secant,
            &mut self.closing,
            &mut self.resisting,
        ]
    }

    fn resize(&mut self, joints: usize) {
        if self.normal_x.len() == padded(joints) + LANES {
            return;
        }
        for values in self.all() {
            // The number after the last stands for the first joint of a closed chain again.
            values.resize(padded(joints) + LANES, 0.0);
        }
    }

    /// Repeats the first joint of a closed chain after the last.
    pub(crate) fn close(&mut self, joints: usize) {
        for values in self.all() {
            values[joints] = values[0];
        }
    }

    /// Force on the side after a joint \[N\].
    pub(crate) fn push(&self, joint: usize) -> Vector {
        Vector::new(self.push_x[joint], self.push_y[joint])
    }

    /// n of a joint.
    pub(crate) fn normal(&self, joint: usize) -> Vector {
        Vector::new(self.normal_x[joint], self.normal_y[joint])
    }

    /// The contact in a joint as others have it.
    pub(crate) fn element(
        &self,
        joint: usize,
        mates: &JointMates,
        bearing: &BoreContact,
        [before, after]: [&Sides; 2],
    ) -> Option<Element> {
        let [hole, pin] = mates.pair?;
        if self.gap[joint] >= 0.0 {
            return None;
        }
        let side = |mate| match mate {
            Mate::Link { link, end: 0 } => (Some(link), after.arm(joint)),
            Mate::Link { link, .. } => (Some(link), before.arm(joint)),
            Mate::Ground(_) => (None, Vector::zeros()),
        };
        let ((a, arm_a), (b, arm_b)) = (side(pin), side(hole));
        let normal = self.normal(joint);
        let [lever_pin, lever_hole] = bearing.levers(-self.gap[joint]);
        Some(Element {
            joint,
            a,
            b: b.map_or(Partner::Ground, Partner::Body),
            arm_a,
            arm_b,
            pivot_b: arm_b,
            lever_a: lever_pin,
            lever_b: lever_hole,
            normal: if pin.is_after() { normal } else { -normal },
            force: self.force[joint],
            rub: self.rub[joint],
            stiffness: self.stiffness[joint],
            damping: self.damping[joint],
            drag: self.drag[joint],
            secant: self.secant[joint],
            across: self.across[joint],
            closing: self.closing[joint],
        })
    }
}

kernel!(
    /// The contact of all joints: the power lost, and how contacts began.
    pub(crate) fn contacts<'a, S: Simd>(
        w: Wide<S>,
        /// Sides before and after the joints.
        sides: [&'a Sides; 2],
        pairs: &'a Pairs,
        bearing: &'a BoreContact,
        /// Memory of the accepted state, and of this one.
        known: &'a ContactMemory,
        memory: &'a mut ContactMemory,
        pins: &'a mut Pins,
        /// Time since the accepted state \[s\].
        dt: f64,
    ) -> Tally {
        let joints = pairs.count;
        memory.resize(padded(joints));
        pins.resize(joints);
        let [before, after] = sides;
        let mut memory = MemoryLanes::new(w, known, memory, padded(joints));
        let mut tally = LaneTally::new(w);
        let rubs = bearing.rubs();
        for (lane, start) in (0..joints).step_by(Wide::<S>::COUNT).enumerate() {
            // How the pin and the bush of every joint stand and move to each other.
            let apart = RelativeMotion {
                offset: [
                    w.load(&after.x, start) - w.load(&before.x, start),
                    w.load(&after.y, start) - w.load(&before.y, start),
                ],
                rate: [
                    w.load(&after.vx, start) - w.load(&before.vx, start),
                    w.load(&after.vy, start) - w.load(&before.vy, start),
                ],
                spin: [w.load(&before.spin, start), w.load(&after.spin, start)],
                present: pairs.present(w, start),
                pin_after: pairs.pins_after(w, start),
            };
            let grip = bearing.grip(w, &mut memory, lane, &apart, dt, &mut tally);
            // Arms of the force on both links about their centres of mass.
            let [nx, ny] = grip.normal;
            let [bx, by] = [w.load(&before.arm_x, start), w.load(&before.arm_y, start)];
            let [ax, ay] = [w.load(&after.arm_x, start), w.load(&after.arm_y, start)];
            let turn_before = bx * ny - by * nx;
            let turn_after = ax * ny - ay * nx;
            let force = grip.force;
            // What the side after feels; the side before feels the opposite.
            let mut push = [-(force * nx), -(force * ny)];
            let mut moment_before = force * turn_before;
            let mut moment_after = -(force * turn_after);
            if rubs {
                // Action on the side after: R t, with its lever; the side before feels the opposite.
                let rub = grip.rub;
                let [tx, ty] = [-ny, nx];
                push = [push[0] + rub * tx, push[1] + rub * ty];
                let [lever_before, lever_after] = grip.levers;
                moment_before = moment_before - rub * (bx * ty - by * tx + lever_before);
                moment_after += rub * (ax * ty - ay * tx + lever_after);
                rub.store(&mut pins.rub, start);
                grip.drag.store(&mut pins.drag, start);
                grip.secant.store(&mut pins.secant, start);
            }
            // All of it is kept: links are pushed, steps are chosen and implicit steps are made of it.
            grip.gap.store(&mut pins.gap, start);
            force.store(&mut pins.force, start);
            nx.store(&mut pins.normal_x, start);
            ny.store(&mut pins.normal_y, start);
            turn_before.store(&mut pins.turn_before, start);
            turn_after.store(&mut pins.turn_after, start);
            grip.stiffness.store(&mut pins.stiffness, start);
            grip.damping.store(&mut pins.damping, start);
            grip.across.store(&mut pins.across, start);
            grip.closing.store(&mut pins.closing, start);
            grip.resisting.store(&mut pins.resisting, start);
            push[0].store(&mut pins.push_x, start);
            push[1].store(&mut pins.push_y, start);
            moment_before.store(&mut pins.moment_before, start);
            moment_after.store(&mut pins.moment_after, start);
        }
        Tally::of(&tally)
    }
);
