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

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Moment, SecondOrderSystem, Weights};

use super::{Joining, Linkage, turned};
use crate::AssemblyError;
use crate::energy::Flow;
use crate::system::{Record, System, WheelRotation};

/// Forces out of balance, relative to the largest joint force, at which a state counts as static.
const CONVERGED: f64 = 1e-7;
/// And what is accepted where the iteration ends without getting there.
const ACCEPTED: f64 = 1e-3;
const MOST: usize = 3000;

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
    let balance = relax(system, q);
    accept(balance, "gravity and load on the joints")
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
    let mut bare = system.clone();
    bare.gravity = Vector::zeros();
    for wheel in &mut bare.wheels {
        if let WheelRotation::Free { drive, load, .. } = &mut wheel.rotation {
            drive.clear();
            load.clear();
        }
    }
    let mut stretch = 0.0;
    let mut last: Option<(f64, f64)> = None;
    for _ in 0..12 {
        let balance = relax(&mut bare, q);
        accept(balance, "pretension on the joints")?;
        let tension = mean_tension(&bare, q);
        if (tension / pretension - 1.0).abs() < 1e-4 {
            break;
        }
        // T grows by k for every metre that each link is shorter: the secant corrects k.
        let slope = match last {
            Some((before, at)) if (stretch - before).abs() > 0.0 => {
                ((tension - at) / (stretch - before)).min(-0.05 * stiffness)
            }
            _ => -stiffness,
        };
        last = Some((stretch, tension));
        let change = ((pretension - tension) / slope).clamp(-2e-3, 2e-3) ;
        stretch += change;
        for target in [&mut bare, &mut *system] {
            if let Some(linkage) = &mut target.linkage {
                linkage.lengthen(change);
            }
        }
    }
    Ok(())
}

fn mean_tension(system: &System, q: &[f64]) -> f64 {
    let mut record = system.new_record();
    let still = vec![0.0; q.len()];
    forces(system, q, &still, &mut record);
    let Some(linkage) = &system.linkage else {
        return 0.0;
    };
    let sum: f64 = (0..linkage.links)
        .map(|link| linkage.tension(link, &record.play))
        .sum();
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
fn relax(system: &mut System, q: &mut [f64]) -> Balance {
    let still = vec![0.0; q.len()];
    let mut record = system.new_record();
    let mut a = forces(system, q, &still, &mut record);
    let mut residual = system.imbalance(&a, &record);
    let mut best = (residual, q.to_vec());
    let scale = system
        .linkage
        .as_ref()
        .map_or(1e-6, |linkage| linkage.stiffest(system, &record.play)[1]);
    let mut reach = 10.0 * scale.min(1e-3);
    let mut iterations = 0;
    while residual > CONVERGED && iterations < MOST {
        let weight = reach * reach;
        let mut step: Vec<f64> = a.iter().map(|a| a * weight).collect();
        let weights = Weights {
            damping: 0.0,
            stiffness: weight,
        };
        if !system.solve(weights, &mut record, &mut step) {
            reach *= 0.5;
            iterations += 1;
            continue;
        }
        let factor = system.within_reach(&step);
        for (q, step) in q.iter_mut().zip(&step) {
            *q += factor * step;
        }
        a = forces(system, q, &still, &mut record);
        let now = system.imbalance(&a, &record);
        reach = if now < 1.5 * residual {
            (reach * 1.3).min(10.0)
        } else {
            (reach * 0.5).max(scale)
        };
        residual = now;
        iterations += 1;
        if residual < best.0 {
            best = (residual, q.to_vec());
        }
    }
    q.copy_from_slice(&best.1);
    Balance {
        iterations,
        residual: best.0,
    }
}

impl System {
    /// Largest force out of balance, relative to the largest force in a joint or on a tooth.
    fn imbalance(&self, a: &[f64], record: &Record) -> f64 {
        let Some(linkage) = &self.linkage else {
            return 0.0;
        };
        let lever = 0.5 * linkage.pitch;
        let mut worst = 0.0_f64;
        for (body, a) in linkage.bodies.iter().zip(a.chunks_exact(3)) {
            worst = worst
                .max(body.mass * a[0].hypot(a[1]))
                .max(body.inertia * a[2].abs() / lever);
        }
        for (index, wheel) in self.wheels.iter().enumerate() {
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                worst = worst.max(wheel.inertia * a[dof].abs() / wheel.pitch_radius);
            }
            let _ = index;
        }
        let pressed = record
            .play
            .elements
            .iter()
            .fold(0.0_f64, |m, element| m.max(element.force));
        let weight = linkage
            .bodies
            .iter()
            .fold(0.0_f64, |m, body| m.max(body.mass * self.gravity.norm()));
        worst / pressed.max(weight).max(1e-9)
    }

    /// Share of a step that moves nothing farther than a tenth of the roller's radius.
    fn within_reach(&self, step: &[f64]) -> f64 {
        let Some(linkage) = &self.linkage else {
            return 1.0;
        };
        let cap = match &linkage.joining {
            Joining::Clearance(bearing) => 0.5 * bearing.clearance.max(1e-6),
            Joining::Hinges(_) => 1e-5,
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
    fn lengthen(&mut self, change: f64) {
        for body in &mut self.bodies[..self.links] {
            let along = (body.arms[1] - body.arms[0]).normalize();
            body.arms[0] -= along * (0.5 * change);
            body.arms[1] += along * (0.5 * change);
        }
    }

    /// Sets free rollers against their bushes where the chain will press them: on wheels outward, elsewhere
    /// hanging.
    pub(crate) fn seat_rollers(&self, system: &System, q: &mut [f64]) {
        let Some(free) = &self.free_rollers else {
            return;
        };
        let still = vec![0.0; q.len()];
        let at = Moment {
            t: 0.0,
            q: &*q,
            v: &still,
        };
        let mut posture = super::Posture::default();
        self.pose(at, &mut posture);
        let down = system.gravity.try_normalize(0.0).unwrap_or_else(Vector::zeros);
        let places: Vec<Option<(usize, Point)>> = (0..self.joints.len())
            .map(|joint| {
                let body = free.body[joint]?;
                let bush = self.part(self.joints[joint].carrier, at, &posture).place;
                let wheel = system.wheels.iter().find_map(|wheel| {
                    let (frame, _, _) = system.wheel_frame(wheel, at);
                    let d = bush - frame.origin;
                    let seat = wheel.pitch_radius.hypot(0.5 * wheel.pitch);
                    (d.norm() < 0.5 * (wheel.pitch_radius + seat)).then(|| d.normalize())
                });
                let away = wheel.unwrap_or(down);
                Some((body, bush + away * free.bearing.clearance))
            })
            .collect();
        for (body, place) in places.into_iter().flatten() {
            q[3 * body] = place.x;
            q[3 * body + 1] = place.y;
        }
        let _ = turned;
    }
}
