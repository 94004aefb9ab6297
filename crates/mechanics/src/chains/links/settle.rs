//! Static equilibrium of a linkage by pseudo-transient continuation.
//!
//! ```text
//! (M + k K) Δq = k f(q),   k grows as the forces come into balance
//! ```
//!
//! Small k follows the motion of the bodies, large k is Newton's method. Joints that are open at
//! first have no stiffness, and the masses carry the iteration until they close.
//!
//! # Source
//! C. T. Kelley and D. E. Keyes, *SIAM J. Numer. Anal.* **35**, 1998, 508–523.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, SecondOrderSystem, Weights};

use super::{Joining, Linkage, Shapes};
use crate::energy::Flow;
use crate::system::{RailSupport, Record, System, WheelRotation, WheelSupport};
use crate::{AssemblyError, End, Motion};

/// Forces out of balance, relative to the largest joint force, at which a state counts as static.
const CONVERGED: f64 = 1e-7;
/// And what is accepted where the iteration ends without getting there.
const ACCEPTED: f64 = 1e-3;
const MOST: usize = 600;

/// Outcome of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    pub(crate) iterations: usize,
    pub(crate) residual: f64,
}

/// Settles under pretension, gravity and load.
pub(crate) fn settle(
    system: &mut System,
    q: &mut [f64],
    pretension: f64,
    stiffness: f64,
) -> Result<Balance, AssemblyError> {
    if pretension > 0.0 {
        tighten(system, q, pretension, stiffness)?;
    }
    let mut light = system.at_rest();
    accept(
        relax(&mut light, q, pretension),
        "gravity and load on the joints",
    )
}

fn accept(balance: Balance, stage: &'static str) -> Result<Balance, AssemblyError> {
    if balance.residual < ACCEPTED {
        return Ok(balance);
    }
    Err(AssemblyError::NoEquilibrium {
        stage,
        residual: balance.residual,
        iterations: balance.iterations,
    })
}

/// Makes all links longer or shorter until the chain without gravity and load carries T₀.
fn tighten(
    system: &mut System,
    q: &mut [f64],
    pretension: f64,
    stiffness: f64,
) -> Result<(), AssemblyError> {
    let mut bare = system.at_rest();
    bare.gravity = Vector::zeros();
    for wheel in &mut bare.wheels {
        if let WheelRotation::Free { drive, load, .. } = &mut wheel.rotation {
            drive.clear();
            load.clear();
        }
    }
    // Too long and too short, with what is missing of the tension there.
    let mut bracket: [Option<(f64, f64)>; 2] = [None, None];
    let (mut stretch, mut stride) = (0.0, -pretension / stiffness);
    for _ in 0..60 {
        let balance = relax(&mut bare, q, pretension);
        accept(balance, "pretension on the joints")?;
        let missing = pretension - mean_tension(&bare, q);
        if missing.abs() < 1e-3 * pretension {
            return Ok(());
        }
        bracket[usize::from(missing < 0.0)] = Some((stretch, missing));
        let next = match bracket {
            // A slack chain tells nothing about how much is missing: go on in growing strides.
            [Some((long, _)), None] => {
                stride *= 2.0;
                long + 0.5 * stride
            }
            [None, Some((short, excess))] => short - 1.2 * excess / stiffness,
            [Some((long, missing)), Some((short, excess))] => {
                let share = (missing / (missing - excess)).clamp(0.1, 0.9);
                long + (short - long) * share
            }
            [None, None] => stretch,
        };
        let change = next - stretch;
        stretch = next;
        for target in [&mut bare, &mut *system] {
            if let Some(linkage) = &mut target.linkage {
                linkage.lengthen(change);
            }
        }
    }
    Err(AssemblyError::NoEquilibrium {
        stage: "pretension on the joints",
        residual: 1.0,
        iterations: 60,
    })
}

fn mean_tension(system: &System, q: &[f64]) -> f64 {
    let mut record = system.new_record();
    let still = vec![0.0; q.len()];
    forces(system, q, &still, &mut record);
    let Some(linkage) = &system.linkage else {
        return 0.0;
    };
    let sum: f64 = linkage.tensions(&record.play).iter().sum();
    sum / linkage.links as f64
}

fn forces(system: &System, q: &[f64], still: &[f64], record: &mut Record) -> Vec<f64> {
    let mut a = vec![0.0; q.len()];
    let mut rates = vec![0.0; Flow::ALL.len()];
    let at = Moment {
        t: 0.0,
        q,
        v: still,
    };
    system.evaluate(at, &mut a, &mut rates, record);
    a
}

/// Follows the forces at rest until they balance.
fn relax(system: &mut System, q: &mut [f64], typical: f64) -> Balance {
    let still = vec![0.0; q.len()];
    let inertias = system.all_inertias();
    let mut record = system.new_record();
    let mut a = forces(system, q, &still, &mut record);
    let (mut worst, mut residual) = system.imbalance(&a, &record, typical);
    let mut best = (worst, residual, q.to_vec());
    let scale = system
        .linkage
        .as_ref()
        .map_or(1e-6, |linkage| linkage.stiffest(system, &record.play)[1])
        .min(1e-4);
    let longest = match system.linkage.as_ref().map(|linkage| &linkage.joining) {
        // Beyond 1/α the stabilisation of the hinges would overshoot.
        Some(Joining::Hinges(hinges)) => 1.0 / hinges.rate,
        _ => 10.0,
    };
    let mut reach = 10.0 * scale;
    let mut iterations = 0;
    let mut trial = q.to_vec();
    while residual > CONVERGED && iterations < MOST {
        iterations += 1;
        let weight = reach * reach;
        let mut step: Vec<f64> = a.iter().map(|a| a * weight).collect();
        let weights = Weights {
            damping: 0.0,
            stiffness: weight,
        };
        if !system.solve(weights, &mut record, &mut step) {
            reach *= 0.5;
            continue;
        }
        // Power along the step: positive while the forces still drive it.
        let drive = |a: &[f64]| -> f64 {
            let terms = a.iter().zip(&inertias).zip(&step);
            terms.map(|((a, inertia), step)| a * inertia * step).sum()
        };
        let start = drive(&a);
        let whole = system.within_reach(&step);
        let mut share = whole;
        for look in 0..6 {
            for ((trial, q), step) in trial.iter_mut().zip(q.iter()).zip(&step) {
                *trial = q + share * step;
            }
            a = forces(system, &trial, &still, &mut record);
            let end = drive(&a);
            if end > -0.5 * start || look == 5 {
                break;
            }
            // Too far: back to where the secant says that the drive vanishes.
            share *= (start / (start - end)).max(0.1);
        }
        q.copy_from_slice(&trial);
        reach = if share < whole {
            (reach * 0.6).max(scale)
        } else {
            (reach * 1.6).min(longest)
        };
        (worst, residual) = system.imbalance(&a, &record, typical);
        if worst < best.0 {
            best = (worst, residual, q.to_vec());
        }
    }
    q.copy_from_slice(&best.2);
    Balance {
        iterations,
        residual: best.1,
    }
}

impl System {
    /// The same statics with everything prescribed at rest, so that no contact closes or slips, and with wheels
    /// that turn as easily as the chain on them: heavy ones would hold up the iteration.
    fn at_rest(&self) -> Self {
        let mut light = self.clone();
        let Some(linkage) = &mut light.linkage else {
            return light;
        };
        let link = linkage.bodies[..linkage.links]
            .iter()
            .fold(0.0_f64, |m, body| m.max(body.mass));
        for wheel in &mut light.wheels {
            if let WheelSupport::Prescribed { x, y } = &mut wheel.support {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
            if let WheelRotation::Prescribed(motion) = &mut wheel.rotation {
                *motion = Motion::Held;
            }
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                wheel.inertia = link * wheel.pitch_radius * wheel.pitch_radius;
                light.border_inertias[dof - linkage.dofs()] = wheel.inertia;
            }
        }
        for rail in &mut light.rails {
            if let RailSupport::Prescribed { x, y } = &mut rail.support {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
        for held in &mut linkage.ends {
            if let End::Driven { x, y } = &mut held.end {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
        light
    }

    /// Masses and moments of inertia in the order of the state.
    fn all_inertias(&self) -> Vec<f64> {
        let chain = self.linkage.iter().flat_map(|linkage| &linkage.bodies);
        chain
            .flat_map(|body| [body.mass, body.mass, body.inertia])
            .chain(self.border_inertias.iter().copied())
            .collect()
    }

    /// Largest force out of balance \[N\], and relative to the largest force in a joint or on a tooth.
    fn imbalance(&self, a: &[f64], record: &Record, typical: f64) -> (f64, f64) {
        let Some(linkage) = &self.linkage else {
            return (0.0, 0.0);
        };
        let lever = 0.5 * linkage.pitch;
        let mut worst = 0.0_f64;
        for (body, a) in linkage.bodies.iter().zip(a.chunks_exact(3)) {
            worst = worst
                .max(body.mass * a[0].hypot(a[1]))
                .max(body.inertia * a[2].abs() / lever);
        }
        for wheel in &self.wheels {
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                worst = worst.max(wheel.inertia * a[dof].abs() / wheel.pitch_radius);
            }
        }
        let mut pressed = 0.0_f64;
        linkage.each_element(&record.play, |element| pressed = pressed.max(element.force));
        let weight = linkage
            .bodies
            .iter()
            .fold(0.0_f64, |m, body| m.max(body.mass * self.gravity.norm()));
        let scale = pressed.max(weight).max(1e-3 * typical).max(1e-9);
        (worst, worst / scale)
    }

    /// Share of a step that moves nothing farther than a tenth of the roller's radius.
    fn within_reach(&self, step: &[f64]) -> f64 {
        let Some(linkage) = &self.linkage else {
            return 1.0;
        };
        let cap = match &linkage.joining {
            Joining::Clearance(bearing) => bearing.clearance.max(1e-6),
            Joining::Hinges(_) => 1e-4,
        };
        let lever = 0.5 * linkage.pitch;
        let mut farthest = 0.0_f64;
        for step in step[..linkage.dofs()].chunks_exact(3) {
            farthest = farthest
                .max(step[0].abs())
                .max(step[1].abs())
                .max(step[2].abs() * lever);
        }
        (cap / farthest).min(1.0)
    }
}

impl Linkage {
    /// Makes every link longer by `change` \[m\], between its joints.
    pub(crate) fn lengthen(&mut self, change: f64) {
        for body in &mut self.bodies[..self.links] {
            let along = (body.arms[1] - body.arms[0]).normalize();
            body.arms[0] -= along * (0.5 * change);
            body.arms[1] += along * (0.5 * change);
        }
        self.shapes = Shapes::of(&self.bodies, self.links, self.closed);
    }
}
