//! Forces of contacts and joints as accepted steps applied them.
//!
//! ```text
//! F(t) = (1 − s) F_a + s F_b,   s = (t − a)/(b − a),   a and b the ends of the step around t
//! ```
//!
//! What moved the rollers are the forces at the ends of steps. A law that is asked again in between, at a velocity that is
//! interpolated, gives others: where a contact loses much they are several times as large, and nothing has felt them.

use serde::{Deserialize, Serialize};

/// Lists of forces: one for every channel of an observation that has such.
pub(crate) const LISTS: usize = 11;

/// Forces at the end of an accepted step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Applied {
    /// Time \[s\]; not a number before there is one.
    pub(crate) time: f64,
    pub(crate) lists: [Vec<f64>; LISTS],
}

impl Default for Applied {
    fn default() -> Self {
        Self {
            time: f64::NAN,
            lists: Default::default(),
        }
    }
}

/// The last two ends of steps that somebody wants to see.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Ends {
    ends: [Applied; 2],
    /// Time \[s\] from which on ends are kept: to read them off takes as long as a good part of a step.
    from: f64,
}

impl Default for Ends {
    fn default() -> Self {
        Self {
            ends: Default::default(),
            from: f64::INFINITY,
        }
    }
}

impl Ends {
    /// Keeps the ends of steps from a time \[s\] on.
    pub(crate) fn keep_from(&mut self, from: f64) {
        self.from = from;
    }

    /// Whether the end of a step at a time is to be kept.
    pub(crate) fn wants(&self, t: f64) -> bool {
        t >= self.from
    }

    /// Lists for another end, with what stands in them; they come back by [`push`](Self::push).
    pub(crate) fn next(&mut self) -> Applied {
        self.ends.swap(0, 1);
        std::mem::take(&mut self.ends[1])
    }

    pub(crate) fn push(&mut self, end: Applied) {
        self.ends[1] = end;
    }

    /// Share of the last step after which it is t, and its two ends; none where that is not within it.
    pub(crate) fn around(&self, t: f64) -> Option<(f64, &[Applied; 2])> {
        let [before, now] = &self.ends;
        let share = if (now.time..=now.time).contains(&t) {
            1.0
        } else if before.time <= t && t < now.time {
            (t - before.time) / (now.time - before.time)
        } else {
            return None;
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
