//! Velocity Verlet with velocities predicted for the force evaluation.

use pulp::{Arch, Simd, WithSimd};

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
    /// The processor's vector unit.
    arch: Arch,
}

impl Verlet {
    pub(crate) fn new(dofs: usize) -> Self {
        Self {
            predicted: vec![0.0; dofs],
            arch: Arch::new(),
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
        let mut watch = self.arch.dispatch(Drift {
            h,
            from,
            q: &mut to.q,
            predicted: &mut self.predicted,
        });
        let end = Moment {
            t: to.t,
            q: &to.q,
            v: &self.predicted,
        };
        system.evaluate(end, &mut to.a, &mut to.rates, record);
        watch.join(self.arch.dispatch(Kick {
            h,
            from,
            a: &to.a,
            v: &mut to.v,
        }));
        // The trapezoidal rule: y⁺ = y + ½ h (r + r⁺)
        for (i, y) in to.quadratures.iter_mut().enumerate() {
            *y = from.quadratures[i] + 0.5 * h * (from.rates[i] + to.rates[i]);
            watch.see(*y);
        }
        watch.all_finite()
    }
}

/// Positions and predicted velocities.
struct Drift<'a> {
    h: f64,
    from: &'a State,
    q: &'a mut [f64],
    predicted: &'a mut [f64],
}

impl WithSimd for Drift<'_> {
    type Output = Watch;

    // Inlined where the processor is known: a plain loop becomes lanes there.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Watch {
        let Self { h, from, .. } = self;
        let n = self.q.len();
        let (q0, v0, a0) = (&from.q[..n], &from.v[..n], &from.a[..n]);
        let (q, predicted) = (self.q, &mut self.predicted[..n]);
        let mut seen = Watch::default();
        for i in 0..n {
            // q⁺ = q + h v + ½ h² a,   v* = v + h a
            q[i] = q0[i] + h * (v0[i] + 0.5 * h * a0[i]);
            predicted[i] = v0[i] + h * a0[i];
            seen.see(q[i]);
        }
        seen
    }
}

/// Velocities.
struct Kick<'a> {
    h: f64,
    from: &'a State,
    a: &'a [f64],
    v: &'a mut [f64],
}

impl WithSimd for Kick<'_> {
    type Output = Watch;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Watch {
        let Self { h, from, v, .. } = self;
        let n = v.len();
        let (v0, a0, a) = (&from.v[..n], &from.a[..n], &self.a[..n]);
        let mut seen = Watch::default();
        for i in 0..n {
            // v⁺ = v + ½ h (a + a⁺)
            v[i] = v0[i] + 0.5 * h * (a0[i] + a[i]);
            seen.see(v[i]);
        }
        seen
    }
}
