//! Length of the next step: by stability, by error, and by the verdict of the system.

use serde::{Deserialize, Serialize};

use crate::state::State;
use crate::tolerance::Tolerance;

/// Least step, in units of the nominal one, that a verdict can bring about.
pub(crate) const FLOOR: f64 = 1e-3;

/// By how much a fixed step is shortened at a time: 2^(−1/5). Coarser rungs leave more of the limit unused, finer ones change the step
/// more often.
const RUNG: f64 = 0.870_550_563_296_124_1;

/// Longest step, in units of the limit, that one beyond the limit is shortened to: near the limit it is stable, not accurate. Assumed; shortened
/// to the limit itself, a bare chain on two sprockets has the first percentile of its tension 6 % too low.
const ROOM: f64 = 0.75;

/// Rungs of a fixed step after which a run is given up: a millionth of the nominal step.
const MOST_RUNGS: u32 = 100;

/// Step after a verdict to retry a candidate of size h \[s\] for the n-th time, n = 0, 1, ….
///
/// ```text
/// h ← max(floor, min(estimate, 0.9 h)),   from the third retry on min(estimate, ½ h)
/// ```
///
/// Estimates of the time to contact can stop just short of it for ever; the floor makes such a step end.
pub(crate) fn shortened(h: f64, at_most: f64, n: u32, floor: f64) -> f64 {
    let share = if n < 2 { 0.9 } else { 0.5 };
    let estimate = if at_most > 0.0 { at_most } else { 0.0 };
    estimate.min(share * h).max(floor)
}

/// A fixed step, shortened while stability asks for it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Fixed {
    /// The step asked for \[s\].
    pub(crate) nominal: f64,
    /// By how many rungs it is shortened at present, and the step that is left \[s\].
    rungs: u32,
    step: f64,
}

impl Fixed {
    pub(crate) fn new(nominal: f64) -> Self {
        Self {
            nominal,
            rungs: 0,
            step: nominal,
        }
    }

    /// Step in use \[s\].
    pub(crate) fn step(self) -> f64 {
        self.step
    }

    /// Adapts to the limit \[s\] of the present state; returns whether the step is shorter for it, or nothing if it vanishes.
    pub(crate) fn adapt(&mut self, limit: f64) -> Option<bool> {
        let before = self.rungs;
        if self.step <= limit && before == 0 {
            return Some(false);
        }
        self.rungs = 0;
        self.step = self.nominal;
        if self.step <= limit {
            return Some(false);
        }
        while limit.is_nan() || self.step > ROOM * limit {
            self.rungs += 1;
            self.step *= RUNG;
            if self.rungs > MOST_RUNGS {
                return None;
            }
        }
        Some(self.rungs > before)
    }
}

/// Proportional and integral control of the step by the error.
///
/// ```text
/// h ← h clamp(0.9 ε^(−0.7/p) ε₋^(0.4/p), 0.2, 5)
/// ```
///
/// ε and ε₋ are the errors of this and the last accepted step in units of the tolerance, p the order.
///
/// # Source
/// E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*, Springer, 1996, section IV.2.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Controller {
    pub(crate) tolerance: Tolerance,
    pub(crate) max_step: f64,
    /// Step to try next \[s\].
    pub(crate) proposal: f64,
    order: f64,
    last_error: f64,
    after_rejection: bool,
}

impl Controller {
    pub(crate) fn new(tolerance: Tolerance, max_step: f64, first: f64, order: u32) -> Self {
        Self {
            tolerance,
            max_step,
            proposal: first,
            order: f64::from(order),
            last_error: 1.0,
            after_rejection: false,
        }
    }

    /// Takes note of an accepted step h \[s\] and its error, and proposes the next.
    ///
    /// A step the system cut short says nothing against the proposal it came from, which is kept.
    pub(crate) fn accepted(&mut self, h: f64, error: f64, cut_short: bool) {
        let error = error.max(1e-10);
        // h ← h clamp(0.9 ε^(−0.7/p) ε₋^(0.4/p), 0.2, 5)
        let growth = 0.9 * error.powf(-0.7 / self.order) * self.last_error.powf(0.4 / self.order);
        let most = if self.after_rejection { 1.0 } else { 5.0 };
        let next = h * growth.clamp(0.2, most);
        let kept = if cut_short { self.proposal } else { 0.0 };
        self.proposal = next.max(kept).min(self.max_step);
        self.last_error = error.max(1e-4);
        self.after_rejection = false;
    }

    /// Takes note of a step h \[s\] whose error was too large, and proposes a shorter one.
    pub(crate) fn rejected(&mut self, h: f64, error: f64) -> f64 {
        self.proposal = h * (0.9 * error.powf(-1.0 / self.order)).clamp(0.1, 0.9);
        self.after_rejection = true;
        self.proposal
    }

    /// Forgets the last error, which belongs to forces before a jump.
    pub(crate) fn jumped(&mut self) {
        self.last_error = 1.0;
    }
}

/// First step \[s\] from a state and its rates alone.
///
/// ```text
/// h = 1 % of the time in which the state would change by itself, measured in tolerances
/// ```
///
/// Between a ten-thousandth of the longest step and the longest step itself: too short costs a few
/// steps, too long a few rejections.
pub(crate) fn first_step(tolerance: Tolerance, longest: f64, state: &State) -> f64 {
    let State { q, v, a, z, .. } = state;
    let (mut size, mut rate): (f64, f64) = (1.0, 0.0);
    for i in 0..q.len() {
        size = size
            .max(tolerance.position(q[i], q[i], q[i]))
            .max(tolerance.velocity(v[i], v[i], v[i]));
        rate = rate
            .max(tolerance.position(v[i], q[i], q[i]))
            .max(tolerance.velocity(a[i], v[i], v[i]));
    }
    for (z, flow) in z.iter().zip(state.flow()) {
        size = size.max(tolerance.position(*z, *z, *z));
        rate = rate.max(tolerance.position(*flow, *z, *z));
    }
    // Without a rate the quotient is infinite, and the longest step is taken.
    (0.01 * size / rate).clamp(1e-4 * longest, longest)
}
