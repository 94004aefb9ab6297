//! The methods and steps among which the automatic choice chooses.

use chaindrive_integrate::SecondOrderSystem;
use chaindrive_mechanics::Assembled;

use super::trace::Trace;
use crate::{Run, Stepping};

/// A method with a step, and how the step compares with others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) stepping: Stepping,
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

/// Verlet's steps in units of 1/ω of the stiffest mode, damping included; each is compared with a step that is
/// at most half as long.
const VERLET: [f64; 4] = [0.7, 0.5, 0.25, 0.125];
/// Runge–Kutta steps in the same unit, with the depth \[m\] beyond which a first penetration is approached
/// again; each is compared with the next, which has to have a shorter step: a shallower onset alone would show
/// the error of the onset only.
const RK4: [(f64, f64); 4] = [(0.5, 1e-5), (0.25, 1e-6), (0.125, 1e-7), (0.0625, 1e-8)];
/// Steps with implicit damping in units of 1/ω without damping; each is compared with the next.
const IMPLICIT_DAMPING: [f64; 5] = [1.4, 0.7, 0.35, 0.175, 0.0875];

/// Candidates that suit a drive, from the cheapest to the dearest.
///
/// Particles: Verlet, then Runge–Kutta with rejection. Rigid links: implicit damping, whose error
/// falls to 0.01 % before explicit methods, which have to follow the damping, become cheaper.
pub(super) fn entries(start: &Assembled) -> Vec<Entry> {
    let system = &start.system;
    let of = |stepping: Stepping, factor: f64, onset_depth: Option<f64>| {
        let scale = if stepping.is_implicit() {
            system.undamped_time_scale()
        } else {
            system.time_scale()
        };
        Candidate {
            stepping,
            step: factor * scale,
            onset_depth,
        }
    };
    if system.prefers_implicit_damping() {
        let list = IMPLICIT_DAMPING.map(|factor| of(Stepping::ImplicitDamping, factor, None));
        return pairs(&list);
    }
    let rk4 = RK4.map(|(factor, depth)| of(Stepping::Rk4, factor, Some(depth)));
    let [v7, v5, v25, v125] = VERLET.map(|factor| of(Stepping::Verlet, factor, None));
    let verlet = [(v7, v25), (v5, v25), (v25, rk4[0]), (v125, rk4[1])];
    let verlet = verlet.map(|(candidate, judge)| Entry { candidate, judge });
    verlet.into_iter().chain(pairs(&rk4)).collect()
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
