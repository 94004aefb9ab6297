//! The generalized-α method: no limit of stability, and a chosen damping of what the step does not resolve.

use std::mem::swap;

use crate::finite::Watch;
use crate::outcome::Outcome;
use crate::state::{Size, Snapshot, State};
use crate::{SecondOrderSystem, Statistics, Weights};

/// Newton's iterations after which a candidate is given up; with exact derivatives three or four are usual.
const MOST_ITERATIONS: u32 = 10;

/// Change of the velocities at which Newton's iteration ends, in units of the largest velocity.
///
/// The largest serves all coordinates, since one at rest has no scale of its own. A thousand between metres and
/// radians still leaves seven digits, far below the error of any step that makes sense.
const TOLERANCE: f64 = 1e-10;

/// Change of the positions that is rounding, in units of the largest position: a few last places.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Work space of the method.
#[derive(Clone, Debug)]
pub(crate) struct GeneralizedAlpha {
    coefficients: Coefficients,
    /// Algorithmic accelerations A of the accepted state, and rates R of its first-order states.
    accepted: Vec<f64>,
    /// Algorithmic accelerations A⁺ and rates R⁺ of the candidate.
    trial: Vec<f64>,
    /// Newton's correction of A⁺ and R⁺.
    correction: Vec<f64>,
}

/// The four coefficients of the method.
///
/// ```text
/// αm = (2ρ − 1)/(ρ + 1),   αf = ρ/(ρ + 1),   γ = ½ − αm + αf,   β = ¼ (1 − αm + αf)²
/// ```
///
/// ρ is the spectral radius at ωh → ∞: 1 keeps what the step does not resolve, 0 annihilates it.
#[derive(Clone, Copy, Debug)]
struct Coefficients {
    inertia: f64,
    force: f64,
    beta: f64,
    gamma: f64,
}

impl Coefficients {
    fn new(spectral_radius: f64) -> Self {
        let rho = spectral_radius;
        // αm = (2ρ − 1)/(ρ + 1),   αf = ρ/(ρ + 1)
        let inertia = (2.0 * rho - 1.0) / (rho + 1.0);
        let force = rho / (rho + 1.0);
        let sum = 1.0 - inertia + force;
        Self {
            inertia,
            force,
            // β = ¼ (1 − αm + αf)²,   γ = ½ − αm + αf
            beta: 0.25 * sum * sum,
            gamma: sum - 0.5,
        }
    }

    /// Weights of the matrix (1 − αm) M + (1 − αf)(γ h C + β h² K) over 1 − αm.
    fn weights(self, h: f64) -> Weights {
        let ratio = (1.0 - self.force) / (1.0 - self.inertia);
        Weights {
            once: false,
            damping: ratio * self.gamma * h,
            stiffness: ratio * self.beta * h * h,
        }
    }
}

impl GeneralizedAlpha {
    pub(crate) fn new(spectral_radius: f64, size: Size) -> Self {
        let unknowns = size.dofs + size.states;
        Self {
            coefficients: Coefficients::new(spectral_radius),
            accepted: vec![0.0; unknowns],
            trial: vec![0.0; unknowns],
            correction: vec![0.0; unknowns],
        }
    }

    /// Begins afresh, after a jump or at the start: the algorithmic accelerations are the physical ones.
    pub(crate) fn restart(&mut self, state: &State) {
        let (a, flow) = self.accepted.split_at_mut(state.a.len());
        a.copy_from_slice(&state.a);
        flow.copy_from_slice(state.flow());
    }

    /// Goes on from what it carried.
    pub(crate) fn carry_on(&mut self, carried: &[f64]) {
        self.accepted.copy_from_slice(carried);
    }

    /// Algorithmic accelerations of the accepted state, and rates of its first-order states.
    pub(crate) fn carried(&self) -> &[f64] {
        &self.accepted
    }

    /// Takes the candidate's algorithmic accelerations for those of the accepted state.
    pub(crate) fn accept(&mut self) {
        swap(&mut self.accepted, &mut self.trial);
    }

    /// Makes a candidate h \[s\] ahead by Newton's iteration on A⁺, from A⁺ = A.
    ///
    /// ```text
    /// q⁺ = q + h v + h² [(½ − β) A + β A⁺]
    /// v⁺ = v + h [(1 − γ) A + γ A⁺]
    /// (1 − αm) A⁺ + αm A = (1 − αf) a⁺ + αf a,   a⁺ = a(t + h, q⁺, v⁺, z⁺)
    ///
    /// z⁺ = z + h [(1 − γ) R + γ R⁺]
    /// (1 − αm) R⁺ + αm R = (1 − αf) ż⁺ + αf ż
    /// ```
    ///
    /// First-order states share the coefficients, of second order there too since γ = ½ − αm + αf. Of a state that settles at once the
    /// step leaves the shares ρ and |1 − 3ρ|/(3 − ρ).
    /// Forces are weighted between the ends rather than taken in between: the same for linear forces, and the
    /// last evaluation is the one at the end that the system judges and commits. A jump starts A afresh; A lags or
    /// leads its state by a share of the step before, so a change of the step costs a little accuracy once.
    /// A mode with ωh ≫ 1 or λh ≫ 1 that is out of balance at the start or after a jump overshoots before it decays.
    ///
    /// # Source
    /// J. Chung and G. M. Hulbert, *J. Appl. Mech.* **60**, 1993, 371–375, <https://doi.org/10.1115/1.2900803>; weighted
    /// between the ends after M. Arnold and O. Brüls, *Multibody Syst. Dyn.* **18**, 2007, 185–202,
    /// <https://doi.org/10.1007/s11044-007-9084-0>; states of first order after K. E. Jansen, C. H. Whiting and
    /// G. M. Hulbert, *Comput. Methods Appl. Mech. Eng.* **190**, 2000, 305–319, <https://doi.org/10.1016/S0045-7825(00)00203-6>.
    pub(crate) fn attempt<S: SecondOrderSystem>(
        &mut self,
        system: &S,
        from: &State,
        h: f64,
        to: &mut Snapshot,
        record: &mut S::Record,
        counts: &mut Statistics,
    ) -> Outcome {
        let weights = self.coefficients.weights(h);
        to.t = from.t + h;
        self.trial.copy_from_slice(&self.accepted);
        for iteration in 0..MOST_ITERATIONS {
            // Where the present guess of A⁺ and R⁺ leads, and the forces there.
            self.place(h, from, to);
            to.evaluate(system, record);
            counts.evaluations += 1;
            let mut watch = Watch::default();
            for part in [&to.q, &to.v, &to.a, &to.z] {
                watch.see_all(part);
            }
            watch.see_all(to.flow());
            if !watch.all_finite() {
                // The first guess is as good as that of an explicit method; later ones may be Newton's fault.
                return if iteration == 0 {
                    Outcome::NotFinite
                } else {
                    Outcome::NoSolution
                };
            }
            // What is missing of the balance of forces, over the matrix of the step: the correction of the guess.
            self.imbalance(from, to);
            counts.solves += 1;
            if !system.solve(weights, record, &mut self.correction) {
                return Outcome::NoSolution;
            }
            watch.see_all(&self.correction);
            if !watch.all_finite() {
                return Outcome::NoSolution;
            }
            // Once corrected at least: in short steps even a wrong A⁺ hardly changes the velocities.
            if iteration > 0 && self.converged(h, from, to) {
                // Not corrected any more, so the record belongs to the candidate to the last bit.
                to.trapezoidal(from, h);
                watch.see_all(&to.quadratures);
                return Outcome::of(watch.all_finite());
            }
            for (trial, correction) in self.trial.iter_mut().zip(&self.correction) {
                *trial += correction;
            }
        }
        Outcome::NoSolution
    }

    /// Positions and velocities of the candidate.
    fn place(&self, h: f64, from: &State, to: &mut Snapshot) {
        let Coefficients { beta, gamma, .. } = self.coefficients;
        let n = to.q.len();
        let (q0, v0) = (&from.q[..n], &from.v[..n]);
        let (a0, a1) = (&self.accepted[..n], &self.trial[..n]);
        for i in 0..n {
            // q⁺ = q + h v + h² [(½ − β) A + β A⁺],   v⁺ = v + h [(1 − γ) A + γ A⁺]
            to.q[i] = q0[i] + h * (v0[i] + h * ((0.5 - beta) * a0[i] + beta * a1[i]));
            to.v[i] = v0[i] + h * ((1.0 - gamma) * a0[i] + gamma * a1[i]);
        }
        let rates = self.accepted[n..].iter().zip(&self.trial[n..]);
        for ((z, z0), (r0, r1)) in to.z.iter_mut().zip(&from.z).zip(rates) {
            // z⁺ = z + h [(1 − γ) R + γ R⁺]
            *z = z0 + h * ((1.0 - gamma) * r0 + gamma * r1);
        }
    }

    /// Residual of the accelerations a⁺ and the rates ż⁺, as the right-hand side of the correction.
    fn imbalance(&mut self, from: &State, to: &Snapshot) {
        let Coefficients { inertia, force, .. } = self.coefficients;
        let share = 1.0 / (1.0 - inertia);
        let rates = from.a.iter().chain(from.flow());
        let rates = rates.zip(to.a.iter().chain(to.flow()));
        for (i, (x, (before, after))) in self.correction.iter_mut().zip(rates).enumerate() {
            // (1 − αm) x = (1 − αf) a⁺ + αf a − αm A − (1 − αm) A⁺
            let weighted = (1.0 - force) * after + force * before - inertia * self.accepted[i];
            *x = share * weighted - self.trial[i];
        }
    }

    /// Whether the correction changes velocities or positions by nothing that counts.
    fn converged(&self, h: f64, from: &State, to: &Snapshot) -> bool {
        let largest = |values: &[f64]| {
            values
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()))
        };
        let (change, flow_change) = self.correction.split_at(to.q.len());
        let (trial, flow) = self.trial.split_at(to.q.len());
        let [change, flow_change] = [change, flow_change].map(largest);
        let speed = largest(&from.v).max(largest(&to.v)).max(h * largest(trial));
        let place = largest(&to.q);
        // h |ΔA| ≤ 1e-10 |v|   or   β h² |ΔA| ≤ 4ε |q|
        let settled = h * change <= TOLERANCE * speed
            || self.coefficients.beta * h * h * change <= ROUNDING * place;
        // h |ΔR| ≤ 1e-10 |z|   or   h |ΔR| ≤ 4ε |q|
        let state = largest(&to.z).max(h * largest(flow));
        settled && (h * flow_change <= TOLERANCE * state || h * flow_change <= ROUNDING * place)
    }
}
