//! Velocity Verlet with velocities predicted for the force evaluation.

use crate::finite::Watch;
use crate::state::{Snapshot, State};
use crate::{Moment, SecondOrderSystem};

/// Limit of ωh.
pub(crate) const LIMIT: f64 = 2.0;

/// Work space of the method.
#[derive(Clone, Debug)]
pub(crate) struct Verlet {
    /// Predicted velocities.
    predicted: Vec<f64>,
}

impl Verlet {
    pub(crate) fn new(dofs: usize) -> Self {
        Self {
            predicted: vec![0.0; dofs],
        }
    }

    /// Makes a candidate h \[s\] ahead; false if a position or velocity is not finite.
    ///
    /// ```text
    /// q⁺ = q + h v + ½ h² a
    /// v* = v + h a
    /// a⁺ = a(t + h, q⁺, v*)
    /// v⁺ = v + ½ h (a + a⁺)
    /// ```
    ///
    /// Of second order although a⁺ belongs to v*: the predicted velocity is off by O(h²). With damping
    /// λ the scheme is stable for (ωh)²/4 + λh < 1.
    ///
    /// # Source
    /// W. C. Swope et al., *J. Chem. Phys.* **76**, 1982, 637–649,
    /// <https://doi.org/10.1063/1.442716>; the prediction for dissipative forces after
    /// R. D. Groot and P. B. Warren, *J. Chem. Phys.* **107**, 1997, 4423–4435.
    pub(crate) fn attempt<S: SecondOrderSystem>(
        &mut self,
        system: &S,
        from: &State,
        h: f64,
        to: &mut Snapshot,
        record: &mut S::Record,
    ) -> bool {
        to.t = from.t + h;
        let mut watch = Watch::default();
        drift(h, from, &mut to.q, &mut self.predicted, &mut watch);
        let end = Moment {
            t: to.t,
            q: &to.q,
            v: &self.predicted,
        };
        system.evaluate(end, &mut to.a, &mut to.rates, record);
        kick(h, from, &to.a, &mut to.v, &mut watch);
        // The trapezoidal rule: y⁺ = y + ½ h (r + r⁺)
        for (i, y) in to.quadratures.iter_mut().enumerate() {
            *y = from.quadratures[i] + 0.5 * h * (from.rates[i] + to.rates[i]);
            watch.see(*y);
        }
        watch.all_finite()
    }
}

/// Positions and predicted velocities.
#[inline]
fn drift(h: f64, from: &State, q: &mut [f64], predicted: &mut [f64], watch: &mut Watch) {
    let n = q.len();
    let (q0, v0, a0) = (&from.q[..n], &from.v[..n], &from.a[..n]);
    let predicted = &mut predicted[..n];
    let mut seen = *watch;
    for i in 0..n {
        // q⁺ = q + h v + ½ h² a,   v* = v + h a
        q[i] = q0[i] + h * (v0[i] + 0.5 * h * a0[i]);
        predicted[i] = v0[i] + h * a0[i];
        seen.see(q[i]);
    }
    *watch = seen;
}

/// Velocities.
#[inline]
fn kick(h: f64, from: &State, a: &[f64], v: &mut [f64], watch: &mut Watch) {
    let n = v.len();
    let (v0, a0, a) = (&from.v[..n], &from.a[..n], &a[..n]);
    let mut seen = *watch;
    for i in 0..n {
        // v⁺ = v + ½ h (a + a⁺)
        v[i] = v0[i] + 0.5 * h * (a0[i] + a[i]);
        seen.see(v[i]);
    }
    *watch = seen;
}
