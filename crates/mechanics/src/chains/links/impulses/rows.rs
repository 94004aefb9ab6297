//! The rows of J of the joints, by lanes.
//!
//! u over the velocity of the link after the joint and −u over that of the link before, with the levers of their rotations.

use chaindrive_integrate::{Array, Weights};
use pulp::Simd;

use crate::chains::links::by_link::{ByLink, load};
use crate::chains::links::reactions::arms;
use crate::chains::links::{JointState, Linkage};
use crate::contact::BoreContact;
use crate::lanes::{Lane, Wide};

/// One row a joint, whole lanes; all zero where there is no contact.
///
/// The number after the last joint of a closed chain stands for the first one again.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    x: Array,
    y: Array,
    turn_before: Array,
    turn_after: Array,
    /// Weight of the row; zero where there is no contact.
    pub(super) weight: Array,
}

/// Rows side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowLane<S: Simd> {
    pub(super) x: Lane<S>,
    pub(super) y: Lane<S>,
    pub(super) turn_before: Lane<S>,
    pub(super) turn_after: Lane<S>,
}

impl Rows {
    fn all(&mut self) -> [&mut Array; 5] {
        [
            &mut self.x,
            &mut self.y,
            &mut self.turn_before,
            &mut self.turn_after,
            &mut self.weight,
        ]
    }

    fn resize(&mut self, count: usize) {
        for values in self.all() {
            values.resize(count, 0.0);
        }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, w: Wide<S>, start: usize) -> RowLane<S> {
        RowLane {
            x: w.load(&self.x, start),
            y: w.load(&self.y, start),
            turn_before: w.load(&self.turn_before, start),
            turn_after: w.load(&self.turn_after, start),
        }
    }

    /// The normals of all joints.
    #[inline(always)]
    pub(super) fn set_normals<S: Simd>(
        &mut self,
        w: Wide<S>,
        joint_state: &JointState,
        weights: Weights,
    ) {
        let pins = &joint_state.pins;
        let count = pins.normal_x.len();
        if self.x.len() != count {
            self.resize(count);
        }
        let zero = w.splat(0.0);
        for start in (0..count).step_by(Wide::<S>::COUNT) {
            let weight = w.splat(weights.damping) * w.load(&pins.damping, start)
                + w.splat(weights.stiffness) * w.load(&pins.stiffness, start);
            let present = weight.greater(zero);
            for (from, to) in [
                (&pins.normal_x, &mut self.x),
                (&pins.normal_y, &mut self.y),
                (&pins.turn_before, &mut self.turn_before),
                (&pins.turn_after, &mut self.turn_after),
            ] {
                present.select(w.load(from, start), zero).store(to, start);
            }
            weight.store(&mut self.weight, start);
        }
    }

    /// The tangents of the joints, where pins rub and where the force turns with them; `known` is the change of velocities that the forces by
    /// themselves make. The weights are those of [`Element::step_weights`](crate::chains::links::Element::step_weights).
    #[inline(always)]
    pub(super) fn set_tangents<S: Simd>(
        &mut self,
        w: Wide<S>,
        linkage: &Linkage,
        bearing: &BoreContact,
        joint_state: &JointState,
        known: &ByLink,
        weights: Weights,
    ) {
        let pins = &joint_state.pins;
        let count = pins.normal_x.len();
        if self.x.len() != count {
            self.resize(count);
        }
        let zero = w.splat(0.0);
        let soft = w.splat(linkage.soft(weights));
        for start in (0..linkage.joints.len()).step_by(Wide::<S>::COUNT) {
            let depth = -w.load(&pins.gap, start);
            let levers = bearing.lever_lanes(w, linkage.pairs.pins_after(w, start), depth);
            // t = ẑ × n
            let [tx, ty] = [
                -w.load(&pins.normal_y, start),
                w.load(&pins.normal_x, start),
            ];
            let [bx, by, ax, ay] = arms(w, &joint_state.posture, start);
            let turn_before = bx * ty - by * tx + levers[0];
            let turn_after = ax * ty - ay * tx + levers[1];
            let [before, after] = [load(w, known, start), load(w, known, start + 1)];
            let change =
                tx * (after[0] - before[0]) + ty * (after[1] - before[1]) + turn_after * after[2]
                    - turn_before * before[2];
            let secant = w.load(&pins.secant, start);
            let stops = (w.load(&pins.rub, start) * change).greater(zero);
            let drag = stops.select(secant, w.load(&pins.drag, start).min(secant));
            let across = w.load(&pins.across, start);
            let across = across.greater(soft).select(across, zero);
            let weight = w.splat(weights.damping) * drag + w.splat(weights.stiffness) * across;
            let present = weight.greater(zero);
            for (value, to) in [
                (tx, &mut self.x),
                (ty, &mut self.y),
                (turn_before, &mut self.turn_before),
                (turn_after, &mut self.turn_after),
                (weight, &mut self.weight),
            ] {
                present.select(value, zero).store(to, start);
            }
        }
        if linkage.series.is_closed() {
            for values in self.all() {
                values[linkage.series.links] = values[0];
            }
        }
    }
}
