//! The same drive, ever so slightly elsewhere: the start of a twin run.

use crate::{Assembled, System};

/// Fractional part of the golden ratio: its multiples never repeat and never cluster.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Assembled {
    /// The start of a twin run: every roller, or link and free roller, is moved by up to `by` \[m\] along x and y.
    ///
    /// ```text
    /// δᵢ = by · 2 (frac(i φ) − ½),   φ = (√5 − 1)/2,   i = 1, 2, … over the coordinates
    /// ```
    ///
    /// The pattern is always the same. Held ends, directions of links, wheels and tensioners stay; of particle chains the
    /// copies after the last roller move with their originals. A distance of 1e-12 m is far above
    /// the rounding of coordinates of a metre and far below everything that can be measured.
    #[must_use]
    pub fn nudged(&self, by: f64) -> Self {
        let mut twin = self.clone();
        twin.system.nudge(&mut twin.q, by);
        twin
    }
}

impl System {
    fn nudge(&self, q: &mut [f64], by: f64) {
        let mut count = 0.0;
        let mut shift = || {
            count += 1.0;
            by * 2.0 * ((count * GOLDEN).fract() - 0.5)
        };
        for member in &self.chains {
            member
                .chain
                .nudge(&mut q[member.entries.clone()], &mut shift);
        }
    }
}
