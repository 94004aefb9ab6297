//! The methods and steps among which the automatic choice chooses.

use chaindrive_mechanics::Assembled;

use super::trace::Trace;
use crate::{Run, Stepping};

/// A method with a step, and how the step compares with others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) stepping: Stepping,
    /// Step over the time scale that limits the method.
    pub(super) factor: f64,
    /// Step \[s\].
    pub(super) step: f64,
    /// Deepest first penetration \[m\], where steps are rejected for it.
    pub(super) onset_depth: Option<f64>,
}

/// A candidate and the sharper one it is compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) candidate: Candidate,
    pub(super) judge: Candidate,
}

/// Longest step of the ladder in units of the time scale that limits the method. A run may have 1.8 of it: a sixth is left for contacts
/// that stiffen as they are pressed, and beyond that the run shortens its step.
const LONGEST: f64 = 1.5;
/// Steps of the ladder.
const RUNGS: usize = 26;
/// Ratio of a step of the ladder to the next: 2^⅕.
const RATIO: f64 = 1.148_698_354_997_035;
/// Error over accuracy below which implicit damping is taken to be of first order. *Assumed*.
const NEAR: f64 = 4.0;
/// Rungs from a candidate down to its judge, whose step is half as long, to the last bit: an estimate of the run goes on with it.
const TO_JUDGE: usize = 5;
/// Runge–Kutta steps in units of 1/ω of the stiffest mode, with the depth \[m\] beyond which a first penetration is approached
/// again; each is compared with the next, which has to have a shorter step: a shallower onset alone would show
/// the error of the onset only.
const RK4: [(f64, f64); 4] = [(0.5, 1e-5), (0.25, 1e-6), (0.125, 1e-7), (0.0625, 1e-8)];

/// Candidates that suit a drive, from the cheapest to the dearest: a ladder of steps of one method, then others.
///
/// Particles: Verlet, then Runge–Kutta with rejection. Rigid links: implicit damping, whose error
/// falls to 0.01 % before explicit methods, which have to follow the damping, become cheaper.
///
/// The first [`RUNGS`] are the ladder.
pub(super) struct Candidates(Vec<Entry>);

impl Candidates {
    pub(super) fn of(start: &Assembled) -> Self {
        let system = &start.system;
        let of = |stepping: Stepping, factor: f64, onset_depth: Option<f64>| Candidate {
            stepping,
            factor,
            step: factor * stepping.time_scale(system),
            onset_depth,
        };
        let stepping = Stepping::Auto.suited(system);
        let rungs = (0..RUNGS + TO_JUDGE).map(|place| of(stepping, rung(place), None));
        let rungs: Vec<Candidate> = rungs.collect();
        let pairs_of = rungs.iter().zip(&rungs[TO_JUDGE..]);
        let ladder = pairs_of.map(|(&candidate, &judge)| Entry { candidate, judge });
        let mut entries: Vec<Entry> = ladder.collect();
        if stepping == Stepping::Verlet {
            let rk4 = RK4.map(|(factor, depth)| of(Stepping::Rk4, factor, Some(depth)));
            entries.extend(pairs(&rk4));
        }
        Self(entries)
    }

    /// Judge of the cheapest: steps near the limit of stability part twins that the drive does not.
    pub(super) fn first_judge(&self) -> Candidate {
        self.0[0].judge
    }

    /// One of them, by its place.
    pub(super) fn get(&self, place: usize) -> Option<&Entry> {
        self.0.get(place)
    }

    /// Place of the candidate to try after one that errs by more than the accuracy.
    ///
    /// ```text
    /// e ∝ hᵖ:   k = ln(e/accuracy)/(p ln 2^⅕) rungs, one at least
    /// ```
    ///
    /// p is 2, and 1 for implicit damping within a factor of [`NEAR`] of the accuracy: farther off its errors fall faster than that, and so
    /// does what impacts bring in that feed themselves.
    /// A step that fails says nothing of its error: the next one is that of its judge, and no later one where impacts feed
    /// themselves. From the last rung the other methods follow one by one.
    pub(super) fn after(
        &self,
        place: usize,
        error: f64,
        accuracy: f64,
        feeds_itself: bool,
    ) -> usize {
        if place + 1 >= RUNGS {
            return place + 1;
        }
        let far = (error / accuracy).ln();
        let stepping = self.0.get(place).map(|entry| entry.candidate.stepping);
        let implicit = stepping == Some(Stepping::ImplicitDamping);
        let order = if implicit && !feeds_itself && far < NEAR.ln() {
            1.0
        } else {
            2.0
        };
        let rungs = (far / (order * RATIO.ln())).ceil();
        let most = if feeds_itself { TO_JUDGE } else { RUNGS };
        let down = if rungs.is_finite() {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "few rungs, one at least"
            )]
            {
                rungs.clamp(1.0, most as f64) as usize
            }
        } else {
            TO_JUDGE
        };
        (place + down).min(RUNGS - 1)
    }
}

/// A step of the ladder in units of the time scale.
fn rung(place: usize) -> f64 {
    let (mut factor, rest) = (LONGEST, place % TO_JUDGE);
    for _ in 0..place / TO_JUDGE {
        factor *= 0.5;
    }
    for _ in 0..rest {
        factor /= RATIO;
    }
    factor
}

/// Every candidate with the next as its judge.
fn pairs(list: &[Candidate]) -> Vec<Entry> {
    let pairs = list.windows(2);
    pairs
        .map(|pair| Entry {
            candidate: pair[0],
            judge: pair[1],
        })
        .collect()
}

impl Candidate {
    /// The run by this method.
    pub(super) fn run(&self, run: &Run) -> Run {
        Run {
            stepping: self.stepping,
            step: Some(self.step),
            onset_depth: self.onset_depth,
            ..run.clone()
        }
    }
}

impl Entry {
    /// Factor that turns the difference from the judge into a bound of the error.
    ///
    /// ```text
    /// e(h) = |u(h) − u(h′)| / (1 − h′/h)     first order, the least that contacts leave
    /// ```
    ///
    /// Across methods the judge is taken to have a third of the error.
    pub(super) fn caution(&self) -> f64 {
        let ratio = self.judge.step / self.candidate.step;
        if self.judge.stepping == self.candidate.stepping && ratio < 1.0 {
            1.0 / (1.0 - ratio)
        } else {
            1.5
        }
    }
}

/// Cost of a trace in evaluations a simulated second: clocks would not choose the same twice.
///
/// A solution with implicit damping takes about as long as the evaluation it follows (bicycle drive: 12 µs each).
pub(super) fn work(trace: &Trace) -> f64 {
    let counts = &trace.statistics;
    (counts.evaluations + counts.solves) as f64 / trace.time.last().copied().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However far off a step is, the last of the ladder is tried before another method.
    #[test]
    fn the_ladder_ends_before_other_methods_begin() {
        let ladder = Candidates(Vec::new());
        let after = |place, error| ladder.after(place, error, 0.01, false);
        assert_eq!(after(0, 1e9), RUNGS - 1);
        assert_eq!(after(RUNGS - 2, 1e9), RUNGS - 1);
        assert_eq!(after(RUNGS - 1, 1e9), RUNGS);
        // One rung at least; as many as the judge where nothing is known of the error.
        assert_eq!(after(0, 0.010_001), 1);
        assert_eq!(after(0, f64::NAN), TO_JUDGE);
        // Steps whose impacts feed themselves say nothing beyond their judge.
        assert_eq!(ladder.after(0, 1e9, 0.01, true), TO_JUDGE);
    }
}
