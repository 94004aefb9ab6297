//! A power law with a spring behind it, on lanes.
//!
//! ```text
//! x + K xⁿ/k_s = δ,   F = K xⁿ,   1/k = x/(n F) + 1/k_s
//! ```
//!
//! With x = δ y and r = K δⁿ⁻¹/k_s that is y + r yⁿ = 1, where y depends on n and r alone. For r up to [`QUICK`] yⁿ is a polynomial in
//! r/(1 + r), and from there on for [`OCTAVES`] of r, where the surfaces are stiffer than what lies behind them, 1 − y is one in log₂ r.
//! Both are fitted once, and err by [`ERROR`] at most for exponents up to 1.5. Beyond, and for others, Newton's method begins at
//! y = 1/(1 + r), which lies below the root; the first step passes it, and the rest come down to it: how many it takes is counted once.

use std::f64::consts::LOG2_E;

use pulp::Simd;

use super::LEAST_DEPTH;
use crate::lanes::{FixedPower, Lane, Polynomial, Wide};

/// K δⁿ⁻¹/k_s that steps are counted for: beyond the last one the surfaces are as good as rigid, before the first what lies behind.
const RATIOS: [f64; 2] = [1e-8, 1e8];

/// r up to which the first polynomial serves, and its logarithm.
const QUICK: f64 = 1.0;
const FROM: f64 = 0.0;

/// Octaves of r that the second one serves from there on.
const OCTAVES: f64 = 5.0;

/// Coefficients of the polynomials, and their error; one that errs by more is not used.
const TERMS: usize = 20;
const ERROR: f64 = 5e-13;

/// Steps at most, where doubling digits has long come to an end.
const MOST: usize = 12;

/// The law.
#[derive(Clone, Debug)]
pub(super) struct PowerOnSpring {
    stiffness: f64,
    exponent: f64,
    /// δ ↦ δⁿ⁻¹
    lower: FixedPower,
    /// 1/k_s \[m/N\]
    compliance: f64,
    /// yⁿ of 2 r/(1 + r) (1 + R)/R − 1, where R is [`QUICK`]; none where it would err.
    near: Option<Polynomial<TERMS>>,
    /// 1 − y of 2 (log₂ r − log₂ R)/[`OCTAVES`] − 1.
    far: Option<Polynomial<TERMS>>,
    /// log₂ K/k_s
    at_one: f64,
    steps: usize,
}

impl PowerOnSpring {
    pub(super) fn new(stiffness: f64, exponent: f64, series: f64) -> Self {
        Self {
            stiffness,
            exponent,
            lower: FixedPower::new(exponent - 1.0),
            compliance: 1.0 / series,
            near: near(exponent),
            far: far(exponent),
            at_one: (stiffness / series).log2(),
            steps: steps(exponent),
        }
    }

    #[inline(always)]
    pub(super) fn force<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> Lane<S> {
        let one = w.splat(1.0);
        let closed = depth.greater(w.splat(LEAST_DEPTH));
        let depth = depth.max(w.splat(LEAST_DEPTH));
        let n = w.splat(self.exponent);
        let yielding = w.splat(self.stiffness * self.compliance);
        // r = K δⁿ⁻¹/k_s says how the depth is shared. Its logarithm chooses the polynomial.
        let octaves = w.splat(self.at_one) + (n - one) * w.splat(LOG2_E) * depth.ln();
        let from = w.splat(FROM);
        let beyond = octaves.greater(w.splat(FROM + OCTAVES));
        let (far, near) = (octaves.greater(from), closed & from.greater(octaves));
        // One polynomial serves up to r = 1 and another beyond, as far as they reach; a lane that has both asks both.
        if let (Some(of_far), Some(of_near)) = (&self.far, &self.near)
            && !beyond.any()
        {
            // What is open has no force, whatever is said of it.
            let t = (octaves.max(from) - from) * w.splat(2.0 / OCTAVES) - one;
            let deep = w.splat(1.0 / self.compliance) * depth * of_far.of(w, t);
            if !near.any() {
                return deep;
            }
            let lower = self.lower.of(w, depth);
            let r = yielding * lower;
            let share = r * (one + r).recip();
            let t =
                share.min(w.splat(QUICK / (1.0 + QUICK))) * w.splat(2.0 * (1.0 + QUICK) / QUICK);
            // F = K δⁿ yⁿ
            let shallow = w.splat(self.stiffness) * depth * lower * of_near.of(w, t - one);
            return far.select(deep, shallow);
        }
        let r = yielding * self.lower.of(w, depth);
        // No polynomial serves: Newton's method from the share of a linear law, in as many steps as any r may take.
        let beside = (one + r).recip();
        let mut x = depth * beside;
        for _ in 0..self.steps {
            // a = K xⁿ⁻¹/k_s,   x ← x − (x + a x − δ)/(1 + n a)
            let a = yielding * self.lower.of(w, x);
            let excess = x + a * x - depth;
            x = (x - excess * (one + n * a).recip()).max(w.splat(LEAST_DEPTH));
        }
        w.splat(self.stiffness) * x * self.lower.of(w, x)
    }

    /// dF/dδ of lanes with a force F.
    #[inline(always)]
    pub(super) fn slope<S: Simd>(&self, w: Wide<S>, depth: Lane<S>, force: Lane<S>) -> Lane<S> {
        let compliance = w.splat(self.compliance);
        let x = (depth - force * compliance).max(w.splat(LEAST_DEPTH));
        // k = n F/(x + n F/k_s)
        let steep = w.splat(self.exponent) * force;
        steep * (x + steep * compliance).max(w.splat(LEAST_DEPTH)).recip()
    }
}

impl PowerOnSpring {
    /// Energy stored in power and spring by lanes with a force F \[J\].
    ///
    /// ```text
    /// U = F x/(n + 1) + F²/(2 k_s),   x = δ − F/k_s
    /// ```
    #[inline(always)]
    pub(super) fn energy<S: Simd>(&self, w: Wide<S>, depth: Lane<S>, force: Lane<S>) -> Lane<S> {
        let yielded = force * w.splat(self.compliance);
        let share = w.splat(1.0 / (self.exponent + 1.0));
        force * (share * (depth - yielded) + w.splat(0.5) * yielded)
    }
}

/// yⁿ for r up to [`QUICK`], if a polynomial is as near as it has to be.
fn near(exponent: f64) -> Option<Polynomial<TERMS>> {
    let of = |t: f64| {
        let share = 0.5 * (t + 1.0) * QUICK / (1.0 + QUICK);
        root(exponent, share / (1.0 - share)).powf(exponent)
    };
    fitted(of)
}

/// 1 − y for r of some octaves from [`QUICK`] on, likewise.
fn far(exponent: f64) -> Option<Polynomial<TERMS>> {
    let of = |t: f64| 1.0 - root(exponent, (FROM + 0.5 * (t + 1.0) * OCTAVES).exp2());
    fitted(of)
}

/// A polynomial, if it is as near as it has to be.
fn fitted(of: impl Fn(f64) -> f64) -> Option<Polynomial<TERMS>> {
    let polynomial = Polynomial::through(&of);
    let off = |i: i32| {
        let t = f64::from(i) / 100.0;
        (polynomial.at(t) / of(t) - 1.0).abs()
    };
    let near = (-100..=100).map(off).all(|error| error < ERROR);
    near.then_some(polynomial)
}

/// y where y + r yⁿ = 1, by Newton's method until nothing changes.
fn root(n: f64, r: f64) -> f64 {
    let mut y = 1.0 / (1.0 + r);
    for _ in 0..64 {
        let a = r * y.powf(n - 1.0);
        let next = y - (y + a * y - 1.0) / (1.0 + n * a);
        if (next - y).abs() <= f64::EPSILON * y {
            break;
        }
        y = next;
    }
    y
}

/// Steps after which y + r yⁿ = 1 holds to rounding, for all r.
fn steps(n: f64) -> usize {
    let taken = |r: f64| {
        let mut y = 1.0 / (1.0 + r);
        for step in 0..MOST {
            let a = r * y.powf(n - 1.0);
            let excess = y + a * y - 1.0;
            // What is missing of y is half of what its last step was, squared; one more step makes it good.
            if excess.abs() < 1e-9 * (1.0 + n * a) * y {
                return step + 1;
            }
            y -= excess / (1.0 + n * a);
        }
        MOST
    };
    let [least, greatest] = RATIOS.map(f64::log10);
    let ratios = (0..=64).map(|i| 10.0_f64.powf(least + (greatest - least) * f64::from(i) / 64.0));
    ratios.map(taken).max().unwrap_or(MOST)
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::elastic::Power;
    use chaindrive_contact::{Dissipation, Elastic, Law};
    use chaindrive_integrate::{Registers, kernel};
    use pulp::WithSimd;

    use super::*;
    use crate::lanes::LANES;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>) {
            let cases = [
                (8.5e8, 1.08),
                (6.6e10, 1.5),
                (3e12, 2.0),
                (4e8, 1.01),
                (8.5e8, 1.2),
                (8.5e9, 1.17),
            ];
            let behind = [53e6, 5e8, 1e7, 1e12, 105e6, 105e6];
            for ((stiffness, exponent), series) in cases.into_iter().zip(behind) {
                let stacked = PowerOnSpring::new(stiffness, exponent, series);
                let law = Law {
                    elastic: Elastic::Power(Power {
                        stiffness,
                        exponent,
                    }),
                    series: Some(series),
                    dissipation: Dissipation::None,
                    onset_floor: 0.0,
                };
                for i in 0..60 {
                    let depth = 1e-10 * 10.0_f64.powf(f64::from(i) / 8.0);
                    let lane = w.splat(depth);
                    let force = stacked.force(w, lane);
                    let slope = stacked.slope(w, lane, force);
                    let energy = stacked.energy(w, lane, force);
                    let expected = [
                        law.elastic_force(depth),
                        law.stiffness(depth),
                        law.energy(depth),
                    ];
                    for (found, expected) in [force, slope, energy].into_iter().zip(expected) {
                        let found: [f64; LANES] = found.numbers();
                        let error = (found[0] / expected - 1.0).abs();
                        assert!(error < 2e-12, "{stacked:?} at {depth:e}: {error:e}");
                    }
                }
            }
        }
    );

    /// As the law itself, whose Newton method goes on until nothing changes.
    #[test]
    fn lanes_find_what_the_law_says() {
        Registers::in_use().dispatch(checked());
        checked().with_simd(pulp::Scalar);
    }

    /// Nothing where there is no contact.
    #[test]
    fn an_open_contact_has_no_force() {
        let stacked = PowerOnSpring::new(6.6e10, 1.5, 5e7);
        let w = Wide(pulp::Scalar);
        assert!(stacked.force(w, w.splat(0.0)).sum() < 1e-20);
        assert!(
            stacked
                .slope(w, w.splat(0.0), w.splat(0.0))
                .sum()
                .is_finite()
        );
    }
}
