//! Answers of rigid links to the questions of every chain.

use chaindrive_integrate::Moment;

use super::{Joining, Linkage, Memory, Shapes};
use crate::chains::Record;
use crate::lanes::padded;
use crate::seam::Pose;
use crate::{End, MemoryError, Motion};

impl Linkage {
    /// Coordinates of the chain.
    pub(crate) fn coordinates(&self) -> usize {
        3 * self.bodies.len()
    }

    pub(crate) fn free_coordinates(&self) -> usize {
        self.coordinates()
    }

    pub(crate) fn name(&self, coordinate: usize) -> String {
        let body = coordinate / 3;
        let axis = ["x", "y", "its angle"][coordinate % 3];
        if body < self.links {
            format!("link {body} along {axis}")
        } else {
            format!("free roller {} along {axis}", body - self.links)
        }
    }

    pub(crate) fn inertias(&self) -> Vec<f64> {
        let bodies = self.bodies.iter();
        bodies
            .flat_map(|body| [body.mass, body.mass, body.inertia])
            .collect()
    }

    pub(crate) fn rollers(&self) -> usize {
        self.joints.len()
    }

    pub(crate) fn links(&self) -> usize {
        self.links
    }

    pub(crate) fn joints(&self) -> usize {
        self.joints.len()
    }

    pub(crate) fn pitch(&self) -> f64 {
        self.pitch
    }

    pub(crate) fn elongation(&self) -> f64 {
        self.elongation
    }

    pub(crate) fn pose<'a>(&self, at: Moment<'a>, record: &'a mut Record) -> Pose<'a> {
        let posture = &mut record.joint_state.posture;
        self.pose_links(at, posture);
        Pose {
            x: &posture.x,
            y: &posture.y,
            vx: &posture.vx,
            vy: &posture.vy,
        }
    }

    pub(crate) fn commit(&mut self, _t: f64, _q: &mut [f64], _v: &mut [f64], record: &mut Record) {
        std::mem::swap(&mut self.memory, &mut record.joint_state.memory);
        if let Some(joints) = &mut self.resisting {
            joints.commit(&mut record.resistance);
        }
    }

    /// Goes on from what the joints remembered.
    pub(crate) fn remember(&mut self, memory: Memory) -> Result<(), MemoryError> {
        if self.has_play() {
            memory.joints.check(padded(self.joints.len()))?;
        }
        if self.free_rollers.is_some() {
            memory.bushes.check(self.joints.len())?;
        }
        self.memory = memory;
        Ok(())
    }

    /// Moves every body, and turns none.
    pub(crate) fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        for body in q[..self.coordinates()].chunks_exact_mut(3) {
            body[0] += shift();
            body[1] += shift();
        }
    }

    /// Lets driven ends stand still.
    pub(crate) fn hold_still(&mut self) {
        for held in &mut self.ends {
            if let End::Driven { x, y } = &mut held.end {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
    }

    /// Makes every link longer by `change` \[m\], between its joints.
    pub(crate) fn lengthen(&mut self, change: f64) {
        for body in &mut self.bodies[..self.links] {
            let along = (body.arms[1] - body.arms[0]).normalize();
            body.arms[0] -= along * (0.5 * change);
            body.arms[1] += along * (0.5 * change);
        }
        self.shapes = Shapes::of(&self.bodies, self.links, self.closed);
    }

    /// Largest force out of balance \[N\] that accelerates a body.
    pub(crate) fn imbalance(&self, a: &[f64]) -> f64 {
        let lever = 0.5 * self.pitch;
        let mut worst = 0.0_f64;
        for (body, a) in self.bodies.iter().zip(a.chunks_exact(3)) {
            worst = worst
                .max(body.mass * a[0].hypot(a[1]))
                .max(body.inertia * a[2].abs() / lever);
        }
        worst
    }

    /// Whether pins have play in their bushes.
    pub(crate) fn has_play(&self) -> bool {
        matches!(self.joining, Joining::Clearance(_))
    }

    /// Largest force of a contact \[N\].
    pub(crate) fn pressed(&self, _at: Moment<'_>, record: &Record) -> f64 {
        let mut pressed = 0.0_f64;
        self.each_element(&record.joint_state, |element| {
            pressed = pressed.max(element.force);
        });
        pressed
    }

    /// Share of a step that moves no body farther than the clearance.
    pub(crate) fn reach(&self, step: &[f64]) -> f64 {
        let cap = match &self.joining {
            Joining::Clearance(bearing) if bearing.clearance > 0.0 => bearing.clearance.max(1e-6),
            // Without play there is no gap that a step could jump.
            Joining::Clearance(_) | Joining::Hinges(_) => 1e-4,
        };
        let lever = 0.5 * self.pitch;
        let mut farthest = 0.0_f64;
        for step in step.chunks_exact(3) {
            farthest = farthest
                .max(step[0].abs())
                .max(step[1].abs())
                .max(step[2].abs() * lever);
        }
        (cap / farthest).min(1.0)
    }

    /// Mass of all bodies, and of the heaviest \[kg\].
    pub(crate) fn weights(&self) -> [f64; 2] {
        let masses = self.bodies.iter().map(|body| body.mass);
        [masses.clone().sum(), masses.fold(0.0, f64::max)]
    }
}
