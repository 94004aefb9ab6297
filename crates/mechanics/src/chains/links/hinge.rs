//! Ideal joints: the forces that keep the ends of neighbouring links together.
//!
//! ```text
//! J M⁻¹ Jᵀ λ = −(J a + J̇ v − s̈ + 2 α ċ + α² c),     a ← a + M⁻¹ Jᵀ λ
//! c = P_after − P_before,   λ: force on the side after
//! ```
//!
//! The rate α draws what rounding and the time stepping leave of c back to zero.
//!
//! # Source
//! J. Baumgarte, *Comput. Methods Appl. Mech. Eng.* **1**, 1972, 1–16 (stabilisation).

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, Weights, kernel};

use super::by_link::{ByLink, load};
use super::reactions::{Inertia, Reactions, arms};
use super::{JointState, Linkage, Posture, supplied};
use crate::End;
use crate::energy::Flow;
use crate::joints::Mate;
use crate::lanes::Wide;

/// Ideal joints.
#[derive(Clone, Debug)]
pub(crate) struct Hinges {
    /// Rate α of the stabilisation \[1/s\].
    pub(crate) rate: f64,
}

impl Hinges {
    /// Factors J M⁻¹ Jᵀ where the links are. Where nothing can keep the joints together their forces are not numbers, which
    /// stops the run.
    pub(super) fn factor(linkage: &Linkage, joint_state: &mut JointState) {
        let JointState {
            reactions,
            posture,
            hinge_forces,
            ..
        } = joint_state;
        reactions.factor(linkage, posture, Inertia::OfLinks);
        hinge_forces.resize(linkage.joints.len(), Vector::zeros());
    }

    /// Adds the joint forces to those on the bodies and writes them down by joint.
    pub(crate) fn hold(
        &self,
        linkage: &Linkage,
        at: Moment<'_>,
        rates: &mut [f64],
        joint_state: &mut JointState,
    ) {
        self.find(linkage, at, joint_state);
        let loads = &mut joint_state.loads;
        let forces = joint_state.forces[..linkage.series.links].iter_mut();
        for (force, load) in forces.zip(loads.each(linkage.series.links)) {
            force.x += load[0];
            force.y += load[1];
            force.z += load[2];
        }
        if linkage.series.is_closed() {
            return;
        }
        for joint in [0, linkage.series.links] {
            let Some(mates) = linkage.joints[joint].pair else {
                continue;
            };
            let force = joint_state.hinge_forces[joint];
            let [hole, pin] = mates.map(|mate| linkage.part(mate, at, &joint_state.posture));
            rates[Flow::Motions as usize] += supplied(&mates, force, &hole, &pin);
        }
    }

    /// Share of J b that a correction x opens the joints by: what draws them together answers to x as well.
    ///
    /// ```text
    /// J x + c 2 α J x + k α² J x = J b
    /// ```
    ///
    /// Steps of one solution take what draws the joints together explicitly.
    pub(super) fn share(&self, weights: Weights) -> f64 {
        if weights.once {
            return 1.0;
        }
        let Weights {
            damping, stiffness, ..
        } = weights;
        1.0 / (1.0 + 2.0 * self.rate * damping + self.rate * self.rate * stiffness)
    }

    /// Takes out of the joint forces, which the bodies feel already, what draws the ends together.
    ///
    /// ```text
    /// J M⁻¹ Jᵀ Δλ = −(J a + J̇ v − s̈) = 2 α ċ + α² c   of the accelerations a under λ:   λ + Δλ
    /// ```
    pub(super) fn undrawn(linkage: &Linkage, at: Moment<'_>, joint_state: &mut JointState) {
        let drawn = joint_state.hinge_forces.clone();
        Self { rate: 0.0 }.find(linkage, at, joint_state);
        for (force, drawn) in joint_state.hinge_forces.iter_mut().zip(drawn) {
            *force += drawn;
        }
    }

    /// Writes down the joint forces that keep the ends together under the forces on the bodies.
    pub(super) fn find(&self, linkage: &Linkage, at: Moment<'_>, joint_state: &mut JointState) {
        let JointState {
            reactions,
            posture,
            hinge_forces,
            forces,
            loads,
            ..
        } = joint_state;
        let of_links = forces[..linkage.series.links].iter();
        loads.read(linkage, of_links.map(|force| [force.x, force.y, force.z]));
        let ground = [0, 1].map(|end| {
            let joint = linkage.joints[end * (linkage.joints.len() - 1)];
            let mates = joint.pair.into_iter().flatten();
            let by = mates.map(|mate| ground_acceleration(linkage, mate, at));
            by.sum()
        });
        let registers = linkage.series.registers;
        registers.dispatch(joint_forces(
            self.rate, linkage, posture, reactions, ground, loads,
        ));
        for (joint, force) in hinge_forces.iter_mut().enumerate() {
            let on_after = reactions.force(joint);
            *force = if linkage.pairs.pin_after(joint) {
                on_after
            } else {
                -on_after
            };
        }
    }
}

kernel!(
    /// Forces in the joints under the loads on the links, and then what they do to the links in the place of these loads.
    fn joint_forces<'a, S: Simd>(
        w: Wide<S>,
        rate: f64,
        linkage: &'a Linkage,
        posture: &'a Posture,
        reactions: &'a mut Reactions,
        /// Accelerations of the supports before the first joint and after the last \[m/s²\].
        ground: [Vector; 2],
        loads: &'a mut ByLink,
    ) {
        let (shapes, zero) = (&linkage.shapes, w.splat(0.0));
        let (before, after) = (&posture.before, &posture.after);
        let [damping, stiffness] = [2.0 * rate, rate * rate].map(|rate| w.splat(rate));
        let joints = linkage.joints.len();
        for start in (0..joints).step_by(Wide::<S>::COUNT) {
            // By how much both sides of each joint would be accelerated apart under the loads alone.
            let [bx, by, ax, ay] = arms(w, posture, start);
            let mut drift = [zero; 2];
            // J a + J̇ v = F/m + α ẑ × r − ω² r
            for (place, x, y, side) in [(start, bx, by, before), (start + 1, ax, ay, after)] {
                let mobility = w.load(&shapes.mobility, place);
                let [fx, fy, moment] = load(w, loads, place);
                let turning = moment * w.load(&shapes.turning, place);
                let spin = w.load(&side.spin, start);
                let squared = spin * spin;
                drift = [
                    (fx * mobility - turning * y - squared * x) - drift[0],
                    (fy * mobility + turning * x - squared * y) - drift[1],
                ];
            }
            // 2 α ċ + α² c
            // What draws the sides together joins in, and makes the right-hand side of the joint forces.
            let present = linkage.pairs.present(w, start);
            for (k, (to, [place, velocity])) in reactions
                .right
                .iter_mut()
                .zip([
                    [(&before.x, &after.x), (&before.vx, &after.vx)],
                    [(&before.y, &after.y), (&before.vy, &after.vy)],
                ])
                .enumerate()
            {
                let apart = w.load(place.1, start) - w.load(place.0, start);
                let opening = w.load(velocity.1, start) - w.load(velocity.0, start);
                let drift = drift[k] + (damping * opening + stiffness * apart);
                present.select(-drift, zero).store(to, start);
            }
        }
        // Supports at the ends of a strand have accelerations of their own.
        if !linkage.series.is_closed() {
            let [first, last] = ground;
            for (k, right) in reactions.right.iter_mut().enumerate() {
                right[0] += first[k];
                right[joints - 1] -= last[k];
            }
        }
        // Forces in the joints, and what they do to the links on either side.
        reactions.solve(w);
        for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let [x, y, turn] = reactions.load(w, posture, link);
            x.store(&mut loads.x, link + 1);
            y.store(&mut loads.y, link + 1);
            turn.store(&mut loads.turn, link + 1);
        }
    }
);

fn ground_acceleration(linkage: &Linkage, mate: Mate, at: Moment<'_>) -> Vector {
    match mate {
        Mate::Ground(end) => match &linkage.series.ends[end].end {
            End::Driven { x, y } => Vector::new(x.at(at.t).acceleration, y.at(at.t).acceleration),
            End::Free | End::Fixed | End::Pulled { .. } => Vector::zeros(),
        },
        Mate::Link { .. } => Vector::zeros(),
    }
}
