//! Implicit damping: damping taken at the end of the step, stiffness at its beginning or carried as inertia.

use pulp::{Simd, WithSimd};

use crate::finite::Watch;
use crate::outcome::Outcome;
use crate::registers::Registers;
use crate::state::{Size, Snapshot, State};
use crate::{Moment, SecondOrderSystem, Statistics, Weights};

/// Limit of ωh of what a step does not carry, whatever the damping.
pub(crate) const LIMIT: f64 = 2.0;

/// Work space of the method.
#[derive(Clone, Debug)]
pub(crate) struct ImplicitDamping {
    /// Unknowns of the equations: Δv, then Δz.
    change: Vec<f64>,
}

impl ImplicitDamping {
    pub(crate) fn new(size: Size) -> Self {
        Self {
            change: vec![0.0; size.dofs + size.states],
        }
    }

    /// Makes a candidate h \[s\] ahead; `fresh` tells whether the record still belongs to the beginning.
    ///
    /// ```text
    /// (M + h C + h²/4 K) Δv − h ∂f/∂z Δz = h f(t, q, v, z)
    /// Δz − h ∂ż/∂z Δz − h ∂ż/∂q̇ Δv = h ż(t, q, v, z)
    /// v⁺ = v + Δv,   z⁺ = z + Δz
    /// q⁺ = q + h v⁺
    /// ```
    ///
    /// One evaluation and one solution of linear equations; a candidate after a rejected one costs an evaluation more.
    /// Of first order in the damping and in the states, which may settle as fast as they like. Without damping it is the
    /// symplectic Euler method, which is leapfrog with velocities half a step early: bounded energy error, no drift. The
    /// characteristic polynomial of a mode, (1 + hλ)(z − 1)² + h (ω² h z + λ (z − 1)) with its damping rate λ = c/m, has its
    /// roots within the unit circle for (ωh)² < 2 (2 + λh).
    ///
    /// That is so where the system leaves K out, as it may. Where it does not, springs are carried as inertia, h²/4 K: forces still
    /// belong to the beginning of the step, where their laws are exact, and the roots stay within the unit circle with every
    /// step. An undamped mode then swings at 2/h atan(ωh/2), as with the trapezoidal rule, of which this is the staggered form: what is much faster than the step
    /// is slowed down to it, and contacts that close faster than it resolves strike too hard.
    ///
    /// # Source
    /// Symplectic Euler: E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, Springer, 2006, section I.1;
    /// damping by one Newton step of the implicit Euler method:
    /// U. M. Ascher, S. J. Ruuth and B. T. R. Wetton, *SIAM J. Numer. Anal.* **32**, 1995, 797–823; the trapezoidal rule as leapfrog with another
    /// mass: T. J. R. Hughes, *The Finite Element Method*, Dover, 2000, section 9.1 (Newmark's family).
    #[expect(clippy::too_many_arguments, reason = "what every attempt is given")]
    pub(crate) fn attempt<S: SecondOrderSystem>(
        &mut self,
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
                z: &from.z,
            };
            system.evaluate(begin, &mut to.a, &mut to.rates, record);
            counts.evaluations += 1;
        }
        to.t = from.t + h;
        let registers = Registers::in_use();
        let change = &mut self.change;
        registers.dispatch(Right { h, from, change });
        let weights = Weights {
            damping: h,
            stiffness: 0.25 * h * h,
            once: true,
        };
        counts.solves += 1;
        if !system.solve(weights, record, &mut self.change) {
            return Outcome::NoSolution;
        }
        let change = &self.change;
        registers.dispatch(Ahead {
            h,
            from,
            change,
            to,
        });
        to.evaluate(system, record);
        counts.evaluations += 1;
        to.trapezoidal(from, h);
        Outcome::of(registers.dispatch(Finite(to)))
    }
}

/// The right-hand side of the equations, divided by the masses.
struct Right<'a> {
    h: f64,
    from: &'a State,
    change: &'a mut [f64],
}

impl WithSimd for Right<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (dv, dz) = self.change.split_at_mut(self.from.a.len());
        for (x, rates) in [(dv, &self.from.a[..]), (dz, self.from.flow())] {
            for (x, rate) in x.iter_mut().zip(rates) {
                *x = self.h * rate;
            }
        }
    }
}

/// v⁺ = v + Δv,   q⁺ = q + h v⁺,   z⁺ = z + Δz
struct Ahead<'a> {
    h: f64,
    from: &'a State,
    change: &'a [f64],
    to: &'a mut Snapshot,
}

impl WithSimd for Ahead<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let before = self.from.q.iter().zip(&self.from.v);
        let after = self.to.q.iter_mut().zip(&mut self.to.v);
        let (dv, dz) = self.change.split_at(self.from.q.len());
        for (((q, v), (q0, v0)), dv) in after.zip(before).zip(dv) {
            *v = dv + v0;
            *q = q0 + self.h * *v;
        }
        for ((z, z0), dz) in self.to.z.iter_mut().zip(&self.from.z).zip(dz) {
            *z = dz + z0;
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
        let to = self.0;
        // Places are as finite as the velocities that led there.
        for part in [&to.v, &to.a, &to.quadratures, &to.z] {
            for value in part {
                watch.see(*value);
            }
        }
        watch.all_finite()
    }
}
