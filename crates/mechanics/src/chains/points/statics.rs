//! A chain of points in equilibrium: its forces and their derivatives.

use chaindrive_geometry::Vector;
use nalgebra::Matrix2;

use super::{AFTER, BEFORE, Points, ROLLERS};
use crate::chains::makeup::{Makeup, Statics};
use crate::joints::add_joint;
use crate::seam::{Load, Moving, Sum, Unknown};

/// Depth at which joints are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;

impl Points {
    fn moving(&self, q: &[f64], block: usize, joint: usize) -> Moving {
        let joint = joint % self.series.rollers;
        Moving::free(self.point(q, block, joint), self.entries(block, joint))
    }
}

impl Statics for Points {
    /// All points; the ring is folded (0, N−1, 1, N−2, …) so that the Hessian becomes a band.
    fn unknowns(&self) -> Vec<Unknown> {
        let n = self.series.rollers;
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

    fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        self.moving(q, ROLLERS, roller)
    }

    /// An end of a link.
    fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        self.moving(q, [AFTER, BEFORE][end], link + end)
    }

    /// Stiffness of the stiffest link or joint \[N/m\].
    fn stiffest_spring(&self) -> f64 {
        let links = self.links.stiffness.iter().copied().fold(0.0, f64::max);
        links
            .max(self.pin.stiffness(PRESSED))
            .max(self.bush.stiffness(PRESSED))
    }

    /// Mass of all points, and of the heaviest joint \[kg\].
    fn weights(&self) -> [f64; 2] {
        let joint = |i: usize| self.masses.iter().map(|masses| masses[i]).sum::<f64>();
        let joints = (0..self.series.rollers).map(joint);
        [joints.clone().sum(), joints.fold(0.0, f64::max)]
    }

    /// Adds E = Σ ½ k (ℓ − p)² + Σ U(δ) − Σ m g·x.
    fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>) {
        for link in 0..self.series.rollers {
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
        for joint in 0..self.series.rollers {
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
    fn lengthen(&mut self, change: f64) {
        for rest in &mut self.links.rest[..self.links.count] {
            *rest += change;
        }
    }

    /// Largest force out of balance \[N\] that accelerates a point.
    fn imbalance(&self, a: &[f64]) -> f64 {
        let points =
            (0..self.series.rollers).flat_map(|i| [ROLLERS, BEFORE, AFTER].map(|b| (b, i)));
        let forces = points.map(|(b, i)| self.masses[b][i] * self.point(a, b, i).coords.norm());
        forces.fold(0.0, f64::max)
    }

    /// Share of a step that moves no point farther than the play of its joint.
    fn reach(&self, step: &[f64]) -> f64 {
        let farthest = step.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        (self.pin.clearance.max(1e-6) / farthest).min(1.0)
    }

    /// Length of the chain without load, from roller to roller, in nominal pitches a link.
    fn elongation(&self) -> f64 {
        let rest: f64 = self.links.rest[..self.links.count].iter().sum();
        // Every joint adds the play of its pin.
        rest / (self.links.count as f64 * self.series.pitch)
            + self.pin.clearance / self.series.pitch
    }

    /// Moves the three points of every joint by the same.
    fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        for i in 0..self.series.rollers {
            let shift = [shift(), shift()];
            for block in [ROLLERS, BEFORE, AFTER] {
                for (entry, shift) in self.entries(block, i).into_iter().zip(shift) {
                    q[entry] += shift;
                }
            }
        }
        self.copy_ghosts(q);
    }

    /// Gives the copies after the last joint the values of their originals.
    fn copy_ghosts(&self, values: &mut [f64]) {
        for block in values[..self.coordinates()].chunks_exact_mut(self.series.stride) {
            // A copy after the first turn is one of the turn before.
            for ghost in self.series.rollers..block.len() {
                block[ghost] = block[ghost - self.series.rollers];
            }
        }
    }
}
