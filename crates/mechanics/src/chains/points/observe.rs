//! Observations of a chain of points.

use chaindrive_contact::Prepared;
use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{AFTER, BEFORE, Ends, Points, ROLLERS};
use crate::chains::Record;
use crate::contact::{ContactState, Frame, Kept, PlateContact};
use crate::energy::{Energy, Store};
use crate::seam::Observation;

/// Sign of the force on a pin along n, which leads from the end before to the end after: the bush pushes it back.
fn pushed_back(pin: usize) -> f64 {
    if pin == AFTER { -1.0 } else { 1.0 }
}

impl Points {
    pub(in crate::chains) fn observe(
        &self,
        at: Moment<'_>,
        _record: &Record,
        out: &mut Observation,
    ) {
        let n = self.stride;
        let count = self.rollers;
        out.roller_x.extend_from_slice(&at.q[..count]);
        out.roller_y.extend_from_slice(&at.q[n..n + count]);
        out.roller_vx.extend_from_slice(&at.v[..count]);
        out.roller_vy.extend_from_slice(&at.v[n..n + count]);
        let angles: Vec<f64> = (0..count)
            .map(|link| {
                let along = self.along(at.q, link);
                along.y.atan2(along.x)
            })
            .collect();
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
            let before = angles[(joint + count - 1) % count];
            let turned = (angles[joint] - before) * -pushed_back(pin);
            out.joint_angle.push(turned.sin().atan2(turned.cos()));
        }
        out.link_angle.extend(angles);
    }

    /// Appends the forces of joints and free rollers, and the tensions of the links.
    pub(in crate::chains) fn observe_forces(
        &self,
        at: Moment<'_>,
        record: &Record,
        out: &mut Observation,
    ) {
        out.link_tension.extend(self.tensions(at, record));
        let found = &record.points;
        for joint in 0..self.rollers {
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
        let next = (link + 1) % self.rollers;
        self.point(q, BEFORE, next) - self.point(q, AFTER, link)
    }

    /// Tension of every link \[N\].
    pub(in crate::chains) fn tensions(&self, at: Moment<'_>, _record: &Record) -> Vec<f64> {
        let end = |block: usize, joint: usize| {
            let place = self.point(at.q, block, joint);
            (place, self.point(at.v, block, joint).coords)
        };
        let links = 0..self.rollers;
        links
            .map(|link| {
                let next = (link + 1) % self.rollers;
                self.links
                    .tension(link, [end(AFTER, link), end(BEFORE, next)])
            })
            .collect()
    }

    pub(in crate::chains) fn energies(
        &self,
        at: Moment<'_>,
        gravity: Vector,
        record: &Record,
        out: &mut Energy,
    ) {
        for joint in 0..self.rollers {
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
        let memory = &record.points.memory;
        let bearings = [(&self.pin, &memory.pins), (&self.bush, &memory.bushes)];
        for (bearing, memory) in bearings {
            let gaps = memory.each(Kept::Gap).take(self.rollers);
            let stored = gaps.filter(|gap| *gap < 0.0);
            let stored = stored.map(|gap| bearing.energy(gap));
            out.stores[Store::Joints as usize] += stored.sum::<f64>();
        }
        out.hold_in_joints(record.resistance.stored);
    }

    pub(in crate::chains) fn plate_energy(
        &self,
        at: Moment<'_>,
        plates: &PlateContact,
        frame: &Frame,
        _record: &Record,
    ) -> f64 {
        let ends = Ends {
            chain: self,
            q: at.q,
            v: at.v,
            a: &mut [],
        };
        plates.stored(&ends, frame, self.links.count)
    }

    /// Laws of pins in bushes, and of bushes in rollers.
    pub(in crate::chains) fn bearing_laws(&self) -> [Option<Prepared>; 2] {
        [&self.pin, &self.bush].map(|bearing| Some(bearing.law))
    }

    /// How a pin stands to its bush, and a bush to its roller.
    pub(in crate::chains) fn contacts_of(&self, joint: usize) -> [Option<ContactState>; 2] {
        [&self.memory.pins, &self.memory.bushes].map(|memory| Some(memory.at(joint)))
    }
}
