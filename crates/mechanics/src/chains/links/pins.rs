//! All pins of the chain in their bushes at once, on lanes.
//!
//! ```text
//! e = P_after − P_before,  n = e/|e|,   δ = |e| − c,   δ̇ = n·(v_after − v_before)
//! on the side after:  −F n + R t,   t = ẑ × n
//! ```
//!
//! Which side is the pin and which the bush matters for friction alone, whose levers differ.

use chaindrive_contact::dissipation::{Action, RATIO_LIMIT};
use chaindrive_contact::{Approach, Friction, Prepared, interpolated_onset};
use chaindrive_geometry::Vector;
use pulp::{Simd, WithSimd};

use super::bearing::{CENTRED, PinTouch};
use super::element::{secant, turned};
use super::{Bearing, Element, JointMates, Linkage, Mate, Partner, Posture, Tally};
use crate::lanes::{FixedPower, LANES, Lane, Wide, padded};

/// State of the joints at an accepted moment, whole lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct PinMemory {
    /// Gap −δ \[m\], negative in contact.
    pub(crate) gap: Vec<f64>,
    /// Closing speed δ̇ \[m/s\].
    pub(crate) closing: Vec<f64>,
    /// Inverse of the closing speed at touch \[s/m\]; zero while open.
    pub(crate) inverse_onset: Vec<f64>,
    /// Normal force \[N\].
    pub(crate) force: Vec<f64>,
    /// State of the friction law.
    pub(crate) stick: Vec<f64>,
}

/// What the joints exert, whole lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pins {
    /// Gap \[m\] and normal force \[N\]. The memory has them too, but changes hands when a step is accepted.
    pub(crate) gap: Vec<f64>,
    pub(crate) force: Vec<f64>,
    /// n, from the centre of the side before to that of the side after.
    pub(crate) normal_x: Vec<f64>,
    pub(crate) normal_y: Vec<f64>,
    /// arm × n of both sides \[m\].
    pub(crate) turn_before: Vec<f64>,
    pub(crate) turn_after: Vec<f64>,
    /// ∂F/∂δ \[N/m\].
    pub(crate) stiffness: Vec<f64>,
    /// ∂F/∂δ̇ \[N s/m\].
    pub(crate) damping: Vec<f64>,
    /// Stiffness across, F/|e| \[N/m\].
    pub(crate) across: Vec<f64>,
    /// Force on the side after \[N\]; the side before feels the opposite.
    pub(crate) push_x: Vec<f64>,
    pub(crate) push_y: Vec<f64>,
    /// Moments on both links about their centres of mass \[N m\].
    pub(crate) moment_before: Vec<f64>,
    pub(crate) moment_after: Vec<f64>,
    /// Friction by joint, where there is any.
    pub(crate) rubs: Vec<Rubbing>,
}

/// Friction in one joint, of the pin along ẑ × (P_pin − P_hole).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rubbing {
    /// Force R \[N\].
    pub(crate) force: f64,
    /// −∂R/∂slip, and the secant |R/slip| \[N s/m\].
    pub(crate) drag: f64,
    pub(crate) secant: f64,
}

/// Which joints there are, and how they are put together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pairs {
    /// One where there is a pin in a bush, zero elsewhere, whole lanes.
    present: Vec<f64>,
    /// Whether the side after has the pin.
    pub(crate) pin_after: Vec<bool>,
    /// One where the side after has what carries the roller, zero elsewhere, whole lanes.
    pub(crate) bush_after: Vec<f64>,
}

impl Pairs {
    pub(crate) fn of(joints: &[JointMates]) -> Self {
        let flags = |flag: &dyn Fn(&JointMates) -> bool| {
            let mut flags: Vec<f64> = joints
                .iter()
                .map(|joint| f64::from(u8::from(flag(joint))))
                .collect();
            flags.resize(padded(joints.len()), 0.0);
            flags
        };
        let after = |mate| matches!(mate, Mate::Link { end: 0, .. } | Mate::Ground(1));
        Self {
            present: flags(&|joint| joint.pair.is_some()),
            pin_after: joints
                .iter()
                .map(|joint| joint.pair.is_some_and(|[_, pin]| after(pin)))
                .collect(),
            bush_after: flags(&|joint| after(joint.carrier)),
        }
    }
}

/// A law of joints as lanes want it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PinLaw {
    law: Prepared,
    /// K, n and x ↦ x^(n − 1) of a power law.
    power: Option<(f64, f64, FixedPower)>,
    /// χ of a hysteretic law, and damping of a viscous one \[N s/m\].
    factor: f64,
    damping: f64,
}

impl PinLaw {
    pub(crate) fn new(law: Prepared) -> Self {
        let (factor, damping) = match law.action() {
            Action::None => (0.0, 0.0),
            Action::Hysteretic { factor } => (factor, 0.0),
            Action::Viscous { damping } => (0.0, damping),
        };
        Self {
            law,
            power: law
                .power()
                .map(|[stiffness, n]| (stiffness, n, FixedPower::new(n - 1.0))),
            factor,
            damping,
        }
    }

    /// Elastic force and stiffness at depths that are positive.
    #[inline(always)]
    fn elastic<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> [Lane<S>; 2] {
        if let Some((stiffness, exponent, lower)) = &self.power {
            // g = K δ δⁿ⁻¹,   k = n K δⁿ⁻¹
            let secant = w.splat(*stiffness) * lower.of(w, depth);
            [secant * depth, w.splat(*exponent) * secant]
        } else {
            let at = |depth| {
                self.law.respond(Approach {
                    penetration: depth,
                    rate: 0.0,
                    onset_rate: 1.0,
                })
            };
            [
                depth.one_by_one(|depth| at(depth).elastic),
                depth.one_by_one(|depth| at(depth).stiffness),
            ]
        }
    }
}

impl PinMemory {
    /// Open joints.
    pub(crate) fn open(joints: usize) -> Self {
        let mut memory = Self::default();
        memory.resize(joints);
        memory.gap.fill(PinTouch::OPEN.gap);
        memory
    }

    fn resize(&mut self, joints: usize) {
        if self.gap.len() == padded(joints) {
            return;
        }
        for values in [
            &mut self.gap,
            &mut self.closing,
            &mut self.inverse_onset,
            &mut self.force,
            &mut self.stick,
        ] {
            values.resize(padded(joints), 0.0);
        }
    }

    /// Speed at touch \[m/s\] and force \[N\] of a closed joint.
    pub(crate) fn closed(&self, joint: usize) -> Option<(f64, f64)> {
        let inverse = self.inverse_onset[joint];
        (inverse > 0.0).then(|| (1.0 / inverse, self.force[joint]))
    }
}

impl Pins {
    fn all(&mut self) -> [&mut Vec<f64>; 13] {
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

    /// Repeats the first joint of a closed chain behind the last.
    pub(super) fn close(&mut self, joints: usize) {
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
        linkage: &Linkage,
        bearing: &Bearing,
        posture: &Posture,
    ) -> Option<Element> {
        let [hole, pin] = linkage.joints[joint].pair?;
        if self.gap[joint] >= 0.0 {
            return None;
        }
        let side = |mate| match mate {
            Mate::Link { link, end } => (Some(link), posture.arm(link, end)),
            Mate::Ground(_) => (None, Vector::zeros()),
        };
        let ((a, arm_a), (b, arm_b)) = (side(pin), side(hole));
        let normal = self.normal(joint);
        let [lever_pin, lever_hole] = bearing.levers(-self.gap[joint]);
        let rub = self.rubs.get(joint).copied().unwrap_or_default();
        Some(Element {
            joint,
            a,
            b: b.map_or(Partner::Ground, Partner::Body),
            arm_a,
            arm_b,
            pivot_b: arm_b,
            lever_a: lever_pin,
            lever_b: lever_hole,
            normal: if linkage.pairs.pin_after[joint] {
                normal
            } else {
                -normal
            },
            force: self.force[joint],
            rub: rub.force,
            stiffness: self.stiffness[joint],
            damping: self.damping[joint],
            drag: rub.drag,
            secant: rub.secant,
            across: self.across[joint],
        })
    }
}

/// The contact of all joints, as one call that is compiled for every kind of processor.
pub(super) struct Contacts<'a> {
    pub(super) linkage: &'a Linkage,
    pub(super) bearing: &'a Bearing,
    pub(super) posture: &'a Posture,
    pub(super) memory: &'a mut PinMemory,
    pub(super) pins: &'a mut Pins,
}

impl WithSimd for Contacts<'_> {
    /// The power lost along the normals, and how contacts began.
    type Output = Tally;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Tally {
        self.act(Wide(simd))
    }
}

impl Contacts<'_> {
    #[inline(always)]
    pub(super) fn act<S: Simd>(self, w: Wide<S>) -> Tally {
        let joints = self.linkage.joints.len();
        self.memory.resize(joints);
        self.pins.resize(joints);
        let (before, after) = (&self.posture.before, &self.posture.after);
        let known = &self.linkage.memory.joints;
        let present = &self.linkage.pairs.present;
        let law = &self.bearing.pins;
        let (memory, pins) = (self.memory, self.pins);
        let zero = w.splat(0.0);
        let clearance = w.splat(self.bearing.clearance);
        let mut loss = zero;
        let mut tally = Tally::new();
        for start in (0..joints).step_by(Wide::<S>::COUNT) {
            let at = |all: &[f64]| w.load(all, start);
            let [ex, ey] = [at(&after.x) - at(&before.x), at(&after.y) - at(&before.y)];
            let [eccentricity, inverse] = (ex * ex + ey * ey).roots();
            let present = at(present).greater(zero);
            let gap = present.select(clearance - eccentricity, w.splat(PinTouch::OPEN.gap));
            let directed = present & eccentricity.greater(w.splat(CENTRED));
            let inverse = directed.select(inverse, zero);
            let [nx, ny] = [ex * inverse, ey * inverse];
            let closing =
                nx * (at(&after.vx) - at(&before.vx)) + ny * (at(&after.vy) - at(&before.vy));
            let touching = directed & zero.greater(gap);
            gap.store(&mut memory.gap, start);
            gap.store(&mut pins.gap, start);
            closing.store(&mut memory.closing, start);
            nx.store(&mut pins.normal_x, start);
            ny.store(&mut pins.normal_y, start);
            let turn_before = at(&before.arm_x) * ny - at(&before.arm_y) * nx;
            let turn_after = at(&after.arm_x) * ny - at(&after.arm_y) * nx;
            turn_before.store(&mut pins.turn_before, start);
            turn_after.store(&mut pins.turn_after, start);
            let mut onset = touching.select(at(&known.inverse_onset), zero);
            onset.store(&mut memory.inverse_onset, start);
            let began = touching & w.splat(f64::MIN_POSITIVE).greater(onset);
            if began.any() {
                self.bearing
                    .begin(known, memory, start..start + Wide::<S>::COUNT, &mut tally);
                onset = w.load(&memory.inverse_onset, start);
            }
            // Lanes without contact reckon with some depth that is harmless.
            let depth = touching.select(-gap, w.splat(1.0));
            let [elastic, slope] = law.elastic(w, depth);
            let elastic = touching.select(elastic, zero);
            // F = g clamp(1 + χ δ̇/v, 0, 1 + 4χ)   or   F = max(0, g + c δ̇)
            let factor = w.splat(law.factor);
            let ratio = closing * onset;
            let limit = w.splat(RATIO_LIMIT);
            let share = (w.splat(1.0) + factor * ratio.min(limit)).max(zero);
            let viscous = touching.select(w.splat(law.damping), zero);
            let force = (elastic * share + viscous * closing).max(zero);
            let pressed = force.greater(zero);
            let damping = limit.greater(ratio).select(factor * elastic * onset, zero) + viscous;
            let across = force * inverse;
            force.store(&mut memory.force, start);
            force.store(&mut pins.force, start);
            across.store(&mut pins.across, start);
            pressed
                .select(slope * share, zero)
                .store(&mut pins.stiffness, start);
            pressed
                .select(damping, zero)
                .store(&mut pins.damping, start);
            loss += (force - elastic) * closing;
            (-(force * nx)).store(&mut pins.push_x, start);
            (-(force * ny)).store(&mut pins.push_y, start);
            (force * turn_before).store(&mut pins.moment_before, start);
            (-(force * turn_after)).store(&mut pins.moment_after, start);
        }
        tally.normal_loss = loss.sum();
        tally
    }
}

impl Bearing {
    /// Writes down the onsets of contacts that were open before.
    #[inline(never)]
    fn begin(
        &self,
        known: &PinMemory,
        memory: &mut PinMemory,
        joints: std::ops::Range<usize>,
        tally: &mut Tally,
    ) {
        for joint in joints {
            let (gap, closing) = (memory.gap[joint], memory.closing[joint]);
            if gap >= 0.0 || known.inverse_onset[joint] > 0.0 {
                continue;
            }
            let before = [known.gap[joint], known.closing[joint]];
            let onset = interpolated_onset(before[0], before[1], gap, closing).max(self.floor);
            memory.inverse_onset[joint] = 1.0 / onset;
            tally.began(before[0], -gap);
        }
    }

    /// Friction of the closed joints, one after the other; returns the power lost \[W\].
    pub(super) fn rub(
        &self,
        linkage: &Linkage,
        posture: &Posture,
        dt: f64,
        memory: &mut PinMemory,
        pins: &mut Pins,
    ) -> f64 {
        let mut loss = 0.0;
        pins.rubs.clear();
        pins.rubs.resize(linkage.joints.len(), Rubbing::default());
        let (before, after) = (&posture.before, &posture.after);
        for joint in 0..linkage.joints.len() {
            memory.stick[joint] = 0.0;
            if memory.inverse_onset[joint] <= 0.0 {
                continue;
            }
            let levers = self.side_levers(linkage.pairs.pin_after[joint], -memory.gap[joint]);
            let tangent = turned(pins.normal(joint));
            let relative = Vector::new(
                after.vx[joint] - before.vx[joint],
                after.vy[joint] - before.vy[joint],
            );
            // The pin's slip along its own tangent is the same from either side.
            let slip = tangent.dot(&relative) + levers[1] * after.spin[joint]
                - levers[0] * before.spin[joint];
            let force = memory.force[joint];
            let rub = self
                .friction
                .rub(force, slip, linkage.memory.joints.stick[joint], dt);
            memory.stick[joint] = rub.state;
            let rubbing = Rubbing {
                force: rub.force,
                drag: rub.damping,
                secant: secant(&self.friction, rub, slip),
            };
            pins.rubs[joint] = rubbing;
            loss -= rub.force * slip;
            // Action on the side after: R t, with its lever; the side before feels the opposite.
            let push = tangent * rub.force;
            pins.push_x[joint] += push.x;
            pins.push_y[joint] += push.y;
            let arm =
                |side: &super::posture::Sides| Vector::new(side.arm_x[joint], side.arm_y[joint]);
            pins.moment_after[joint] += super::cross(arm(after), push) + levers[1] * rub.force;
            pins.moment_before[joint] -= super::cross(arm(before), push) + levers[0] * rub.force;
        }
        loss
    }

    /// From the centres of the sides before and after along n to where they touch \[m\].
    pub(super) fn side_levers(&self, pin_after: bool, depth: f64) -> [f64; 2] {
        let [pin, hole] = self.levers(depth);
        // Seen along n, the touching point lies behind the pin's centre if the pin is on the side before.
        if pin_after {
            [hole, pin]
        } else {
            [-pin, -hole]
        }
    }

    pub(super) fn rubs(&self) -> bool {
        self.friction != Friction::None
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::Moment;
    use pulp::Scalar128b;

    use super::*;
    use crate::chains::links::Joining;
    use crate::chains::links::tests::{kinds, of, set_off};

    /// Lanes of any width against one joint at a time, as free rollers and their bushes are looked at.
    #[test]
    fn all_at_once_is_as_one_by_one() {
        for (kind, parts) in kinds() {
            let (system, record, q, v) = set_off(parts);
            let linkage = of(&system);
            let Joining::Clearance(bearing) = &linkage.joining else {
                panic!("{kind}");
            };
            let at = Moment {
                t: 0.0,
                q: &q,
                v: &v,
            };
            let posture = &record.chains[0].play.posture;
            let widths: [fn(Contacts<'_>) -> Tally; 3] = [
                |contacts| contacts.act(Wide(pulp::Scalar)),
                |contacts| contacts.act(Wide(Scalar128b)),
                |contacts| pulp::Arch::new().dispatch(contacts),
            ];
            for act in widths {
                let (mut memory, mut pins) = (PinMemory::default(), Pins::default());
                let mut tally = act(Contacts {
                    linkage,
                    bearing,
                    posture,
                    memory: &mut memory,
                    pins: &mut pins,
                });
                if bearing.rubs() {
                    tally.friction_loss =
                        bearing.rub(linkage, posture, 0.0, &mut memory, &mut pins);
                }
                let mut sum = Tally::new();
                let mut closed = 0;
                for (joint, mates) in linkage.joints.iter().enumerate() {
                    let Some(mates) = mates.pair else { continue };
                    let [hole, pin] = mates.map(|mate| linkage.part(mate, at, posture));
                    let known = &linkage.memory.joints;
                    let before = PinTouch {
                        gap: known.gap[joint],
                        closing: known.closing[joint],
                        onset: known.closed(joint).map_or(0.0, |(onset, _)| onset),
                        ..PinTouch::OPEN
                    };
                    let (touch, element) =
                        bearing.touch(joint, &hole, &pin, &before, 0.0, &mut sum);
                    let found = pins.element(joint, linkage, bearing, posture);
                    assert_eq!(element.is_some(), found.is_some(), "{kind}, {joint}");
                    assert!((touch.gap - memory.gap[joint]).abs() < 1e-17);
                    let (Some(a), Some(b)) = (element, found) else {
                        continue;
                    };
                    closed += 1;
                    // Depths are differences of radii and lose four digits.
                    // A slip is a small difference of large velocities.
                    assert!((a.rub - b.rub).abs() <= 1e-12 * a.force, "{kind}, {joint}");
                    assert!(
                        (a.secant - b.secant).abs() <= 1e-9 * a.secant,
                        "{kind}, {joint}"
                    );
                    for (a, b) in [
                        (a.force, b.force),
                        (a.stiffness, b.stiffness),
                        (a.damping, b.damping),
                        (a.across, b.across),
                        (a.normal.x, b.normal.x),
                        (a.normal.y, b.normal.y),
                        (a.lever_a, b.lever_a),
                        (a.lever_b, b.lever_b),
                        (1.0 / touch.onset, memory.inverse_onset[joint]),
                    ] {
                        assert!(
                            (a - b).abs() <= 1e-12 * a.abs() + 1e-15,
                            "{kind}, {joint}: {a} {b}"
                        );
                    }
                }
                assert!(closed > 9, "{kind}: {closed}");
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(1e-9);
                assert!(near(sum.normal_loss, tally.normal_loss), "{kind}");
                assert!(near(sum.friction_loss, tally.friction_loss), "{kind}");
            }
        }
    }
}
