//! Joints find their places: static equilibrium by pseudo-transient continuation.
//!
//! ```text
//! (M + k K) Δq = k f(q),   k grows as the forces come into balance
//! ```
//!
//! Small k follows the motion of the bodies, large k is Newton's method. Joints that are open at
//! first have no stiffness, and the masses carry the iteration until they close.
//!
//! [`tighten`] is the third search for the pretension: see [`assembly`](super).
//!
//! # Source
//! C. T. Kelley and D. E. Keyes, *SIAM J. Numer. Anal.* **35**, 1998, 508–523.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, SecondOrderSystem, Weights};

use crate::bodies::{RailSupport, Turn, WheelSupport};
use crate::drive::PretensionAt;
use crate::energy::Flow;
use crate::seam::Rates;
use crate::system::{Record, System};
use crate::{AssemblyError, Motion};

/// Forces out of balance, relative to the largest joint force, at which a state counts as static.
const CONVERGED: f64 = 1e-7;
/// And what is accepted where the iteration ends without getting there.
const ACCEPTED: f64 = 1e-3;
/// Relative error of the pretension that is left, and relaxations after which the search for it is given up.
const MET: f64 = 1e-3;
const MOST_LENGTHS: usize = 60;
/// Iterations after which an accepted state is taken as it is, counted from that state where it is found later.
const MOST: usize = 600;
/// Iterations after which none is to be expected: ten times as many (assumed). Chains with play under load walk around their
/// sprockets until every roller has found its tooth; 1.6 kN on a bicycle's took about a thousand.
const MOST_TO_BE_ACCEPTED: usize = 6000;

/// Outcome of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    pub(crate) iterations: usize,
    pub(crate) residual: f64,
}

/// Load that a chain shall carry, and the stiffness with which it was laid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tightening {
    /// Which chain.
    pub(super) chain: usize,
    /// Its tension \[N\].
    pub(super) pretension: f64,
    /// Stiffness of its links while it was laid \[N/m\].
    pub(super) stiffness: f64,
    /// Phase at which the chain carries its pretension. In the mean over a tooth it does so as laid, and only its joints settle.
    pub(super) at: PretensionAt,
}

/// Settles under pretension, gravity and load.
pub(super) fn settle(
    system: &mut System,
    q: &mut [f64],
    tightenings: &[Tightening],
) -> Result<Balance, AssemblyError> {
    // Pretension first, chain by chain; then gravity and load on all of them.
    for tightening in tightenings.iter().filter(|t| t.pretension > 0.0) {
        tighten(system, q, *tightening)?;
    }
    let typical = tightenings.iter().fold(0.0_f64, |m, t| m.max(t.pretension));
    let balance = relax(&mut system.at_rest(), q, typical);
    accept(system, balance, "gravity and load on the joints")
}

fn accept(
    system: &System,
    balance: Balance,
    stage: &'static str,
) -> Result<Balance, AssemblyError> {
    if balance.residual < ACCEPTED {
        return Ok(balance);
    }
    Err(system.no_equilibrium(stage, balance.residual, balance.iterations))
}

/// Lets joints find their places without gravity and load, and makes all links of a chain longer or shorter until it carries T₀
/// there, if it is to do so at this phase.
fn tighten(
    system: &mut System,
    q: &mut [f64],
    Tightening {
        chain,
        pretension,
        stiffness,
        at,
    }: Tightening,
) -> Result<(), AssemblyError> {
    let mut bare = system.at_rest();
    bare.bodies.gravity = Vector::zeros();
    for shaft in &mut bare.bodies.shafts {
        shaft.drive.clear();
        shaft.load.clear();
    }
    bare.bodies.free_of_forces();
    // Too long and too short, with what is missing of the tension there.
    let mut bracket: [Option<(f64, f64)>; 2] = [None, None];
    let (mut stretch, mut stride) = (0.0, -pretension / stiffness);
    for _ in 0..MOST_LENGTHS {
        let balance = relax(&mut bare, q, pretension);
        accept(system, balance, "pretension on the joints")?;
        let missing = pretension - mean_tension(&bare, chain, q);
        if at == PretensionAt::MeanPhase || missing.abs() < MET * pretension {
            return Ok(());
        }
        bracket[usize::from(missing < 0.0)] = Some((stretch, missing));
        // The next length: outward until one is known on either side, then between them.
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
        // Both the chain that is relaxed and the one that is to be assembled.
        for target in [&mut bare, &mut *system] {
            target.chains[chain].chain.lengthen(change);
        }
    }
    Err(system.no_equilibrium("pretension on the joints", 1.0, MOST_LENGTHS))
}

fn mean_tension(system: &System, chain: usize, q: &[f64]) -> f64 {
    let mut record = system.new_record();
    let still = vec![0.0; q.len()];
    forces(system, q, &still, &mut record);
    let member = &system.chains[chain];
    let at = Moment::stateless(system.begin, q, &still);
    let mut tensions = Vec::new();
    let own = member.own(at);
    let record = &record.chains[chain];
    member.chain.tensions(own, record, &mut tensions);
    tensions.iter().sum::<f64>() / tensions.len() as f64
}

fn forces(system: &System, q: &[f64], still: &[f64], record: &mut Record) -> Vec<f64> {
    let mut a = vec![0.0; q.len()];
    let mut rates = vec![0.0; Flow::ALL.len()];
    let at = Moment::stateless(system.begin, q, still);
    system.evaluate(at, &mut a, &mut rates, record);
    a
}

/// Follows the forces at rest until they balance.
fn relax(system: &mut System, q: &mut [f64], typical: f64) -> Balance {
    let still = vec![0.0; q.len()];
    let inertias = system.inertias();
    let mut record = system.new_record();
    let mut a = forces(system, q, &still, &mut record);
    let (mut worst, mut residual) = system.imbalance(q, &a, &record, typical);
    let mut best = (worst, residual, q.to_vec());
    // The first step reaches ten times as far as 1/ω of the stiffest mode.
    let Rates { squared, .. } = system.rates(&mut record);
    let scale = (1.0 / squared.sqrt()).min(1e-4);
    let longest = 10.0;
    let mut reach = 10.0 * scale;
    let mut iterations = 0;
    let mut trial = q.to_vec();
    let mut accepted = None;
    let most = |accepted: Option<usize>| match accepted {
        None => MOST_TO_BE_ACCEPTED,
        Some(..=MOST) => MOST,
        // As many again as a drive near its equilibrium has from the start.
        Some(late) => late + MOST,
    };
    while residual > CONVERGED && iterations < most(accepted) {
        // From an acceptable state on only so many iterations are made.
        if best.1 < ACCEPTED {
            accepted.get_or_insert(iterations);
        }
        iterations += 1;
        let weight = reach * reach;
        // (M + k K) Δq = k M a with k = τ², where τ is the reach of the step in time.
        let mut step: Vec<f64> = a.iter().map(|a| a * weight).collect();
        let weights = Weights {
            once: false,
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
        // A line search: the forces at the end of the step shall not drive it back by more than half of what drove it on.
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
        // A step that had to be shortened was too bold, and the next reaches less far.
        reach = if share < whole {
            (reach * 0.6).max(scale)
        } else {
            (reach * 1.6).min(longest)
        };
        (worst, residual) = system.imbalance(q, &a, &record, typical);
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
        // Tensioners push as they do at rest, and given motions stand still.
        let mut light = self.clone();
        for slide in &mut light.bodies.slides {
            slide.push = slide.push.relaxed();
        }
        light.bodies.number_states();
        let heaviest = light.heaviest();
        for wheel in &mut light.bodies.wheels {
            if let WheelSupport::Prescribed { x, y } = &mut wheel.support {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
        light.bodies.turns_mut().for_each(Turn::hold);
        for index in 0..light.bodies.shafts.len() {
            let shaft = &light.bodies.shafts[index];
            if let Some(dof) = shaft.led() {
                let inertia = heaviest * shaft.lever * shaft.lever;
                light.bodies.inertias[dof - self.bodies.first] = inertia;
            }
        }
        for rail in &mut light.bodies.rails {
            if let RailSupport::Prescribed { x, y } = &mut rail.support {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
        for member in &mut light.chains {
            member.chain.hold_still();
        }
        light
    }

    /// Mass of the heaviest body or roller of a chain \[kg\].
    fn heaviest(&self) -> f64 {
        let all = self.chains.iter().map(|member| member.chain.weights()[1]);
        all.fold(0.0, f64::max)
    }

    /// Largest force out of balance \[N\], and relative to the largest force in a joint or on a tooth.
    fn imbalance(&self, q: &[f64], a: &[f64], record: &Record, typical: f64) -> (f64, f64) {
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(self.begin, q, &still);
        let mut worst = 0.0_f64;
        let mut pressed = 0.0_f64;
        for (member, record) in self.chains.iter().zip(&record.chains) {
            worst = worst.max(member.chain.imbalance(&a[member.entries.clone()]));
            pressed = pressed.max(member.chain.pressed(member.own(at), record));
        }
        for shaft in &self.bodies.shafts {
            if let Some(dof) = shaft.led() {
                let inertia = self.bodies.inertia(dof);
                worst = worst.max(inertia * a[dof].abs() / shaft.lever);
            }
        }
        let weight = self.heaviest() * self.bodies.gravity.norm();
        let scale = pressed.max(weight).max(1e-3 * typical).max(1e-9);
        (worst, worst / scale)
    }

    /// Share of a step that moves nothing farther than its chain allows.
    fn within_reach(&self, step: &[f64]) -> f64 {
        let members = self.chains.iter();
        members.fold(1.0, |share, member| {
            share.min(member.chain.reach(&step[member.entries.clone()]))
        })
    }
}
