//! The methods and steps of a work-precision study, and the references it is measured with.

use crate::figure::Measure;
use chaindrive_integrate::SecondOrderSystem;
use chaindrive_mechanics::Assembled;

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
