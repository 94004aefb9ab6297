//! Equilibrium downhill, for drives whose load path ends.
//!
//! A worn chain rides high on the flanks and there has folds: as weight or load grows, an equilibrium
//! ceases to exist, and rollers slide on until they find another one. Newton's iteration on the path stalls
//! there. What the drive does then is to move downhill, and so does this.

use super::{CONVERGED, Newton, StaticSolution};
use crate::seam::Load;

/// Longest step, as a part of that of Newton's method: well within the curvature of a seat.
const PART: f64 = 0.015;

/// Iterations before the search is given up, those of finishes in vain included; worn chains of 120 links took up to 4500, about a second.
const MOST: usize = 20_000;

/// Residual from which Newton's iteration finishes.
const NEAR: f64 = 1e-4;

impl Newton<'_> {
    /// Moves downhill from `start` into a minimum of the energy at one load.
    ///
    /// ```text
    /// (H + λ D) s = −∇E,   accepted while ΔE ≈ ½ (∇E + ∇E⁺)·(q⁺ − q) < 0
    /// ```
    ///
    /// λ falls with every step accepted and rises with every other: from steepest descent with short steps
    /// to Newton's method, in steps that a seat cannot be missed by.
    ///
    /// # Source
    /// J. Nocedal and S. J. Wright, *Numerical Optimization*, Springer, 2006, chapter 4 (the shift as the multiplier of a
    /// trust region).
    pub(super) fn descend(&mut self, start: &[f64], load: Load) -> StaticSolution {
        let stiffness = self.stiffest();
        let mut shift = 1e-4 * stiffness;
        let mut q = start.to_vec();
        let mut balance = self.balance(&q, load);
        let (mut iterations, mut in_vain) = (0, 0);
        while iterations + in_vain < MOST && self.residual(&q, &balance) > CONVERGED {
            iterations += 1;
            let Some(step) = self.step(&balance, &mut shift, stiffness) else {
                break;
            };
            let mut tried = q.clone();
            let share = self.share(&q, &step, PART);
            self.go(&mut tried, &step, share);
            let next = self.balance(&tried, load);
            // ΔE ≈ ½ (∇E + ∇E⁺)·(q⁺ − q)
            let rows = self.unknowns.row.iter().zip(q.iter().zip(&tried));
            let change: f64 = rows
                .filter_map(|(row, (before, after))| Some(((*row)?, after - before)))
                .map(|(row, moved)| 0.5 * moved * (balance.gradient[row] + next.gradient[row]))
                .sum();
            if change < 0.0 {
                (q, balance) = (tried, next);
                shift = (shift / 2.0).max(1e-12 * stiffness);
                if self.residual(&q, &balance) < NEAR {
                    let found = self.solve(&q, load, 60, CONVERGED);
                    if found.residual < super::ACCEPTED {
                        return StaticSolution {
                            iterations: iterations + found.iterations,
                            ..found
                        };
                    }
                    // Near a torque of high order, whose slope over the angle Newton's method does not know.
                    in_vain += found.iterations;
                }
            } else {
                shift *= 5.0;
                if shift > 1e3 * stiffness {
                    break;
                }
            }
        }
        StaticSolution {
            residual: self.residual(&q, &balance),
            q,
            iterations,
            tensions: balance.tensions,
            contacts: balance.contacts,
        }
    }
}
