//! Implicit damping: damping taken at the end of the step, stiffness at its beginning or carried as inertia.

use crate::finite::Watch;
use crate::kernel;
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
    /// What the forces of the solution do to the quadratures.
    works: Vec<f64>,
}

impl ImplicitDamping {
    pub(crate) fn new(size: Size) -> Self {
        Self {
            change: vec![0.0; size.dofs + size.states],
            works: vec![0.0; size.quadratures],
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
        // h f and h ż of the beginning, and the unknowns in their place.
        registers.dispatch(right(h, from, &mut self.change));
        let weights = Weights {
            damping: h,
            stiffness: 0.25 * h * h,
            once: true,
        };
        counts.solves += 1;
        if !system.solve(weights, record, &mut self.change) {
            return Outcome::NoSolution;
        }
        registers.dispatch(ahead(h, from, &self.change, to));
        self.works.fill(0.0);
        system.add_solved(record, &mut self.works);
        // Forces at the end: those of the next step, and of what is recorded.
        to.evaluate(system, record);
        counts.evaluations += 1;
        to.trapezoidal(from, h);
        for (quadrature, work) in to.quadratures.iter_mut().zip(&self.works) {
            *quadrature += work;
        }
        Outcome::of(registers.dispatch(finite(to)))
    }
}

kernel!(
    /// The right-hand side of the equations, divided by the masses.
    fn right<'a, S: Simd>(_simd: S, h: f64, from: &'a State, change: &'a mut [f64]) {
        let (dv, dz) = change.split_at_mut(from.a.len());
        for (x, rates) in [(dv, &from.a[..]), (dz, from.flow())] {
            for (x, rate) in x.iter_mut().zip(rates) {
                *x = h * rate;
            }
        }
    }
);

kernel!(
    /// v⁺ = v + Δv,   q⁺ = q + h v⁺,   z⁺ = z + Δz
    fn ahead<'a, S: Simd>(
        _simd: S,
        h: f64,
        from: &'a State,
        change: &'a [f64],
        to: &'a mut Snapshot,
    ) {
        let before = from.q.iter().zip(&from.v);
        let after = to.q.iter_mut().zip(&mut to.v);
        let (dv, dz) = change.split_at(from.q.len());
        for (((q, v), (q0, v0)), dv) in after.zip(before).zip(dv) {
            *v = dv + v0;
            *q = q0 + h * *v;
        }
        for ((z, z0), dz) in to.z.iter_mut().zip(&from.z).zip(dz) {
            *z = dz + z0;
        }
    }
);

kernel!(
    /// Whether a candidate is finite.
    fn finite<'a, S: Simd>(_simd: S, to: &'a Snapshot) -> bool {
        let mut watch = Watch::default();
        // Places are as finite as the velocities that led there.
        for part in [&to.v, &to.a, &to.quadratures, &to.z] {
            for value in part {
                watch.see(*value);
            }
        }
        watch.all_finite()
    }
);
