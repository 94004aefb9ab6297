//! Observations of a chain of points.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{AFTER, BEFORE, Points, ROLLERS};
use crate::chains::points::Work;
use crate::contact::MemoryField;
use crate::energy::{Energy, Store};
use crate::joints::JointFindings;
use crate::seam::{Observation, Pose};

/// Sign of the force on a pin along n, which leads from the end before to the end after: the bush pushes it back.
fn pushed_back(pin: usize) -> f64 {
    if pin == AFTER { -1.0 } else { 1.0 }
}

impl Points {
    /// Appends places, velocities, and how pins and bushes stand.
    pub(super) fn observe_motion(&self, at: Moment<'_>, out: &mut Observation) {
        let count = self.series.rollers;
        out.add_rollers(Pose::of_first(at, self.series.stride), count);
        let first = out.link_angle.len();
        out.link_angle.extend((0..count).map(|link| {
            let along = self.along(at.q, link);
            along.y.atan2(along.x)
        }));
        for joint in 0..count {
            let [bush, pin] = self.sides(joint);
            let offset = self.point(at.q, pin, joint) - self.point(at.q, bush, joint);
            out.joint_offset_x.push(offset.x);
            out.joint_offset_y.push(offset.y);
            out.joint_depth
                .push((offset.norm() - self.pin.clearance).max(0.0));
            let offset = self.point(at.q, bush, joint) - self.point(at.q, ROLLERS, joint);
            out.bush_offset_x.push(offset.x);
            out.bush_offset_y.push(offset.y);
            out.bush_depth
                .push((offset.norm() - self.bush.clearance).max(0.0));
            let angles = &out.link_angle[first..];
            let before = angles[(joint + count - 1) % count];
            let turned = (angles[joint] - before) * -pushed_back(pin);
            out.joint_angle.push(turned.sin().atan2(turned.cos()));
        }
    }

    /// Appends the forces of joints and free rollers.
    pub(super) fn observe_joints(&self, found: &Work, out: &mut Observation) {
        for joint in 0..self.series.rollers {
            let [_, pin] = self.sides(joint);
            let force = pushed_back(pin) * found.pins.force[joint];
            out.joint_force_x.push(force * found.pins.normal_x[joint]);
            out.joint_force_y.push(force * found.pins.normal_y[joint]);
            // n leads from the roller to the bush, which the roller pushes back.
            let force = -found.bushes.force[joint];
            out.bush_force_x.push(force * found.bushes.normal_x[joint]);
            out.bush_force_y.push(force * found.bushes.normal_y[joint]);
        }
    }

    /// From the first end of a link to the second.
    pub(super) fn along(&self, q: &[f64], link: usize) -> Vector {
        let next = (link + 1) % self.series.rollers;
        self.point(q, BEFORE, next) - self.point(q, AFTER, link)
    }

    /// Adds kinetic energy, weight, and what links and joints store.
    pub(super) fn add_energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        found: &JointFindings,
        out: &mut Energy,
    ) {
        for joint in 0..self.series.rollers {
            for block in [ROLLERS, BEFORE, AFTER] {
                let mass = self.masses[block][joint];
                let place = self.point(at.q, block, joint).coords;
                let velocity = self.point(at.v, block, joint).coords;
                out.stores[Store::Chain as usize] += 0.5 * mass * velocity.norm_squared();
                out.stores[Store::Gravity as usize] -= mass * gravity.dot(&place);
            }
            let stretch = self.along(at.q, joint).norm() - self.links.rest[joint];
            // U = ½ k (ℓ − p)²
            out.stores[Store::Links as usize] +=
                0.5 * self.links.stiffness[joint] * stretch * stretch;
        }
        let memory = &found.memory;
        let bearings = [(&self.pin, &memory.pins), (&self.bush, &memory.bushes)];
        for (bearing, memory) in bearings {
            let gaps = memory.each(MemoryField::Gap).take(self.series.rollers);
            let stored = gaps.filter(|gap| *gap < 0.0);
            let stored = stored.map(|gap| bearing.law.energy(-gap));
            out.stores[Store::Joints as usize] += stored.sum::<f64>();
        }
        out.hold_in_joints(found.resistance.stored);
    }
}
