//! A mass on a spring whose foot leaks: a state of first order in series with the motion.

use chaindrive_integrate::{Moment, SecondOrderSystem, State, Weights};

use super::Smooth;

/// A driven mass on two springs; the foot z of the second gives way, the faster the harder it is pulled.
///
/// ```text
/// q̈ = −q − F + D(t),   F = κ (q − z),   ż = (F + F³)/τ + g q̇
/// ```
#[derive(Clone)]
pub(crate) struct Leaking {
    /// Time in which the foot settles: τ/κ.
    pub(crate) settling: f64,
}

/// ∂ż/∂F, at the last evaluation.
pub(crate) type Slope = f64;

impl Leaking {
    const STIFFNESS: f64 = 4.0;
    const DRAG: f64 = 0.2;

    fn drive(t: f64) -> f64 {
        0.7 * (1.3 * t).cos()
    }

    /// Energy minus the work of the drive plus what the foot took; constant.
    pub(crate) fn ledger(state: &State) -> f64 {
        let [q, v, z] = [state.q[0], state.v[0], state.z[0]];
        let stored = 0.5 * (v * v + q * q + Self::STIFFNESS * (q - z) * (q - z));
        let along = |i: usize| state.quadratures.get(i).copied().unwrap_or(0.0);
        stored - along(0) + along(1)
    }
}

impl SecondOrderSystem for Leaking {
    type Record = Slope;
    fn new_record(&self) -> Slope {
        0.0
    }
    fn dofs(&self) -> usize {
        1
    }
    fn quadratures(&self) -> usize {
        2
    }
    fn states(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], slope: &mut Slope) {
        let (q, v, z) = (at.q[0], at.v[0], at.z[0]);
        let tau = Self::STIFFNESS * self.settling;
        let force = Self::STIFFNESS * (q - z);
        *slope = (1.0 + 3.0 * force * force) / tau;
        let flow = (force + force.powi(3)) / tau + Self::DRAG * v;
        a[0] = -q - force + Self::drive(at.t);
        rates.copy_from_slice(&[Self::drive(at.t) * v, force * flow, flow]);
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, slope: &mut Slope, x: &mut [f64]) -> bool {
        let Weights {
            damping: c,
            stiffness: k,
            ..
        } = weights;
        let kappa = Self::STIFFNESS;
        // y = (y₀ + (c ∂ż/∂q̇ + k ∂ż/∂q) x)/(1 − c ∂ż/∂z),   ∂ż/∂q = κ ∂ż/∂F = −∂ż/∂z
        let own = 1.0 + c * kappa * *slope;
        let coupling = c * Self::DRAG + k * kappa * *slope;
        // (1 + k (1 + κ)) x − c κ y = x₀
        x[0] = (x[0] + c * kappa * x[1] / own)
            / (1.0 + k * (1.0 + kappa) - c * kappa * coupling / own);
        x[1] = (x[1] + coupling * x[0]) / own;
        true
    }
}

impl Smooth for Leaking {
    fn start(&self) -> State {
        State::new(0.0, vec![1.2], vec![0.3]).with_states(vec![1.2])
    }
    fn duration(&self) -> f64 {
        8.0
    }
    fn exact(&self, _: f64) -> Option<Vec<f64>> {
        None
    }
}
