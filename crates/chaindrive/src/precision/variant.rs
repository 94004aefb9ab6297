//! Methods and steps: the ladder that a choice goes down, those of a work-precision study, and its references.

use chaindrive_integrate::SecondOrderSystem;
use chaindrive_mechanics::Assembled;

use crate::figure::Measure;
use crate::{Run, Stepping};

/// A method with what decides on its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Method.
    pub stepping: Stepping,
    /// Step, or longest step of a method with error control \[s\].
    pub step: Option<f64>,
    /// Relative tolerance of a method with error control \[–\].
    pub tolerance: Option<f64>,
    /// Deepest first penetration \[m\], where steps are rejected for it.
    pub onset_depth: Option<f64>,
}

impl Variant {
    pub(super) fn run(&self, run: &Run) -> Run {
        Run {
            stepping: self.stepping,
            step: self.step,
            tolerance: self.tolerance.unwrap_or(run.tolerance),
            onset_depth: self.onset_depth,
            ..run.clone()
        }
    }

    /// In words: method, step or tolerance, onset depth.
    pub fn describe(&self) -> String {
        let mut text = self.stepping.name().to_owned();
        if let Some(tolerance) = self.tolerance {
            text = format!("{text}, tolerance {tolerance:.0e}");
        } else if let Some(step) = self.step {
            text = format!("{text}, step {}", Measure::Time.told(step));
        }
        if let Some(depth) = self.onset_depth {
            text = format!("{text}, onset depth {depth:.0e} m");
        }
        text
    }
}

/// Steps of the study in units of 1/ω of the stiffest mode, for methods that follow the damping.
const VERLET: [f64; 4] = [0.7, 0.5, 0.25, 0.125];
const RK4: [f64; 2] = [0.5, 0.25];
const ONSETS: [f64; 3] = [1e-5, 1e-6, 1e-7];
const TOLERANCES: [f64; 3] = [1e-5, 1e-6, 1e-7];
/// The same in units of 1/ω without damping, for methods that do not have to.
const IMPLICIT_DAMPING: [f64; 4] = [1.4, 0.7, 0.35, 0.175];
const GENERALIZED_ALPHA: [f64; 3] = [2.0, 1.0, 0.5];
/// Reference and check of particles.
const REFERENCE: (f64, f64) = (0.0625, 1e-8);
const CHECK: (f64, f64) = (1e-9, 1e-8);
/// Reference and check of rigid links, whose contacts are many times softer than their damping is stiff.
const CLEARANCE_REFERENCE: f64 = 0.5;
const CLEARANCE_CHECK: f64 = 0.25;

/// A fixed step in units of the time scale that limits the method.
fn fixed(start: &Assembled, stepping: Stepping, factor: f64, onset_depth: Option<f64>) -> Variant {
    let scale = stepping.time_scale(&start.system);
    Variant {
        stepping,
        step: Some(factor * scale),
        tolerance: None,
        onset_depth,
    }
}

fn adaptive(start: &Assembled, tolerance: f64, onset_depth: f64) -> Variant {
    Variant {
        stepping: Stepping::DormandPrince,
        // Longer steps would run over contacts before the error control sees them.
        step: Some(start.system.time_scale()),
        tolerance: Some(tolerance),
        onset_depth: Some(onset_depth),
    }
}

/// Variants that a study compares unless others are given.
pub(super) fn usual(start: &Assembled) -> Vec<Variant> {
    let of = |stepping, factors: &[f64]| -> Vec<Variant> {
        let variants = factors.iter();
        variants
            .map(|factor| fixed(start, stepping, *factor, None))
            .collect()
    };
    if start.system.prefers_implicit_damping() {
        let mut list = of(Stepping::ImplicitDamping, &IMPLICIT_DAMPING);
        list.extend(of(Stepping::GeneralizedAlpha, &GENERALIZED_ALPHA));
        list.extend(of(Stepping::Rk4, &[1.0]));
        return list;
    }
    let mut list = of(Stepping::Verlet, &VERLET);
    for factor in RK4 {
        list.extend(of(Stepping::Rk4, &[factor]));
        let with = ONSETS.map(|depth| fixed(start, Stepping::Rk4, factor, Some(depth)));
        list.extend(with);
    }
    list.extend(TOLERANCES.map(|tolerance| adaptive(start, tolerance, 1e-7)));
    list
}

/// The reference, and an independent method that it is checked with.
///
/// Particles: Runge–Kutta of fourth order with rejected first penetrations, and Dormand–Prince under
/// error control. Rigid links: Runge–Kutta and Verlet, both with steps that follow the damping of the joints.
pub(super) fn references(start: &Assembled) -> [Variant; 2] {
    if start.system.prefers_implicit_damping() {
        return [
            fixed(start, Stepping::Rk4, CLEARANCE_REFERENCE, None),
            fixed(start, Stepping::Verlet, CLEARANCE_CHECK, None),
        ];
    }
    let (factor, depth) = REFERENCE;
    [
        fixed(start, Stepping::Rk4, factor, Some(depth)),
        adaptive(start, CHECK.0, CHECK.1),
    ]
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
/// Steps of Runge–Kutta in units of 1/ω of the stiffest mode, with the depth \[m\] beyond which a first penetration is approached
/// again; each is compared with the next, which has to have a shorter step: a shallower onset alone would show
/// the error of the onset only.
const RK4_LADDER: [(f64, f64); 4] = [(0.5, 1e-5), (0.25, 1e-6), (0.125, 1e-7), (0.0625, 1e-8)];

/// A candidate and the sharper one it is compared with.
///
/// ```text
/// e(h) = |u(h) − u(½h)| / (1 − ½)     first order, the least that contacts leave
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Step of the candidate over the time scale that limits its method \[–\].
    pub(super) factor: f64,
    pub(super) candidate: Variant,
    /// The same method with half the step.
    pub(super) judge: Variant,
}

/// Error over the difference of a candidate from its judge.
pub(super) const CAUTION: f64 = 2.0;

/// Candidates that suit a drive, from the cheapest to the dearest: a ladder of steps of one method, then others.
///
/// Particles: Verlet, then Runge–Kutta with rejection. Rigid links: implicit damping, whose error
/// falls to 0.01 % before explicit methods, which have to follow the damping, become cheaper.
///
/// The first [`RUNGS`] are the ladder.
pub(super) struct Candidates(Vec<Entry>);

impl Candidates {
    pub(super) fn of(start: &Assembled) -> Self {
        let stepping = Stepping::Auto.suited(&start.system);
        let of = |stepping, factor, onset| (factor, fixed(start, stepping, factor, onset));
        let rungs = (0..RUNGS + TO_JUDGE).map(|place| of(stepping, rung(place), None));
        let mut entries = judged(&rungs.collect::<Vec<_>>(), TO_JUDGE);
        if stepping == Stepping::Verlet {
            let rk4 = RK4_LADDER.map(|(factor, depth)| of(Stepping::Rk4, factor, Some(depth)));
            entries.extend(judged(&rk4, 1));
        }
        Self(entries)
    }

    /// Judge of the cheapest: steps near the limit of stability part twins that the drive does not.
    pub(super) fn first_judge(&self) -> Variant {
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

/// Every candidate with the one so many places further as its judge.
fn judged(list: &[(f64, Variant)], further: usize) -> Vec<Entry> {
    let judges = list.iter().skip(further);
    list.iter()
        .zip(judges)
        .map(|(&(factor, candidate), &(_, judge))| Entry {
            factor,
            candidate,
            judge,
        })
        .collect()
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
