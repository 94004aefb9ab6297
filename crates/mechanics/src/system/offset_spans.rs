//! Spans that run out of line, and which joints they press sideways.
//!
//! ```text
//! m = μ_s h tan γ,   tan γ = max(0, |Δy| − play)/L        M = m N on a joint of the span, see `LateralRub`
//! ```

use crate::bodies::WheelContacts;
use crate::contact::Run;
use crate::drive::{Parts, PlacedChain};

/// Spans out of line of a chain.
#[derive(Clone, Debug)]
pub(crate) struct OffsetSpans {
    /// Friction of plates over the normal force in the span after every sprocket of the route, m \[m\].
    after: Vec<f64>,
    /// Rollers in the middle of their arcs, and where in the route their sprockets stand; in the order of the rollers.
    middles: Vec<(usize, usize)>,
}

impl OffsetSpans {
    /// Those of a chain as it is laid; none where it runs in line, or costs nothing.
    pub(super) fn new(parts: &Parts, placed: &PlacedChain, route: &[usize]) -> Option<Self> {
        let rub = placed.chain.articulation?.lateral?;
        let spans = parts.alignments(route).into_iter();
        let after = spans.map(|span| rub.coefficient * rub.lever * span.slope(rub.play));
        let after: Vec<f64> = after.collect();
        after.iter().any(|m| *m > 0.0).then(|| Self {
            middles: Vec::with_capacity(after.len()),
            after,
        })
    }

    /// Looks where the sprockets of a route have their rollers.
    pub(super) fn look(&mut self, route: &[usize], teeth: &[WheelContacts], rollers: usize) {
        self.middles.clear();
        for (at, sprocket) in route.iter().enumerate() {
            let on = teeth.iter().find(|on| on.wheel == *sprocket);
            let middle = on.and_then(|on| middle(on.contacts.runs(), rollers));
            self.middles.extend(middle.map(|middle| (middle, at)));
        }
        self.middles.sort_unstable();
    }

    /// Friction of plates over the normal force at a joint \[m\].
    ///
    /// From the middle of one arc to that of the next all joints are those of the span between: it is at its ends that they turn.
    pub(super) fn at(&self, joint: usize, closed: bool) -> f64 {
        let count = self.middles.len();
        let next = self.middles.partition_point(|(middle, _)| *middle <= joint);
        if count < 2 || !closed && (next == 0 || next == count) {
            return 0.0;
        }
        let [(_, from), (_, to)] =
            [(next + count - 1) % count, next % count].map(|i| self.middles[i]);
        let around = self.after.len();
        if to == (from + 1) % around {
            self.after[from]
        } else if from == (to + 1) % around {
            self.after[to]
        } else {
            0.0
        }
    }
}

/// The roller in the middle of the longest row of runs, in a chain of so many rollers that may be closed.
fn middle(runs: &[Run], rollers: usize) -> Option<usize> {
    let end = |run: &Run| (run.start + run.count) % rollers;
    let before = |i: usize| &runs[(i + runs.len() - 1) % runs.len()];
    let rows = (0..runs.len()).map(|first| {
        let row = (0..runs.len()).map(|step| (first + step) % runs.len());
        let row = row.take_while(|&i| i == first || end(before(i)) == runs[i].start);
        (row.map(|i| runs[i].count).sum::<usize>(), runs[first].start)
    });
    let (count, start) = rows.max_by_key(|(count, _)| *count)?;
    Some((start + count / 2) % rollers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_arc_is_found_across_the_closing_of_the_chain() {
        let run = |start, count| Run { start, count };
        assert_eq!(middle(&[], 60), None);
        assert_eq!(middle(&[run(10, 8), run(18, 3)], 60), Some(15));
        assert_eq!(middle(&[run(0, 5), run(30, 2), run(53, 7)], 60), Some(59));
        assert_eq!(middle(&[run(20, 1), run(40, 8), run(48, 8)], 60), Some(48));
    }

    #[test]
    fn joints_belong_to_the_span_between_the_arcs_around_them() {
        let sideways = OffsetSpans {
            after: vec![0.1, 0.2, 0.3],
            middles: vec![(4, 1), (20, 2), (50, 0)],
        };
        let closed = [2, 4, 19, 20, 49, 50, 59].map(|joint| sideways.at(joint, true));
        let bits = |values: &[f64]| values.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&closed), bits(&[0.1, 0.2, 0.2, 0.3, 0.3, 0.1, 0.1]));
        let open = [2, 4, 49, 50].map(|joint| sideways.at(joint, false));
        assert_eq!(bits(&open), bits(&[0.0, 0.2, 0.3, 0.0]));
    }
}
