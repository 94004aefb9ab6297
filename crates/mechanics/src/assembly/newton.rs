//! Static equilibrium by Newton's method.
//!
//! ```text
//! ∇E(u) = 0,   E = Σ ½ k (ℓ − p)² + Σ U(δ) − Σ m g·x − Σ M θ − Σ F·x + E_tensioners + E_bearings
//! ```
//!
//! u holds the free rollers, sprocket angles and centres, and tensioners. The Hessian is exact,
//! with the term −F n·d of the rotating wheel, without which the iteration crawls. The ring of
//! rollers is folded (0, N−1, 1, N−2, …) so that it becomes a band, with everything else as a border.

mod balance;
mod contact;
mod curvature;
mod descend;
mod skyline;
mod stride;

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, SecondOrderSystem};

use crate::bodies::WheelSupport;
use crate::seam::{Balance, Load};
use crate::system::{Member, Record};
use crate::{AssemblyError, System};

pub(crate) use curvature::{Curvature, curvature};
use skyline::Skyline;

/// A static state on the way to the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Statics {
    /// Load that had been applied: "pretension", "gravity" or "load".
    pub stage: &'static str,
    /// Newton iterations.
    pub iterations: usize,
    /// Largest force out of balance, relative to the largest link tension.
    pub residual: f64,
    /// Tension of every link \[N\], (links,).
    pub tensions: Vec<f64>,
    /// Contacts closed on every sprocket.
    pub contacts: Vec<usize>,
}

/// Residual at which an iteration ends, relative to the largest link tension.
const CONVERGED: f64 = 1e-9;
/// Residual that is accepted where rounding keeps the iteration from going further.
const ACCEPTED: f64 = 1e-6;
/// Residual at which the next share of a load may come on: the next iteration begins farther away.
const UNDER_WAY: f64 = 1e-3;

/// Way, in pitches, after which rollers near a body are looked for anew: a quarter of how far around it windows reach.
const LOOK: f64 = 0.125;

/// Share of gravity or load below which the path of equilibria is taken to have ended.
const LEAST_SHARE: f64 = 1e-3;

/// Brings `q` into equilibrium: pretension first, then gravity, then load.
///
/// Where no path of equilibria leads there, the chain goes downhill, which may take long, unless `hopeless` names a reason not to try.
pub(super) fn settle(
    system: &mut System,
    q: &mut Vec<f64>,
    hopeless: &dyn Fn() -> Option<AssemblyError>,
) -> Result<Vec<Statics>, AssemblyError> {
    let may_descend = || hopeless().map_or(Ok(()), Err);
    let unknowns = Unknowns::new(system);
    if unknowns.count == 0 {
        return Ok(Vec::new());
    }
    let mut statics = Vec::new();
    let taut = is_taut(system, q);
    let mut at = Load {
        gravity: 0.0,
        torque: 0.0,
    };
    let stages: [(&'static str, bool); 2] = [
        ("gravity", system.bodies.gravity != Vector::zeros()),
        ("load", has_load(system)),
    ];
    let mut newton = Newton {
        record: system.new_record(),
        system,
        unknowns: &unknowns,
        looked: q.clone(),
    };
    // A chain that pulls as it was laid finds its place under that alone; where Newton's method does not, downhill.
    if taut {
        let mut found = newton.solve(q, at, 300, CONVERGED);
        if found.residual >= ACCEPTED {
            may_descend()?;
            found = newton.descend(q, at);
        }
        *q = newton.accept(found, "pretension", &mut statics)?;
    }
    // Gravity and load come on in shares, each from the equilibrium of the one before: shares grow while that works, and
    // shrink where it does not.
    for (stage, present) in stages {
        let only = stage == "load" && statics.is_empty();
        if !(present || only) {
            continue;
        }
        // Teeth take a load over one after the other.
        let mut step = if taut && stage == "load" { 0.5 } else { 1.0 };
        let mut share = 0.0_f64;
        while share < 1.0 {
            let next = (share + step).min(1.0);
            let mut load = at;
            match stage {
                "gravity" => load.gravity = next,
                _ => load.torque = next,
            }
            let [enough, accepted] = if next < 1.0 {
                [UNDER_WAY; 2]
            } else {
                [CONVERGED, ACCEPTED]
            };
            let found = newton.solve(q, load, 120, enough);
            if found.residual <= accepted {
                share = next;
                step *= 1.8;
                q.clone_from(&found.q);
                if share >= 1.0 {
                    newton.accept(found, stage, &mut statics)?;
                }
            } else {
                step *= 0.35;
                if step < LEAST_SHARE {
                    // The path ends here: let go with all of the load on.
                    match stage {
                        "gravity" => load.gravity = 1.0,
                        _ => load.torque = 1.0,
                    }
                    may_descend()?;
                    let found = newton.descend(q, load);
                    *q = newton.accept(found, stage, &mut statics)?;
                    share = 1.0;
                }
            }
        }
        match stage {
            "gravity" => at.gravity = 1.0,
            _ => at.torque = 1.0,
        }
    }
    for member in &system.chains {
        member.chain.copy_ghosts(&mut q[member.entries.clone()]);
    }
    Ok(statics)
}

/// Whether the chain as laid is under tension.
fn is_taut(system: &System, q: &[f64]) -> bool {
    let still = vec![0.0; q.len()];
    let at = Moment::stateless(system.begin, q, &still);
    let mut record = system.new_record();
    let mut rates = vec![0.0; system.quadratures() + system.states()];
    let z = system.settled_states(q);
    let at = Moment { z: &z, ..at };
    system.evaluate(at, &mut still.clone(), &mut rates, &mut record);
    let mut chains = system.chains.iter().zip(&record.chains);
    chains.any(|(member, record)| {
        let chain = &member.chain;
        let mut tensions = Vec::new();
        chain.tensions(member.own(at), record, &mut tensions);
        let weight = (chain.weights()[0] * system.bodies.gravity.norm()).max(1e-9);
        let slack = (1e-6 * weight).max(1e3 * tensions.len() as f64 * rounding(member, q));
        tensions.iter().sum::<f64>() > slack
    })
}

/// Force \[N\] that the rounding of coordinates alone may leave in a link.
fn rounding(member: &Member, q: &[f64]) -> f64 {
    let farthest = q[member.entries.clone()]
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    4.0 * f64::EPSILON * farthest * member.chain.stiffest_spring()
}

fn has_load(system: &System) -> bool {
    let mut shafts = system.bodies.shafts.iter();
    let torque = shafts.any(|shaft| !(shaft.drive.is_empty() && shaft.load.is_empty()));
    let mut chains = system.chains.iter();
    torque || chains.any(|member| member.chain.is_pulled()) || system.bodies.are_forced()
}

/// Which entries of the state are unknown, and where they stand in the linear system.
struct Unknowns {
    /// State entry → row.
    row: Vec<Option<usize>>,
    count: usize,
    /// First row of turning shafts, after those of chains.
    turns: usize,
    /// First row of centres and tensioners, the last ones.
    places: usize,
    /// Squared lever \[m²\] that turns the row's unit into metres: 1 for rollers, R² for angles.
    scale: Vec<f64>,
}

impl Unknowns {
    fn new(system: &System) -> Self {
        let mut row = vec![None; system.dofs];
        let mut scale = Vec::new();
        let mut add = |entry: usize, lever: f64, scale: &mut Vec<f64>| {
            if row[entry].is_none() {
                row[entry] = Some(scale.len());
                scale.push(lever);
            }
        };
        for member in &system.chains {
            for unknown in member.chain.unknowns() {
                add(
                    member.entries.start + unknown.entry,
                    unknown.lever,
                    &mut scale,
                );
            }
        }
        let turns = scale.len();
        let bodies = &system.bodies;
        for wheel in &bodies.wheels {
            if let Some((dof, _)) = wheel.turn.turned_by() {
                let lever = bodies.shafts[wheel.shaft].lever;
                add(dof, lever * lever, &mut scale);
            }
        }
        for shaft in &bodies.shafts {
            if let Some(dof) = shaft.led() {
                add(dof, shaft.lever * shaft.lever, &mut scale);
            }
        }
        let places = scale.len();
        for wheel in &bodies.wheels {
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                add(dof, 1.0, &mut scale);
                add(dof + 1, 1.0, &mut scale);
            }
        }
        for slide in &bodies.slides {
            if let Some(dof) = slide.dof {
                add(dof, slide.carrier.reach().powi(2), &mut scale);
            }
        }
        Self {
            row,
            count: scale.len(),
            turns,
            places,
            scale,
        }
    }
}

/// Outcome of an iteration.
struct StaticSolution {
    q: Vec<f64>,
    iterations: usize,
    residual: f64,
    tensions: Vec<f64>,
    contacts: Vec<usize>,
}

struct Newton<'a> {
    system: &'a mut System,
    unknowns: &'a Unknowns,
    record: Record,
    /// State for which the contact windows were laid.
    looked: Vec<f64>,
}

impl Newton<'_> {
    fn accept(
        &self,
        found: StaticSolution,
        stage: &'static str,
        statics: &mut Vec<Statics>,
    ) -> Result<Vec<f64>, AssemblyError> {
        if found.residual >= ACCEPTED || found.residual.is_nan() {
            let StaticSolution {
                residual,
                iterations,
                ..
            } = found;
            return Err(self.system.no_equilibrium(stage, residual, iterations));
        }
        statics.push(Statics {
            stage,
            iterations: found.iterations,
            residual: found.residual,
            tensions: found.tensions,
            contacts: found.contacts,
        });
        Ok(found.q)
    }

    /// Newton with a step cap and a small scaled shift.
    ///
    /// Steps need not lower the energy one by one: the seats are strongly curved valleys of
    /// radius r_i − d₁/2, and a step along one first climbs and then falls back.
    fn solve(&mut self, start: &[f64], load: Load, most: usize, enough: f64) -> StaticSolution {
        let stiffness = self.stiffest();
        let mut q = start.to_vec();
        let mut shift = 1e-7 * stiffness;
        let mut balance = self.balance(&q, load);
        let mut residual = self.residual(&q, &balance);
        let mut best = (residual, q.clone());
        let mut iterations = 0;
        while iterations < most && residual > enough {
            // The step of Newton's method, cut where a roller would go too far.
            let Some(step) = self.step(&balance, &mut shift, stiffness) else {
                break;
            };
            let factor = self.share(&q, &step, 1.0);
            self.go(&mut q, &step, factor);
            balance = self.balance(&q, load);
            let now = self.residual(&q, &balance);
            if !now.is_finite() {
                break;
            }
            // The shift keeps the matrix definite: less of it as the iteration goes well.
            shift = if now < 3.0 * residual {
                (shift / 3.0).max(1e-14 * stiffness)
            } else {
                (shift * 2.0).min(1e-3 * stiffness)
            };
            // Rounding sets a floor: stop when a converged state no longer gets better.
            let stalled = residual < ACCEPTED * 1e-2 && now > 0.5 * residual;
            residual = now;
            if residual < best.0 {
                best = (residual, q.clone());
            }
            iterations += 1;
            if stalled {
                break;
            }
        }
        let (residual, best) = best;
        if best != q {
            balance = self.balance(&best, load);
        }
        StaticSolution {
            q: best,
            iterations,
            residual,
            tensions: balance.tensions,
            contacts: balance.contacts,
        }
    }

    /// Stiffness of the stiffest link \[N/m\].
    fn stiffest(&self) -> f64 {
        let chains = self.system.chains.iter();
        chains
            .map(|member| member.chain.stiffest_spring())
            .fold(0.0, f64::max)
    }

    /// Forces and stiffness at a state, with the contacts of the rollers that are near a body there.
    fn balance(&mut self, q: &[f64], load: Load) -> Balance {
        if self.moved(q) > LOOK * self.system.pitch() {
            self.system.look_around(q, &mut self.record);
            self.looked.copy_from_slice(q);
        }
        balance::balance(self.system, self.unknowns, q, load)
    }

    fn residual(&self, q: &[f64], balance: &Balance) -> f64 {
        balance::residual(self.system, self.unknowns, q, balance)
    }

    /// −(H + λ D)⁻¹ ∇E, raising λ until the matrix is positive definite.
    fn step(&self, balance: &Balance, shift: &mut f64, stiffness: f64) -> Option<Vec<f64>> {
        while *shift < 1e3 * stiffness {
            // The shift in the units of each row.
            let scale = self.unknowns.scale.iter();
            let diagonal: Vec<f64> = scale.map(|lever| *shift * lever).collect();
            if let Some(factor) = Skyline::factor(&balance.entries, &diagonal) {
                let mut step: Vec<f64> = balance.gradient.iter().map(|slope| -slope).collect();
                factor.solve(&mut step);
                return Some(step);
            }
            *shift *= 10.0;
        }
        None
    }
}
