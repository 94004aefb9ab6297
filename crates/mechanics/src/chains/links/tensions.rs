//! Tensions of rigid links: half of what stretches them from both ends.
//!
//! ```text
//! T = ½ (F₂ − F₁)·d,   F at the ends of the link, d from the first to the second
//! ```

use chaindrive_geometry::Vector;
use chaindrive_integrate::kernel;

use super::{Joining, JointState, Linkage, Posture};
use crate::End;
use crate::joints::Partner;

impl Linkage {
    /// Appends the tension of all links \[N\]: joints, teeth and given loads together.
    pub(super) fn link_tensions(&self, joint_state: &JointState, out: &mut Vec<f64>) {
        let (first, posture) = (out.len(), &joint_state.posture);
        out.resize(first + self.series.links, 0.0);
        let tensions = &mut out[first..];
        match &self.joining {
            Joining::Clearance(_) => {
                let pins = &joint_state.pins;
                let pushes = [&pins.push_x[..], &pins.push_y[..]];
                let registers = self.series.registers;
                registers.dispatch(of_pushes(posture, pushes, tensions));
            }
            Joining::Hinges(_) => {
                // A joint pushes the link after it, and that before it the other way.
                let push = |joint: usize, along: Vector| {
                    let pull = along.dot(&joint_state.hinge_forces[joint]);
                    if self.pairs.pin_after(joint) {
                        pull
                    } else {
                        -pull
                    }
                };
                for (link, tension) in tensions.iter_mut().enumerate() {
                    let along = along(posture, link);
                    let next = (link + 1) % self.joints.len();
                    *tension -= 0.5 * (push(link, along) + push(next, along));
                }
            }
        }
        let mut load = |body: Option<usize>, joint: usize, force: Vector| {
            // Rollers have no ends.
            let Some(link) = body.filter(|body| *body < self.series.links) else {
                return;
            };
            let pull = 0.5 * along(posture, link).dot(&force);
            tensions[link] += if joint == link { -pull } else { pull };
        };
        for element in &joint_state.elements {
            load(element.a, element.joint, element.push());
            if let Partner::Body(body) = element.b {
                load(Some(body), element.joint, -element.push());
            }
        }
        for (index, held) in self.series.ends.iter().enumerate() {
            if let End::Pulled { force } = &held.end {
                let link = if index == 0 { 0 } else { self.series.links - 1 };
                load(Some(link), link + index, *force);
            }
        }
    }
}

/// Direction of a link, of length one.
fn along(posture: &Posture, link: usize) -> Vector {
    let [start, end] = [0, 1].map(|end| posture.tip(link, end).place);
    (end - start).normalize()
}

kernel!(
    /// Tensions under the forces on the sides after the joints; after the last joint of a closed chain comes the first.
    fn of_pushes<'a, S: Simd>(
        _simd: S,
        posture: &'a Posture,
        pushes: [&'a [f64]; 2],
        tensions: &'a mut [f64],
    ) {
        let Posture { before, after, .. } = posture;
        let links = tensions.len();
        let [x0, y0] = [&after.x[..links], &after.y[..links]];
        let [x1, y1] = [&before.x[1..=links], &before.y[1..=links]];
        let [fx, fy] = pushes.map(|push| &push[..links]);
        let [gx, gy] = pushes.map(|push| &push[1..=links]);
        for (i, tension) in tensions.iter_mut().enumerate() {
            let [dx, dy] = [x1[i] - x0[i], y1[i] - y0[i]];
            let pull = dx * (fx[i] + gx[i]) + dy * (fy[i] + gy[i]);
            *tension -= 0.5 * pull / (dx * dx + dy * dy).sqrt();
        }
    }
);
