//! Static equilibrium by Newton's method.
//!
//! ```text
//! ∇E(u) = 0,   E = Σ ½ k (ℓ − p)² + Σ U(δ) − Σ m g·x − Σ M θ + E_tensioners + E_bearings
//! ```
//!
//! u holds the free rollers, sprocket angles and centres, and tensioners. The Hessian is exact,
//! with the term −F n·d of the rotating wheel, without which the iteration crawls. The ring of
//! rollers is folded (0, N−1, 1, N−2, …) so that it becomes a band, with everything else as a border.

mod contact;
mod descend;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::factorization::CscCholesky;
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::system::{Slide, WheelRotation, WheelSupport};
use crate::{AssemblyError, End, System};

/// A static state on the way to the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Statics {
    /// What had been applied: "pretension", "gravity" or "load".
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

/// How much of the outer loads acts.
#[derive(Clone, Copy, Debug)]
struct Load {
    gravity: f64,
    torque: f64,
}

/// Residual at which an iteration ends, relative to the largest link tension.
const CONVERGED: f64 = 1e-9;
/// Residual that is accepted where rounding keeps the iteration from going further.
const ACCEPTED: f64 = 1e-6;

/// Share of gravity or load below which the path of equilibria is taken to have ended.
const LEAST_SHARE: f64 = 1e-3;

/// Brings `q` into equilibrium: pretension first, then gravity, then load.
pub(super) fn settle(system: &mut System, q: &mut Vec<f64>) -> Result<Vec<Statics>, AssemblyError> {
    let unknowns = Unknowns::new(system);
    if unknowns.count == 0 {
        return Ok(Vec::new());
    }
    let mut statics = Vec::new();
    let taut = {
        let tensions = tensions(system, q);
        let links = tensions.len();
        let slack = (1e-6 * weight(system)).max(1e3 * links as f64 * rounding(system, q));
        tensions.iter().sum::<f64>() > slack
    };
    let mut at = Load {
        gravity: 0.0,
        torque: 0.0,
    };
    let newton = Newton {
        system,
        unknowns: &unknowns,
    };
    if taut {
        let mut found = newton.solve(q, at, 300);
        if found.residual >= ACCEPTED {
            found = newton.descend(q, at);
        }
        *q = Newton::accept(found, "pretension", &mut statics)?;
    }
    let stages: [(&'static str, bool); 2] = [
        ("gravity", system.gravity != Vector::zeros()),
        ("load", has_load(system)),
    ];
    for (stage, present) in stages {
        let only = stage == "load" && statics.is_empty();
        if !(present || only) {
            continue;
        }
        // A slack chain has no stiffness across itself until its weight is on it.
        let mut step = if taut { 0.25 } else { 1.0 };
        let mut share = 0.0_f64;
        while share < 1.0 {
            let next = (share + step).min(1.0);
            let mut load = at;
            match stage {
                "gravity" => load.gravity = next,
                _ => load.torque = next,
            }
            let found = newton.solve(q, load, 120);
            if found.residual < ACCEPTED {
                share = next;
                step *= 1.8;
                q.clone_from(&found.q);
                if share >= 1.0 {
                    Newton::accept(found, stage, &mut statics)?;
                }
            } else {
                step *= 0.35;
                if step < LEAST_SHARE {
                    // The path ends here: let go with all of the load on.
                    match stage {
                        "gravity" => load.gravity = 1.0,
                        _ => load.torque = 1.0,
                    }
                    *q = Newton::accept(newton.descend(q, load), stage, &mut statics)?;
                    share = 1.0;
                }
            }
        }
        match stage {
            "gravity" => at.gravity = 1.0,
            _ => at.torque = 1.0,
        }
    }
    if system.links.closed {
        let n = system.stride;
        for ghost in system.rollers..n {
            q[ghost] = q[ghost % system.rollers];
            q[n + ghost] = q[n + ghost % system.rollers];
        }
    }
    Ok(statics)
}

/// Second derivatives of the energy at a state under full gravity and load.
#[derive(Clone, Debug)]
pub(crate) struct Curvature {
    /// State entry of every row.
    pub(crate) entries: Vec<usize>,
    /// ∂²E/∂q², rows and columns as in `entries`.
    pub(crate) hessian: DMatrix<f64>,
    /// Largest force out of balance, relative to the largest link tension.
    pub(crate) residual: f64,
}

/// The Hessian with which [`settle`] iterates, dense.
pub(crate) fn curvature(system: &System, q: &[f64]) -> Curvature {
    let unknowns = Unknowns::new(system);
    let newton = Newton {
        system,
        unknowns: &unknowns,
    };
    let full = Load {
        gravity: 1.0,
        torque: 1.0,
    };
    let balance = newton.balance(q, full);
    let mut hessian = DMatrix::zeros(unknowns.count, unknowns.count);
    for &(i, j, value) in &balance.entries {
        hessian[(i, j)] += value;
    }
    let mut entries = vec![0; unknowns.count];
    for (entry, row) in unknowns.row.iter().enumerate() {
        if let Some(row) = row {
            entries[*row] = entry;
        }
    }
    Curvature {
        entries,
        hessian,
        residual: newton.residual(q, &balance),
    }
}

fn weight(system: &System) -> f64 {
    let mass: f64 = system.masses[..system.rollers].iter().sum();
    (mass * system.gravity.norm()).max(1e-9)
}

/// Force \[N\] that the rounding of coordinates alone may leave in a link.
fn rounding(system: &System, q: &[f64]) -> f64 {
    let farthest = q[..2 * system.stride]
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    let stiffest = system.links.stiffness.iter().copied().fold(0.0, f64::max);
    4.0 * f64::EPSILON * farthest * stiffest
}

fn has_load(system: &System) -> bool {
    let torque = system.wheels.iter().any(|wheel| {
        matches!(&wheel.rotation, WheelRotation::Free { drive, load, .. }
            if !drive.is_empty() || !load.is_empty())
    });
    torque
        || system
            .ends
            .iter()
            .any(|held| matches!(held.end, End::Pulled { .. }))
}

fn tensions(system: &System, q: &[f64]) -> Vec<f64> {
    let still = vec![0.0; q.len()];
    let mut none = vec![0.0; q.len()];
    let rollers = system.view(q, &still, &mut none);
    (0..system.links.count)
        .map(|link| {
            let next = (link + 1) % system.rollers;
            let length = (rollers.place(next) - rollers.place(link)).norm();
            system.links.stiffness[link] * (length - system.links.rest[link])
        })
        .collect()
}

/// Which entries of the state are unknown, and where they stand in the linear system.
struct Unknowns {
    /// State entry → row.
    row: Vec<Option<usize>>,
    count: usize,
    /// Squared lever \[m²\] that turns the row's unit into metres: 1 for rollers, R² for angles.
    scale: Vec<f64>,
}

impl Unknowns {
    fn new(system: &System) -> Self {
        let mut row = vec![None; system.dofs];
        let mut scale = Vec::new();
        let n = system.rollers;
        let folded = (0..n.div_ceil(2)).flat_map(|i| [i, n - 1 - i]);
        let mut add = |entry: usize, lever: f64, scale: &mut Vec<f64>| {
            if row[entry].is_none() {
                row[entry] = Some(scale.len());
                scale.push(lever);
            }
        };
        for roller in folded {
            if system.inverse_masses[roller] > 0.0 {
                add(roller, 1.0, &mut scale);
                add(system.stride + roller, 1.0, &mut scale);
            }
        }
        for wheel in &system.wheels {
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                add(dof, wheel.pitch_radius * wheel.pitch_radius, &mut scale);
            }
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                add(dof, 1.0, &mut scale);
                add(dof + 1, 1.0, &mut scale);
            }
        }
        for slide in &system.slides {
            if let Some(dof) = slide.dof {
                add(dof, arm_length(slide).powi(2), &mut scale);
            }
        }
        Self {
            row,
            count: scale.len(),
            scale,
        }
    }
}

/// Length that turns the coordinate of a carrier into metres.
fn arm_length(slide: &Slide) -> f64 {
    match &slide.carrier {
        crate::Carrier::Slider { .. } => 1.0,
        crate::Carrier::Arm { pivot, plunger } => {
            plunger.map_or(0.1, |plunger| (plunger.at - pivot).norm().max(1e-3))
        }
    }
}

/// Gradient and Hessian of the energy.
struct Balance {
    gradient: DVector<f64>,
    entries: Vec<(usize, usize, f64)>,
    contacts: Vec<usize>,
    tensions: Vec<f64>,
}

/// Outcome of an iteration.
struct Found {
    q: Vec<f64>,
    iterations: usize,
    residual: f64,
    tensions: Vec<f64>,
    contacts: Vec<usize>,
}

struct Newton<'a> {
    system: &'a System,
    unknowns: &'a Unknowns,
}

impl Newton<'_> {
    fn accept(
        found: Found,
        stage: &'static str,
        statics: &mut Vec<Statics>,
    ) -> Result<Vec<f64>, AssemblyError> {
        if found.residual >= ACCEPTED || found.residual.is_nan() {
            return Err(AssemblyError::NoEquilibrium {
                stage,
                residual: found.residual,
                iterations: found.iterations,
            });
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
    fn solve(&self, start: &[f64], load: Load, most: usize) -> Found {
        let stiffness = self
            .system
            .links
            .stiffness
            .iter()
            .copied()
            .fold(0.0, f64::max);
        let cap = self.longest();
        let mut q = start.to_vec();
        let mut shift = 1e-7 * stiffness;
        let mut balance = self.balance(&q, load);
        let mut residual = self.residual(&q, &balance);
        let mut best = (residual, q.clone());
        let mut iterations = 0;
        while iterations < most && residual > CONVERGED {
            let Some(step) = self.step(&balance, &mut shift, stiffness) else {
                break;
            };
            let factor = (cap / self.farthest(&step)).min(1.0);
            self.go(&mut q, &step, factor);
            balance = self.balance(&q, load);
            let now = self.residual(&q, &balance);
            if !now.is_finite() {
                break;
            }
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
        let (residual, q) = best;
        let balance = self.balance(&q, load);
        Found {
            q,
            iterations,
            residual,
            tensions: balance.tensions,
            contacts: balance.contacts,
        }
    }

    /// Longest step of a roller \[m\]: a fifth of the radius that touches the teeth.
    fn longest(&self) -> f64 {
        let wheel = self.system.wheels.first();
        0.2 * wheel.map_or(self.system.pitch, |wheel| wheel.contacts.radius)
    }

    /// How far a step moves anything \[m\].
    fn farthest(&self, step: &[f64]) -> f64 {
        let scaled = step.iter().zip(&self.unknowns.scale);
        scaled
            .map(|(s, lever)| s.abs() * lever.sqrt())
            .fold(0.0, f64::max)
    }

    /// Moves along a share of a step.
    fn go(&self, q: &mut [f64], step: &[f64], share: f64) {
        for (entry, row) in self.unknowns.row.iter().enumerate() {
            if let Some(row) = row {
                q[entry] += share * step[*row];
            }
        }
    }

    fn residual(&self, q: &[f64], balance: &Balance) -> f64 {
        let tension = balance.tensions.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let mass = self.system.masses[..self.system.rollers]
            .iter()
            .copied()
            .fold(0.0, f64::max);
        // What rounding leaves in an unloaded chain is accepted.
        let floor = (rounding(self.system, q) / ACCEPTED).max(1e-9);
        let scale = tension.max(mass * self.system.gravity.norm()).max(floor);
        let scaled = balance.gradient.iter().zip(&self.unknowns.scale);
        scaled
            .map(|(g, lever)| (g / lever.sqrt()).abs())
            .fold(0.0, f64::max)
            / scale
    }

    /// −(H + λ D)⁻¹ ∇E, raising λ until the matrix is positive definite.
    fn step(&self, balance: &Balance, shift: &mut f64, stiffness: f64) -> Option<Vec<f64>> {
        let n = self.unknowns.count;
        while *shift < 1e3 * stiffness {
            let mut matrix = CooMatrix::new(n, n);
            for &(i, j, value) in &balance.entries {
                matrix.push(i, j, value);
            }
            for (i, lever) in self.unknowns.scale.iter().enumerate() {
                matrix.push(i, i, *shift * lever);
            }
            if let Ok(factor) = CscCholesky::factor(&CscMatrix::from(&matrix)) {
                let step = factor.solve(&(-&balance.gradient));
                return Some(step.iter().copied().collect());
            }
            *shift *= 10.0;
        }
        None
    }

    fn balance(&self, q: &[f64], load: Load) -> Balance {
        let mut sum = Sum {
            row: &self.unknowns.row,
            balance: Balance {
                gradient: DVector::zeros(self.unknowns.count),
                entries: Vec::new(),
                contacts: vec![0; self.system.wheels.len()],
                tensions: Vec::with_capacity(self.system.links.count),
            },
        };
        self.add_links(q, load, &mut sum);
        self.add_bodies(q, load, &mut sum);
        contact::add_contacts(self.system, q, &mut sum);
        sum.balance
    }

    fn add_links(&self, q: &[f64], load: Load, sum: &mut Sum<'_>) {
        let system = self.system;
        let n = system.stride;
        let place = |i: usize| Point::new(q[i], q[n + i]);
        for link in 0..system.links.count {
            let (a, b) = (link, (link + 1) % system.rollers);
            let d = place(b) - place(a);
            let length = d.norm();
            let u = d / length;
            let stiffness = system.links.stiffness[link];
            let tension = stiffness * (length - system.links.rest[link]);
            sum.balance.tensions.push(tension);
            let (ends, signs) = ([[a, n + a], [b, n + b]], [-1.0, 1.0]);
            for (end, sign) in ends.iter().zip(signs) {
                for (axis, &entry) in end.iter().enumerate() {
                    sum.force(entry, sign * tension * u[axis]);
                }
            }
            // K = k u uᵀ + (T/ℓ) (1 − u uᵀ)
            for i in 0..2 {
                for j in 0..2 {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    let value = stiffness * u[i] * u[j] + tension / length * (unit - u[i] * u[j]);
                    for (first, s) in ends.iter().zip(signs) {
                        for (second, t) in ends.iter().zip(signs) {
                            sum.stiffen(first[i], second[j], s * t * value);
                        }
                    }
                }
            }
        }
        for i in 0..system.rollers {
            sum.force(i, -load.gravity * system.masses[i] * system.gravity.x);
            sum.force(n + i, -load.gravity * system.masses[i] * system.gravity.y);
        }
        for held in &system.ends {
            if let End::Pulled { force } = &held.end {
                sum.force(held.roller, -load.torque * force.x);
                sum.force(n + held.roller, -load.torque * force.y);
            }
        }
    }

    fn add_bodies(&self, q: &[f64], load: Load, sum: &mut Sum<'_>) {
        let system = self.system;
        let still = vec![0.0; q.len()];
        for wheel in &system.wheels {
            if let WheelRotation::Free {
                dof,
                drive,
                load: loads,
            } = &wheel.rotation
            {
                let angle = q[*dof] - wheel.angle;
                let torque: f64 = drive
                    .iter()
                    .chain(loads)
                    .map(|m| m.at(0.0, angle, 0.0))
                    .sum();
                sum.force(*dof, -load.torque * torque);
            }
            if let WheelSupport::Springs { dof, stiffness, .. } = &wheel.support {
                for axis in 0..2 {
                    let away = q[dof + axis] - wheel.centre[axis];
                    let weight = load.gravity * wheel.mass * system.gravity[axis];
                    sum.force(dof + axis, stiffness[axis] * away - weight);
                    sum.stiffen(dof + axis, dof + axis, stiffness[axis]);
                }
            }
        }
        for slide in &system.slides {
            let Some(dof) = slide.dof else { continue };
            let s = q[dof];
            let (extension, lever) = slide.carrier.extension(s);
            let force = slide.push.force(extension, 0.0).elastic;
            let h = 1e-6;
            // The lever of a plunger changes slowly with the angle of its arm.
            let bend =
                (slide.carrier.extension(s + h).1 - slide.carrier.extension(s - h).1) / (2.0 * h);
            sum.force(dof, -force * lever);
            sum.stiffen(
                dof,
                dof,
                slide.push.stiffness() * lever * lever - force * bend,
            );
            let pose = slide.pose(q, &still);
            for (mass, at_rest) in &slide.weights {
                let weight = system.gravity * (*mass * load.gravity);
                let (place, _) = slide.carry(pose, *at_rest);
                sum.force(dof, -slide.project([weight.x, weight.y], place));
                if let crate::Carrier::Arm { pivot, .. } = &slide.carrier {
                    // ∂²(−m g·x)/∂φ² = m g·r
                    sum.stiffen(dof, dof, weight.dot(&(place - pivot)));
                }
            }
        }
    }
}

/// Collects derivatives by state entry; those of held entries are dropped.
struct Sum<'a> {
    row: &'a [Option<usize>],
    balance: Balance,
}

impl Sum<'_> {
    /// Adds to ∂E/∂q.
    fn force(&mut self, entry: usize, value: f64) {
        if let Some(row) = self.row[entry] {
            self.balance.gradient[row] += value;
        }
    }

    /// Adds to ∂²E/∂q².
    fn stiffen(&mut self, first: usize, second: usize, value: f64) {
        if let (Some(i), Some(j)) = (self.row[first], self.row[second]) {
            self.balance.entries.push((i, j, value));
        }
    }
}

/// A moment at rest.
fn at_rest<'a>(q: &'a [f64], still: &'a [f64]) -> Moment<'a> {
    Moment {
        t: 0.0,
        q,
        v: still,
    }
}
