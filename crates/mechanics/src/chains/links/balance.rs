//! Rigid links in equilibrium: the energy of their joints, and its derivatives.

use chaindrive_geometry::{Point, Vector};

use super::{Joining, Linkage};
use crate::End;
use crate::bodies::GroupBodies;
use crate::chains::links::Shapes;
use crate::chains::makeup::{Makeup, Statics};
use crate::joints::{Mate, add_joint};
use crate::seam::{Load, Moving, Sum, Unknown};

/// Depth at which joints are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;

impl Linkage {
    /// One side of a joint; supports stand where they were laid.
    fn side_moving(&self, q: &[f64], mate: Mate) -> Moving {
        match mate {
            Mate::Link { link, end } => self.pin_moving(q, link, end),
            Mate::Ground(end) => Moving::held(self.series.ends[end].place),
        }
    }
}

impl Statics for Linkage {
    /// All bodies; the ring of links is folded (0, N−1, 1, N−2, …) so that the Hessian becomes a band.
    fn unknowns(&self) -> Vec<Unknown> {
        let lever = 0.25 * self.series.pitch * self.series.pitch;
        let n = self.series.links;
        let folded = (0..n).map(|i| {
            if i.is_multiple_of(2) {
                i / 2
            } else {
                n - 1 - i / 2
            }
        });
        folded
            .chain(n..self.bodies.len())
            .flat_map(|body| {
                [(0, 1.0), (1, 1.0), (2, lever)].map(|(k, lever)| (3 * body + k, lever))
            })
            .map(|(entry, lever)| Unknown { entry, lever })
            .collect()
    }

    /// The circle that runs on the teeth: a free roller, or the end of the link that carries it.
    fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        let joint = roller % self.joints.len();
        let free = self.free_rollers.as_ref();
        match free.and_then(|free| free.body[joint]) {
            Some(body) => on_body(q, body, Vector::zeros()),
            None => self.side_moving(q, self.joints[joint].carrier),
        }
    }

    /// An end of a link.
    fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        on_body(q, link, self.bodies[link].arms[end])
    }

    /// Stiffness of the stiffest joint under a little load \[N/m\]; none where joints are ideal.
    fn stiffest_spring(&self) -> f64 {
        let joint = match &self.joining {
            Joining::Clearance(bearing) => bearing.stiffness(PRESSED),
            Joining::Hinges(_) => 0.0,
        };
        let free = self.free_rollers.as_ref();
        free.map_or(joint, |free| joint.max(free.bearing.stiffness(PRESSED)))
    }

    /// Adds E = Σ U(δ) − Σ m g·x − Σ F·x.
    fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>) {
        if let Joining::Clearance(bearing) = &self.joining {
            for joint in &self.joints {
                if let Some(sides) = joint.pair {
                    add_joint(bearing, sides.map(|side| self.side_moving(q, side)), sum);
                }
            }
        }
        if let Some(free) = &self.free_rollers {
            for (index, joint) in self.joints.iter().enumerate() {
                if free.body[index].is_some() {
                    let bush = self.side_moving(q, joint.carrier);
                    add_joint(&free.bearing, [self.roller_moving(q, index), bush], sum);
                }
            }
        }
        for (index, body) in self.bodies.iter().enumerate() {
            for axis in 0..2 {
                sum.force(3 * index + axis, -load.gravity * body.mass * gravity[axis]);
            }
        }
        for (index, held) in self.series.ends.iter().enumerate() {
            if let End::Pulled { force } = &held.end {
                let link = if index == 0 { 0 } else { self.series.links - 1 };
                let tip = self.pin_moving(q, link, index);
                sum.pull(&tip, force * -load.torque);
            }
        }
    }

    /// Ideal joints: hole and pin.
    fn each_hinge(&self, q: &[f64], mut visit: impl FnMut([Moving; 2])) {
        if matches!(self.joining, Joining::Clearance(_)) {
            return;
        }
        for sides in self.joints.iter().filter_map(|joint| joint.pair) {
            visit(sides.map(|side| self.side_moving(q, side)));
        }
    }

    /// Mass of all bodies, and of the heaviest \[kg\].
    fn weights(&self) -> [f64; 2] {
        let masses = self.bodies.iter().map(|body| body.mass);
        [masses.clone().sum(), masses.fold(0.0, f64::max)]
    }

    fn elongation(&self) -> f64 {
        self.elongation
    }

    /// Makes every link longer by `change` \[m\], between its joints.
    fn lengthen(&mut self, change: f64) {
        for body in &mut self.bodies[..self.series.links] {
            let along = (body.arms[1] - body.arms[0]).normalize();
            body.arms[0] -= along * (0.5 * change);
            body.arms[1] += along * (0.5 * change);
        }
        self.shapes = Shapes::of(&self.bodies, self.series.links, self.series.is_closed());
    }

    /// Largest force out of balance \[N\] that accelerates a body.
    fn imbalance(&self, a: &[f64]) -> f64 {
        let lever = 0.5 * self.series.pitch;
        let mut worst = 0.0_f64;
        for (body, a) in self.bodies.iter().zip(a.chunks_exact(3)) {
            worst = worst
                .max(body.mass * a[0].hypot(a[1]))
                .max(body.inertia * a[2].abs() / lever);
        }
        worst
    }

    /// Share of a step that moves no body farther than the clearance.
    fn reach(&self, step: &[f64]) -> f64 {
        let cap = match &self.joining {
            Joining::Clearance(bearing) if bearing.clearance > 0.0 => bearing.clearance.max(1e-6),
            // Without play there is no gap that a step could jump.
            Joining::Clearance(_) | Joining::Hinges(_) => 1e-4,
        };
        let lever = 0.5 * self.series.pitch;
        let mut farthest = 0.0_f64;
        for step in step.chunks_exact(3) {
            farthest = farthest
                .max(step[0].abs())
                .max(step[1].abs())
                .max(step[2].abs() * lever);
        }
        (cap / farthest).min(1.0)
    }

    /// Moves every body, and turns none.
    fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        for body in q[..self.coordinates()].chunks_exact_mut(3) {
            body[0] += shift();
            body[1] += shift();
        }
    }

    /// Whether pins have play in their bushes.
    fn has_play(&self) -> bool {
        matches!(self.joining, Joining::Clearance(_))
    }

    fn close_in_motion(&self, begin: f64, bodies: GroupBodies<'_>, q: &[f64], v: &mut [f64]) {
        self.close_velocities(begin, bodies, q, v);
    }
}

/// A point of a body, given in its own frame.
fn on_body(q: &[f64], body: usize, at: Vector) -> Moving {
    let first = 3 * body;
    let (s, c) = q[first + 2].sin_cos();
    let arm = Vector::new(c * at.x - s * at.y, s * at.x + c * at.y);
    Moving::on_body(Point::new(q[first], q[first + 1]), first, arm)
}
