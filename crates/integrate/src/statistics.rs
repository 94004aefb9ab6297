//! Cost of a run.

use serde::{Deserialize, Serialize};

/// Counts of a run so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u64,
    /// Candidates the system sent back.
    pub rejections: u64,
    /// Candidates the error control sent back.
    pub error_rejections: u64,
    /// Evaluations of the accelerations, that of the initial state included.
    pub evaluations: u64,
    /// Linear equations solved by implicit methods.
    pub solves: u64,
    /// Candidates given up because they could not be solved for.
    pub newton_failures: u64,
    /// Commits that called for a fresh evaluation.
    pub jumps: u64,
    /// Times that a fixed step was shortened for the sake of stability.
    pub reductions: u64,
    /// Smallest accepted step \[s\]; infinite before the first.
    pub smallest_step: f64,
    /// Largest accepted step \[s\].
    pub largest_step: f64,
}

impl Default for Statistics {
    fn default() -> Self {
        Self {
            steps: 0,
            rejections: 0,
            error_rejections: 0,
            evaluations: 0,
            solves: 0,
            newton_failures: 0,
            jumps: 0,
            reductions: 0,
            smallest_step: f64::INFINITY,
            largest_step: 0.0,
        }
    }
}

impl Statistics {
    /// Candidates sent back or given up, whatever the reason.
    pub fn rejected(&self) -> u64 {
        self.rejections + self.error_rejections + self.newton_failures
    }

    /// Counts an accepted step of size h \[s\].
    pub(crate) fn accept(&mut self, h: f64) {
        self.steps += 1;
        self.smallest_step = self.smallest_step.min(h);
        self.largest_step = self.largest_step.max(h);
    }
}
