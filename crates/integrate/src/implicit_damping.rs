//! Implicit damping: damping taken at the end of the step, stiffness at its beginning.

use pulp::{Arch, Simd, WithSimd};

use crate::finite::Watch;
use crate::method::Outcome;
use crate::registers::dispatch;
use crate::state::{Snapshot, State};
use crate::{Moment, SecondOrderSystem, Statistics, Weights};

/// Limit of ωh, whatever the damping.
pub(crate) const LIMIT: f64 = 2.0;

/// Makes a candidate h \[s\] ahead; `fresh` tells whether the record still belongs to the beginning.
///
/// ```text
/// (M + h C) Δv = h f(t, q, v)
/// v⁺ = v + Δv
/// q⁺ = q + h v⁺
/// ```
///
/// One evaluation and one solution of linear equations; a candidate after a rejected one costs an evaluation more.
/// Of first order in the damping. Without damping it is the symplectic Euler method, which is
/// leapfrog with velocities half a step early: bounded energy error, no drift. The characteristic
/// polynomial of a mode, (1 + hλ)(z − 1)² + h (ω² h z + λ (z − 1)) with its damping rate λ = c/m, has its
/// roots within the unit circle for (ωh)² < 2 (2 + λh).
///
/// # Source
/// Symplectic Euler: E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, Springer, 2006, section I.1;
/// damping by one Newton step of the implicit Euler method:
/// U. M. Ascher, S. J. Ruuth and B. T. R. Wetton, *SIAM J. Numer. Anal.* **32**, 1995, 797–823.
pub(crate) fn attempt<S: SecondOrderSystem>(
    system: &S,
    from: &State,
    h: f64,
    fresh: bool,
    to: &mut Snapshot,
    record: &mut S::Record,
    counts: &mut Statistics,
) -> Outcome {
    if !fresh {
        // C belongs to the beginning; the candidate's buffers take what is known already.
        let begin = Moment {
            t: from.t,
            q: &from.q,
            v: &from.v,
        };
        system.evaluate(begin, &mut to.a, &mut to.rates, record);
        counts.evaluations += 1;
    }
    to.t = from.t + h;
    // x = (M + h C)⁻¹ M (h a)
    for (x, a) in to.v.iter_mut().zip(&from.a) {
        *x = h * a;
    }
    let weights = Weights {
        damping: h,
        stiffness: 0.0,
    };
    counts.solves += 1;
    if !system.solve(weights, record, &mut to.v) {
        return Outcome::NoSolution;
    }
    let arch = Arch::new();
    dispatch(arch, Ahead { h, from, to });
    let end = Moment {
        t: to.t,
        q: &to.q,
        v: &to.v,
    };
    system.evaluate(end, &mut to.a, &mut to.rates, record);
    counts.evaluations += 1;
    to.trapezoidal(from, h);
    Outcome::of(dispatch(arch, Finite(to)))
}

/// v⁺ = v + x,   q⁺ = q + h v⁺
struct Ahead<'a> {
    h: f64,
    from: &'a State,
    to: &'a mut Snapshot,
}

impl WithSimd for Ahead<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let before = self.from.q.iter().zip(&self.from.v);
        let after = self.to.q.iter_mut().zip(&mut self.to.v);
        for ((q, v), (q0, v0)) in after.zip(before) {
            *v += v0;
            *q = q0 + self.h * *v;
        }
    }
}

/// Whether a candidate is finite.
struct Finite<'a>(&'a Snapshot);

impl WithSimd for Finite<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let mut watch = Watch::default();
        for part in [&self.0.q, &self.0.v, &self.0.a, &self.0.quadratures] {
            for value in part {
                watch.see(*value);
            }
        }
        watch.all_finite()
    }
}
