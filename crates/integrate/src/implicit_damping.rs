//! Implicit damping: damping taken at the end of the step, stiffness at its beginning.

use crate::finite::Watch;
use crate::method::Outcome;
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
    let n = to.q.len();
    let (q0, v0) = (&from.q[..n], &from.v[..n]);
    for i in 0..n {
        // v⁺ = v + x,   q⁺ = q + h v⁺
        to.v[i] += v0[i];
        to.q[i] = q0[i] + h * to.v[i];
    }
    let end = Moment {
        t: to.t,
        q: &to.q,
        v: &to.v,
    };
    system.evaluate(end, &mut to.a, &mut to.rates, record);
    counts.evaluations += 1;
    to.trapezoidal(from, h);
    let mut watch = Watch::default();
    for part in [&to.q, &to.v, &to.a, &to.quadratures] {
        watch.see_all(part);
    }
    Outcome::of(watch.all_finite())
}
