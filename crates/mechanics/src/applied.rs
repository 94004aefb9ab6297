//! Forces of contacts and joints as accepted steps applied them.
//!
//! ```text
//! F(t) = (1 − s) F_a + s F_b,   s = (t − a)/(b − a),   a and b the ends of the step around t
//! ```
//!
//! The forces at the ends of steps moved the rollers. At an interpolated velocity the laws give others, several times as large where a
//! contact loses much, and nothing has felt them.

use serde::{Deserialize, Serialize};

/// Lists of forces: one for every channel of an observation that has such.
pub(crate) const LISTS: usize = 11;

/// Forces at the end of an accepted step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StepEnd {
    /// Time \[s\]; not a number before there is one.
    pub(crate) time: f64,
    pub(crate) lists: [Vec<f64>; LISTS],
}

impl Default for StepEnd {
    fn default() -> Self {
        Self {
            time: f64::NAN,
            lists: Default::default(),
        }
    }
}

/// The last two ends of steps, from some time on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct AppliedForces {
    ends: [StepEnd; 2],
    /// That time \[s\]: to read forces off takes as long as a good part of a step.
    from: f64,
}

impl Default for AppliedForces {
    fn default() -> Self {
        Self {
            ends: Default::default(),
            from: f64::INFINITY,
        }
    }
}

impl AppliedForces {
    /// Keeps the ends of steps from a time \[s\] on.
    pub(crate) fn keep_from(&mut self, from: f64) {
        self.from = from;
    }

    /// Whether forces at time t are kept.
    pub(crate) fn wants(&self, t: f64) -> bool {
        t >= self.from
    }

    /// Takes in another end of a step, in the room of the last but one; `read` fills its lists.
    pub(crate) fn push(&mut self, time: f64, read: impl FnOnce(&mut [Vec<f64>; LISTS])) {
        self.ends.swap(0, 1);
        let end = &mut self.ends[1];
        end.time = time;
        read(&mut end.lists);
    }

    /// Share of the last step at time t, and its two ends; none outside of it.
    pub(crate) fn around(&self, t: f64) -> Option<(f64, &[StepEnd; 2])> {
        let [before, now] = &self.ends;
        // A drive begins with one end alone.
        let from = if before.time.is_nan() {
            now.time
        } else {
            before.time
        };
        if !(from..=now.time).contains(&t) {
            return None;
        }
        let length = now.time - from;
        let share = if length > 0.0 {
            (t - from) / length
        } else {
            1.0
        };
        Some((share, &self.ends))
    }
}

/// (1 − s) F_a + s F_b; at the ends of the step they are these to the last bit.
pub(crate) fn blended(share: f64, before: &[f64], now: &[f64], out: &mut [f64]) {
    if share >= 1.0 {
        out.copy_from_slice(now);
        return;
    }
    for ((out, before), now) in out.iter_mut().zip(before).zip(now) {
        *out = (1.0 - share) * before + share * now;
    }
}
