//! Smooth functions of a number between −1 and 1.

use pulp::Simd;

use super::{Lane, Wide};

/// The polynomial through the values of a function at Chebyshev's nodes, with an even number of coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polynomial<const TERMS: usize = 14> {
    /// Of rising powers.
    coefficients: [f64; TERMS],
}

impl<const TERMS: usize> Polynomial<TERMS> {
    pub(crate) fn through(f: impl Fn(f64) -> f64) -> Self {
        let count = TERMS as f64;
        let angle = |i: usize| std::f64::consts::PI * (i as f64 + 0.5) / count;
        let values: [f64; TERMS] = std::array::from_fn(|i| f(angle(i).cos()));
        let mut sum = [0.0; TERMS];
        // T₀ = 1, T₁ = t, T_{k+1} = 2 t T_k − T_{k−1}
        let (mut before, mut basis) = ([0.0; TERMS], [0.0; TERMS]);
        basis[0] = 1.0;
        for k in 0..TERMS {
            let terms = values.iter().enumerate();
            let share: f64 = terms
                .map(|(i, value)| value * (k as f64 * angle(i)).cos())
                .sum();
            let share = share * if k == 0 { 1.0 } else { 2.0 } / count;
            for (sum, basis) in sum.iter_mut().zip(&basis) {
                *sum += share * basis;
            }
            let factor = if k == 0 { 1.0 } else { 2.0 };
            let next = std::array::from_fn(|j| {
                factor * if j > 0 { basis[j - 1] } else { 0.0 } - before[j]
            });
            (before, basis) = (basis, next);
        }
        Self { coefficients: sum }
    }

    /// The value at one place.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.of(Wide(pulp::Scalar), Wide(pulp::Scalar).splat(t))
            .sum()
    }

    #[inline(always)]
    pub(crate) fn of<S: Simd>(&self, w: Wide<S>, t: Lane<S>) -> Lane<S> {
        let squared = t * t;
        if TERMS.is_multiple_of(4) {
            // Four sums side by side: long polynomials wait for each of their products.
            let fourth = squared * squared;
            let mut sums =
                [TERMS - 4, TERMS - 3, TERMS - 2, TERMS - 1].map(|k| w.splat(self.coefficients[k]));
            for k in (0..TERMS / 4 - 1).rev() {
                for (j, sum) in sums.iter_mut().enumerate() {
                    *sum = sum.times_plus(fourth, w.splat(self.coefficients[4 * k + j]));
                }
            }
            let [a, b, c, d] = sums;
            return a.plus(b, t).plus(c.plus(d, t), squared);
        }
        // Even and odd powers side by side.
        let mut even = w.splat(self.coefficients[TERMS - 2]);
        let mut odd = w.splat(self.coefficients[TERMS - 1]);
        for k in (0..TERMS / 2 - 1).rev() {
            even = even.times_plus(squared, w.splat(self.coefficients[2 * k]));
            odd = odd.times_plus(squared, w.splat(self.coefficients[2 * k + 1]));
        }
        odd.times_plus(t, even)
    }
}
