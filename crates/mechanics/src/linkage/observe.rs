//! What can be read off a linkage.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{Joining, Linkage, Mate, Play};
use crate::energy::{Energy, Store};
use crate::observe::Observation;

impl Linkage {
    /// Fills in what belongs to the chain.
    pub(crate) fn observe(&self, at: Moment<'_>, play: &Play, out: &mut Observation) {
        let count = self.joints.len();
        let copy = |to: &mut Vec<f64>, from: &[f64]| {
            to.clear();
            to.extend_from_slice(&from[..count]);
        };
        copy(&mut out.roller_x, &play.posture.x);
        copy(&mut out.roller_y, &play.posture.y);
        copy(&mut out.roller_vx, &play.posture.vx);
        copy(&mut out.roller_vy, &play.posture.vy);
        out.link_tension.clear();
        out.link_tension.extend(self.tensions(play));
        out.link_angle.clear();
        out.link_angle
            .extend((0..self.links).map(|link| at.q[3 * link + 2]));
        for values in [
            &mut out.joint_offset_x,
            &mut out.joint_offset_y,
            &mut out.joint_force_x,
            &mut out.joint_force_y,
            &mut out.joint_force,
            &mut out.joint_angle,
            &mut out.joint_depth,
        ] {
            values.clear();
        }
        for (index, joint) in self.joints.iter().enumerate() {
            let offset = self.offset(index, at, play);
            let force = self.pin_force(play, index);
            out.joint_offset_x.push(offset.x);
            out.joint_offset_y.push(offset.y);
            out.joint_force_x.push(force.x);
            out.joint_force_y.push(force.y);
            out.joint_force.push(force.norm());
            out.joint_depth.push(match &self.joining {
                Joining::Clearance(_) => (-play.memory.joints.gap[index]).max(0.0),
                Joining::Hinges(_) => 0.0,
            });
            out.joint_angle.push(match joint.pair {
                Some([hole, pin]) => angle(pin, at) - angle(hole, at),
                None => f64::NAN,
            });
        }
    }

    /// Centre of the pin seen from the centre of its bush \[m\].
    fn offset(&self, joint: usize, at: Moment<'_>, play: &Play) -> Vector {
        match self.joints[joint].pair {
            Some(mates) => {
                let [hole, pin] = mates.map(|mate| self.part(mate, at, &play.posture).place);
                pin - hole
            }
            None => Vector::new(f64::NAN, f64::NAN),
        }
    }

    /// Energies of the chain.
    pub(crate) fn energies(&self, at: Moment<'_>, gravity: Vector, play: &Play, out: &mut Energy) {
        for (index, body) in self.bodies.iter().enumerate() {
            let [x, y] = [at.q[3 * index], at.q[3 * index + 1]];
            let [vx, vy, spin] = [0, 1, 2].map(|k| at.v[3 * index + k]);
            out.stores[Store::Chain as usize] +=
                0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * spin * spin);
            out.stores[Store::Gravity as usize] -= body.mass * (gravity.x * x + gravity.y * y);
        }
        out.stores[Store::Joints as usize] += self.stored(&play.memory);
    }

    /// Speed at touch \[m/s\] and force \[N\] of a closed joint, and of a closed bush in its roller, for those
    /// who count impacts.
    pub(crate) fn touching(&self, joint: usize) -> [Option<(f64, f64)>; 2] {
        let pin = matches!(self.joining, Joining::Clearance(_))
            .then(|| self.memory.joints.closed(joint))
            .flatten();
        let bush = self.free_rollers.is_some();
        let bush = bush.then(|| self.memory.bushes.closed(joint)).flatten();
        [pin, bush]
    }
}

/// Direction of a side of a joint \[rad\].
fn angle(mate: Mate, at: Moment<'_>) -> f64 {
    match mate {
        Mate::Link { link, .. } => at.q[3 * link + 2],
        Mate::Ground(_) => 0.0,
    }
}
