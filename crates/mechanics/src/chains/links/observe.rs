//! Quantities that can be read off a linkage.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{Joining, JointState, Linkage, free_part};
use crate::chains::links::Work;
use crate::contact::MemoryField;
use crate::energy::{Energy, Store};
use crate::joints::{JointFindings, Mate, Partner};
use crate::seam::Observation;

impl Linkage {
    /// Appends places, velocities, and how joints and bushes stand.
    pub(super) fn observe_motion(&self, at: Moment<'_>, work: &Work, out: &mut Observation) {
        let Work {
            joints,
            joint_state,
            ..
        } = work;
        out.add_rollers(joint_state.posture.pose(), self.joints.len());
        out.link_angle
            .extend((0..self.series.links).map(|link| at.q[3 * link + 2]));
        for (index, joint) in self.joints.iter().enumerate() {
            let offset = self.offset(index, at, joint_state);
            out.joint_offset_x.push(offset.x);
            out.joint_offset_y.push(offset.y);
            out.joint_depth.push(match &self.joining {
                Joining::Clearance(_) => {
                    (-joints.memory.pins.get(MemoryField::Gap, index)).max(0.0)
                }
                Joining::Hinges(_) => 0.0,
            });
            out.joint_angle.push(match joint.pair {
                Some([hole, pin]) => angle(pin, at) - angle(hole, at),
                None => f64::NAN,
            });
        }
        self.observe_bushes(at, work, out);
    }

    /// Appends the forces of joints and free rollers.
    pub(super) fn observe_joints(&self, joint_state: &JointState, out: &mut Observation) {
        for joint in 0..self.joints.len() {
            let force = self.pin_force(joint_state, joint);
            out.joint_force_x.push(force.x);
            out.joint_force_y.push(force.y);
        }
        let free = self.free_rollers.as_ref();
        let first = out.bush_force_x.len();
        let start = (0..self.joints.len()).map(|joint| {
            let body = free.and_then(|free| free.body[joint]);
            body.map_or(f64::NAN, |_| 0.0)
        });
        out.bush_force_x.extend(start.clone());
        out.bush_force_y.extend(start);
        // Only bushes press on another body of the chain here: pins are not among the elements.
        let bushes = joint_state.elements.iter();
        for bush in bushes.filter(|element| matches!(element.b, Partner::Body(_))) {
            let push = bush.push();
            out.bush_force_x[first + bush.joint] = push.x;
            out.bush_force_y[first + bush.joint] = push.y;
        }
    }

    /// Appends how every bush stands to its roller, where rollers are free.
    fn observe_bushes(&self, at: Moment<'_>, work: &Work, out: &mut Observation) {
        for (index, joint) in self.joints.iter().enumerate() {
            let free = self.free_rollers.as_ref();
            let body = free.and_then(|free| free.body[index]);
            let nothing = Vector::new(f64::NAN, f64::NAN);
            let (offset, depth) = body.map_or((nothing, f64::NAN), |body| {
                let bush = self.part(joint.carrier, at, &work.joint_state.posture);
                let offset = bush.place - free_part(body, at).place;
                let gap = work.joints.memory.bushes.get(MemoryField::Gap, index);
                (offset, (-gap).max(0.0))
            });
            out.bush_offset_x.push(offset.x);
            out.bush_offset_y.push(offset.y);
            out.bush_depth.push(depth);
        }
    }

    /// Centre of the pin seen from the centre of its bush \[m\].
    fn offset(&self, joint: usize, at: Moment<'_>, joint_state: &JointState) -> Vector {
        match self.joints[joint].pair {
            Some(mates) => {
                let [hole, pin] = mates.map(|mate| self.part(mate, at, &joint_state.posture).place);
                pin - hole
            }
            None => Vector::new(f64::NAN, f64::NAN),
        }
    }

    /// Energies of the chain.
    pub(super) fn add_energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        found: &JointFindings,
        out: &mut Energy,
    ) {
        for (index, body) in self.bodies.iter().enumerate() {
            let [x, y] = [at.q[3 * index], at.q[3 * index + 1]];
            let [vx, vy, spin] = [0, 1, 2].map(|k| at.v[3 * index + k]);
            out.stores[Store::Chain as usize] +=
                0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * spin * spin);
            out.stores[Store::Gravity as usize] -= body.mass * (gravity.x * x + gravity.y * y);
        }
        out.stores[Store::Joints as usize] += self.stored(&found.memory);
        let stuck = self.stuck(&found.memory);
        out.hold_in_joints(found.resistance.stored + stuck);
    }
}

/// Direction of a side of a joint \[rad\].
fn angle(mate: Mate, at: Moment<'_>) -> f64 {
    match mate {
        Mate::Link { link, .. } => at.q[3 * link + 2],
        Mate::Ground(_) => 0.0,
    }
}
