//! Equilibrium downhill, for drives whose load path ends.
//!
//! A worn chain rides high on the flanks and there has folds: as weight or load grows, an equilibrium
//! ceases to exist, and rollers slide on until they find another one. Newton's iteration on the path stalls
//! there. What the drive does then is to move downhill, and so does this.

use super::{CONVERGED, Newton, StaticSolution};
use crate::seam::Load;

/// Longest step, as a share of the radius of a roller: well within the curvature of a seat.
const CAP: f64 = 3e-3;

/// Iterations before the search is given up; worn chains of 120 links took up to 4500, about a second.
const MOST: usize = 20_000;

/// Residual from which Newton's iteration finishes.
const NEAR: f64 = 1e-4;

impl Newton<'_> {
    /// Moves downhill from `start` into a minimum of the energy at one load.
    ///
    /// ```text
    /// (H + λ D) s = −∇E,   accepted while ΔE ≈ ½ (∇E + ∇E⁺)·s < 0
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
        let cap = CAP / 0.2 * self.longest();
        let mut shift = 1e-4 * stiffness;
        let mut q = start.to_vec();
        let mut balance = self.balance(&q, load);
        let mut iterations = 0;
        while iterations < MOST && self.residual(&q, &balance) > CONVERGED {
            iterations += 1;
            let Some(mut step) = self.step(&balance, &mut shift, stiffness) else {
                break;
            };
            let factor = self.share(&q, &step, cap);
            for s in &mut step {
                *s *= factor;
            }
            let mut tried = q.clone();
            self.go(&mut tried, &step, 1.0);
            let next = self.balance(&tried, load);
            // ΔE ≈ ½ (∇E + ∇E⁺)·s
            let change: f64 = step
                .iter()
                .zip(balance.gradient.iter().zip(&next.gradient))
                .map(|(s, (before, after))| 0.5 * s * (before + after))
                .sum();
            if change < 0.0 {
                (q, balance) = (tried, next);
                shift = (shift / 2.0).max(1e-12 * stiffness);
                if self.residual(&q, &balance) < NEAR {
                    let found = self.solve(&q, load, 60);
                    if found.residual < super::ACCEPTED {
                        return StaticSolution {
                            iterations: iterations + found.iterations,
                            ..found
                        };
                    }
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
