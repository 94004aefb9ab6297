//! Explicit Runge–Kutta methods on any tableau, for systems of second order.

use crate::finite::Watch;
use crate::state::{Size, Snapshot, State};
use crate::tableau::Tableau;
use crate::tolerance::Tolerance;
use crate::{Moment, SecondOrderSystem};

/// Limit of ωh for the classical method: 2.78 on the real axis, 2.83 on the imaginary one.
pub(crate) const RK4_LIMIT: f64 = 2.78;

/// Work space of the method.
#[derive(Clone, Debug)]
pub(crate) struct RungeKutta {
    tableau: &'static Tableau,
    /// Positions of the stage being evaluated.
    q: Vec<f64>,
    /// First-order states there.
    z: Vec<f64>,
    /// Velocities, accelerations and rates of stages 2, 3, …; those of stage 1 are the state's.
    stages: Vec<Stage>,
}

/// Derivatives of one stage: q̇ = v, q̇̇ = a, those of quadratures and states in `rates`.
#[derive(Clone, Debug)]
struct Stage {
    v: Vec<f64>,
    a: Vec<f64>,
    rates: Vec<f64>,
}

impl RungeKutta {
    pub(crate) fn new(tableau: &'static Tableau, size: Size) -> Self {
        let dofs = size.dofs;
        let stage = Stage {
            v: vec![0.0; dofs],
            a: vec![0.0; dofs],
            rates: vec![0.0; size.quadratures + size.states],
        };
        Self {
            tableau,
            q: vec![0.0; dofs],
            z: vec![0.0; size.states],
            stages: vec![stage; tableau.b.len() - 1],
        }
    }

    /// Evaluations a candidate costs: all stages but the first, and the end.
    pub(crate) fn cost(&self) -> u64 {
        self.tableau.b.len() as u64
    }

    /// Makes a candidate h \[s\] ahead; false if a position or velocity is not finite.
    pub(crate) fn attempt<S: SecondOrderSystem>(
        &mut self,
        system: &S,
        from: &State,
        h: f64,
        to: &mut Snapshot,
        record: &mut S::Record,
    ) -> bool {
        let Tableau { c, a, b, .. } = *self.tableau;
        let first = from.quadratures.len();
        for i in 1..b.len() {
            // kᵢ = f(t + cᵢ h, y + h Σⱼ aᵢⱼ kⱼ)
            let (done, rest) = self.stages.split_at_mut(i - 1);
            let stage = &mut rest[0];
            combine(h, a[i], &from.q, &from.v, done, |k| &k.v, &mut self.q);
            combine(h, a[i], &from.v, &from.a, done, |k| &k.a, &mut stage.v);
            let (z, flow) = (&from.z, from.flow());
            combine(h, a[i], z, flow, done, |k| &k.rates[first..], &mut self.z);
            let at = Moment {
                t: from.t + c[i] * h,
                q: &self.q,
                v: &stage.v,
                z: &self.z,
            };
            system.evaluate(at, &mut stage.a, &mut stage.rates, record);
        }
        // y⁺ = y + h Σ bᵢ kᵢ
        let stages = &self.stages;
        combine(h, b, &from.q, &from.v, stages, |k| &k.v, &mut to.q);
        combine(h, b, &from.v, &from.a, stages, |k| &k.a, &mut to.v);
        let (y, rates) = (&from.quadratures, &from.rates);
        combine(h, b, y, rates, stages, |k| &k.rates, &mut to.quadratures);
        let (z, flow) = (&from.z, from.flow());
        combine(h, b, z, flow, stages, |k| &k.rates[first..], &mut to.z);
        to.t = from.t + h;
        // The last stage stands at the end: its derivatives are those that the next step begins with.
        to.evaluate(system, record);
        let mut watch = Watch::default();
        for part in [&to.q, &to.v, &to.a, &to.quadratures, &to.z] {
            watch.see_all(part);
        }
        watch.all_finite()
    }

    /// Estimated error of a candidate in units of the tolerance; the worst coordinate counts.
    pub(crate) fn error(&self, from: &State, h: f64, to: &Snapshot, tolerance: Tolerance) -> f64 {
        let weights = self.tableau.error;
        let (stages, last) = (&self.stages, weights.len() - 1);
        let mut worst: f64 = 0.0;
        for i in 0..to.q.len() {
            // error = h Σ eᵢ kᵢ
            let mut position = weights[0] * from.v[i] + weights[last] * to.v[i];
            let mut velocity = weights[0] * from.a[i] + weights[last] * to.a[i];
            for (weight, stage) in weights[1..last].iter().zip(stages) {
                position += weight * stage.v[i];
                velocity += weight * stage.a[i];
            }
            worst = worst
                .max(tolerance.position(h * position, from.q[i], to.q[i]))
                .max(tolerance.velocity(h * velocity, from.v[i], to.v[i]));
        }
        let first = from.quadratures.len();
        for (i, (before, after)) in from.z.iter().zip(&to.z).enumerate() {
            let mut change = weights[0] * from.flow()[i] + weights[last] * to.flow()[i];
            for (weight, stage) in weights[1..last].iter().zip(stages) {
                change += weight * stage.rates[first + i];
            }
            worst = worst.max(tolerance.position(h * change, *before, *after));
        }
        worst
    }
}

/// y + h (w₁ k₁ + w₂ k₂ + …), with k₁ from the state and the others from the stages.
#[inline]
fn combine(
    h: f64,
    weights: &[f64],
    base: &[f64],
    first: &[f64],
    stages: &[Stage],
    part: impl Fn(&Stage) -> &[f64],
    sum: &mut [f64],
) {
    let n = sum.len();
    let weight = h * weights[0];
    for (out, (y, k)) in sum.iter_mut().zip(base[..n].iter().zip(&first[..n])) {
        *out = y + weight * k;
    }
    for (weight, stage) in weights[1..].iter().zip(stages) {
        if weight.abs() > 0.0 {
            let weight = h * weight;
            for (out, k) in sum.iter_mut().zip(part(stage)) {
                *out += weight * k;
            }
        }
    }
}
