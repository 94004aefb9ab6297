//! A chain of points in equilibrium: its forces and their derivatives.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;
use nalgebra::Matrix2;

use super::{AFTER, BEFORE, Points, ROLLERS};
use crate::chains::Record;
use crate::joints::add_joint;
use crate::seam::{Load, Moving, Sum, Unknown};

/// Depth at which joints are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;

impl Points {
    /// All points; the ring is folded (0, N−1, 1, N−2, …) so that the Hessian becomes a band.
    pub(in crate::chains) fn unknowns(&self) -> Vec<Unknown> {
        let n = self.rollers;
        let folded = (0..n).map(|i| {
            if i.is_multiple_of(2) {
                i / 2
            } else {
                n - 1 - i / 2
            }
        });
        folded
            .flat_map(|joint| [BEFORE, ROLLERS, AFTER].map(|block| self.entries(block, joint)))
            .flatten()
            .map(|entry| Unknown { entry, lever: 1.0 })
            .collect()
    }

    fn moving(&self, q: &[f64], block: usize, joint: usize) -> Moving {
        let joint = joint % self.rollers;
        Moving::free(self.point(q, block, joint), self.entries(block, joint))
    }

    pub(in crate::chains) fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        self.moving(q, ROLLERS, roller)
    }

    /// An end of a link.
    pub(in crate::chains) fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        self.moving(q, [AFTER, BEFORE][end], link + end)
    }

    /// Stiffness of the stiffest link or joint \[N/m\].
    pub(in crate::chains) fn stiffest_spring(&self) -> f64 {
        let links = self.links.stiffness.iter().copied().fold(0.0, f64::max);
        links
            .max(self.pin.stiffness(PRESSED))
            .max(self.bush.stiffness(PRESSED))
    }

    /// Mass of all points, and of the heaviest joint \[kg\].
    pub(in crate::chains) fn weights(&self) -> [f64; 2] {
        let joint = |i: usize| self.masses.iter().map(|masses| masses[i]).sum::<f64>();
        let joints = (0..self.rollers).map(joint);
        [joints.clone().sum(), joints.fold(0.0, f64::max)]
    }

    /// Adds E = Σ ½ k (ℓ − p)² + Σ U(δ) − Σ m g·x.
    pub(in crate::chains) fn add_balance(
        &self,
        q: &[f64],
        gravity: Vector,
        load: Load,
        sum: &mut Sum<'_>,
    ) {
        for link in 0..self.rollers {
            let ends = [0, 1].map(|end| self.pin_moving(q, link, end));
            let d = ends[1].place - ends[0].place;
            let (length, u) = (d.norm(), d.normalize());
            let stiffness = self.links.stiffness[link];
            let tension = stiffness * (length - self.links.rest[link]);
            sum.balance.tensions.push(tension);
            // K = k u uᵀ + (T/ℓ) (1 − u uᵀ)
            let along = u * u.transpose();
            let matrix = along * stiffness + (Matrix2::identity() - along) * (tension / length);
            sum.stretch([&ends[0], &ends[1]], u * tension, &matrix);
        }
        for joint in 0..self.rollers {
            let [bush, pin] = self.sides(joint).map(|block| self.moving(q, block, joint));
            add_joint(&self.pin, [bush, pin], sum);
            add_joint(&self.bush, [self.roller_moving(q, joint), bush], sum);
            for block in [ROLLERS, BEFORE, AFTER] {
                let mass = self.masses[block][joint];
                for (axis, entry) in self.entries(block, joint).into_iter().enumerate() {
                    sum.force(entry, -load.gravity * mass * gravity[axis]);
                }
            }
        }
    }

    /// Makes every link longer by `change` \[m\].
    pub(in crate::chains) fn lengthen(&mut self, change: f64) {
        for rest in &mut self.links.rest[..self.links.count] {
            *rest += change;
        }
    }

    /// Nothing holds a closed chain.
    #[expect(clippy::unused_self, reason = "every chain is asked")]
    pub(in crate::chains) fn hold_still(&mut self) {}

    /// Largest force out of balance \[N\] that accelerates a point.
    pub(in crate::chains) fn imbalance(&self, a: &[f64]) -> f64 {
        let points = (0..self.rollers).flat_map(|i| [ROLLERS, BEFORE, AFTER].map(|b| (b, i)));
        let forces = points.map(|(b, i)| self.masses[b][i] * self.point(a, b, i).coords.norm());
        forces.fold(0.0, f64::max)
    }

    /// Largest tension of a link \[N\].
    pub(in crate::chains) fn pressed(&self, at: Moment<'_>, record: &Record) -> f64 {
        let tensions = self.tensions(at, record);
        tensions.iter().fold(0.0, |m, t| f64::max(m, t.abs()))
    }

    /// Share of a step that moves no point farther than the play of its joint.
    pub(in crate::chains) fn reach(&self, step: &[f64]) -> f64 {
        let farthest = step.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        (self.pin.clearance.max(1e-6) / farthest).min(1.0)
    }
}
