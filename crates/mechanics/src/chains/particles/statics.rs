//! The particle chain in equilibrium: its forces and their derivatives.

use chaindrive_geometry::{Point, Vector};

use super::Particles;
use crate::End;
use crate::chains::makeup::Statics;
use crate::seam::{Load, Moving, Sum, Unknown};

impl Particles {
    /// Adds E = Σ U(ℓ) − Σ m g·x − Σ F·x for links whose tension T = U′ and stiffness k = U″ at a length `law` says \[N, N/m\].
    pub(in crate::chains) fn add_balance_of(
        &self,
        q: &[f64],
        gravity: Vector,
        load: Load,
        sum: &mut Sum<'_>,
        law: impl Fn(usize, f64) -> [f64; 2],
    ) {
        let n = self.series.stride;
        let place = |i: usize| -> Point { self.place(q, i) };
        for link in 0..self.links.count {
            let (a, b) = (link, (link + 1) % self.series.rollers);
            let d = place(b) - place(a);
            let length = d.norm();
            let u = d / length;
            let [tension, stiffness] = law(link, length);
            sum.balance.tensions.push(tension);
            // ∂ℓ/∂q of both ends
            let slope = [-u.x, -u.y, u.x, u.y];
            let entries = [a, n + a, b, n + b];
            for (entry, slope) in entries.into_iter().zip(slope) {
                sum.force(entry, tension * slope);
            }
            // K = k u uᵀ + (T/ℓ) (1 − u uᵀ)
            let across = tension / length;
            sum.stiffen_all(entries, |i, j| {
                let unit = match (i % 2 == j % 2, i == j) {
                    (false, _) => 0.0,
                    (true, same) => {
                        if same {
                            1.0
                        } else {
                            -1.0
                        }
                    }
                };
                (stiffness - across) * slope[i] * slope[j] + across * unit
            });
        }
        for i in 0..self.series.rollers {
            sum.force(i, -load.gravity * self.masses[i] * gravity.x);
            sum.force(n + i, -load.gravity * self.masses[i] * gravity.y);
        }
        for held in &self.series.ends {
            if let End::Pulled { force } = &held.end {
                sum.force(held.roller, -load.torque * force.x);
                sum.force(n + held.roller, -load.torque * force.y);
            }
        }
    }
}

impl Statics for Particles {
    /// Rollers that are not held; the ring is folded (0, N−1, 1, N−2, …) so that the Hessian becomes a band.
    fn unknowns(&self) -> Vec<Unknown> {
        let n = self.series.rollers;
        let folded = (0..n.div_ceil(2)).flat_map(|i| [i, n - 1 - i]);
        let mut seen = vec![false; n];
        let mut unknowns = Vec::new();
        for roller in folded {
            let new = !std::mem::replace(&mut seen[roller], true);
            if new && self.inverse_masses[roller] > 0.0 {
                for entry in [roller, self.series.stride + roller] {
                    unknowns.push(Unknown { entry, lever: 1.0 });
                }
            }
        }
        unknowns
    }

    /// A roller; the one after the last of a closed chain is the first.
    fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        let roller = roller % self.series.rollers;
        Moving::free(self.place(q, roller), [roller, self.series.stride + roller])
    }

    /// A pin, which is a roller here.
    fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        self.roller_moving(q, link + end)
    }

    /// Stiffness of the stiffest link \[N/m\].
    fn stiffest_spring(&self) -> f64 {
        self.links.stiffness.iter().copied().fold(0.0, f64::max)
    }

    /// Mass of all rollers, and of the heaviest \[kg\].
    fn weights(&self) -> [f64; 2] {
        let masses = &self.masses[..self.series.rollers];
        [
            masses.iter().sum(),
            masses.iter().copied().fold(0.0, f64::max),
        ]
    }

    /// Adds E = Σ ½ k (ℓ − p)² − Σ m g·x − Σ F·x.
    fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>) {
        let law = |link: usize, length: f64| {
            let stiffness = self.links.stiffness[link];
            [stiffness * (length - self.links.rest[link]), stiffness]
        };
        self.add_balance_of(q, gravity, load, sum, law);
    }

    /// Makes every link longer by `change` \[m\].
    fn lengthen(&mut self, change: f64) {
        for rest in &mut self.links.rest[..self.links.count] {
            *rest += change;
        }
    }

    /// Largest force out of balance \[N\] that accelerates a roller.
    fn imbalance(&self, a: &[f64]) -> f64 {
        let rollers = 0..self.series.rollers;
        let forces = rollers.map(|i| self.masses[i] * a[i].hypot(a[self.series.stride + i]));
        forces.fold(0.0, f64::max)
    }

    /// Share of a step that moves no roller farther than a hundredth of a pitch.
    fn reach(&self, step: &[f64]) -> f64 {
        let farthest = step.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        (0.01 * self.series.pitch / farthest).min(1.0)
    }

    fn elongation(&self) -> f64 {
        let rest: f64 = self.links.rest[..self.links.count].iter().sum();
        let nominal = self.links.count as f64 * self.series.pitch;
        rest / nominal
    }

    /// Moves every roller that is not held; copies after the last one follow.
    fn nudge(&self, q: &mut [f64], mut shift: impl FnMut() -> f64) {
        let n = self.series.stride;
        for i in 0..self.series.rollers {
            let (x, y) = (shift(), shift());
            if self.inverse_masses[i] > 0.0 {
                q[i] += x;
                q[n + i] += y;
            }
        }
        self.copy_ghosts(q);
    }

    /// Gives the copies after the last roller of a closed chain the values of their originals.
    fn copy_ghosts(&self, values: &mut [f64]) {
        if self.links.closed {
            let n = self.series.stride;
            for ghost in self.series.rollers..n {
                values[ghost] = values[ghost % self.series.rollers];
                values[n + ghost] = values[n + ghost % self.series.rollers];
            }
        }
    }
}
