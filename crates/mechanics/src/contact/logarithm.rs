//! A logarithmic law on lanes, with or without a spring behind it.
//!
//! ```text
//! δ = p [ln(D/p) − 1]:     g = π E* L δ/u,   k = π E* L/(u − 1),   u − ln u = 1 + t,   t = ln(δ_max/δ)
//! ```
//!
//! Near t = 0 u is a series in y = √(2t), and far from there no more than y²/2 and a logarithm: over all depths between that of the knee
//! and [`LEAST_DEPTH`] one polynomial in y gives u to 1e-12, so that a force takes one logarithm and no iteration.
//!
//! # Source
//! The series in √(2t): R. M. Corless and others, *Adv. Comput. Math.* **5**, 1996, 329–359, section 4.

use chaindrive_contact::{Approach, Law, PreparedLaw};
use pulp::Simd;

use super::LEAST_DEPTH;
use crate::lanes::{Lane, Polynomial, Wide};

/// The law.
#[derive(Clone, Debug)]
pub(super) struct Logarithm {
    /// π E* L \[N/m\].
    scale: f64,
    /// ln δ_max, δ_max in metres.
    end: f64,
    /// δ at the knee \[m\], from where on the law is its own tangent, and k there \[N/m\].
    knee: f64,
    steepest: f64,
    /// u of (y − middle)/half.
    ratio: Polynomial<24>,
    middle: f64,
    half: f64,
}

impl Logarithm {
    /// The law, if it is one.
    pub(super) fn of(law: &Law) -> Option<Self> {
        let law: PreparedLaw = law.prepared();
        let [scale, end] = law.logarithm()?;
        let knee = law.reach()?;
        let at = |penetration: f64| {
            law.respond(Approach {
                penetration,
                rate: 0.0,
                onset_rate: 1.0,
            })
        };
        // y = √(2 t)
        let [first, last] = [knee, LEAST_DEPTH].map(|depth| (2.0 * (end - depth.ln())).sqrt());
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        Some(Self {
            scale,
            end,
            knee,
            steepest: at(knee).stiffness,
            ratio: Polynomial::through(|share| {
                let y = middle + half * share;
                let depth = (end - 0.5 * y * y).exp();
                scale * depth / at(depth).elastic
            }),
            middle,
            half,
        })
    }

    #[inline(always)]
    pub(super) fn force<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> Lane<S> {
        let curved = depth.max(w.splat(LEAST_DEPTH)).min(w.splat(self.knee));
        let t = w.splat(self.end) - curved.ln();
        let y = (t + t).root();
        let u = (y - w.splat(self.middle)) * w.splat(1.0 / self.half);
        let u = self.ratio.of(w, u);
        let beyond = (depth - w.splat(self.knee)).max(w.splat(0.0));
        w.splat(self.scale) * curved * u.recip() + w.splat(self.steepest) * beyond
    }

    /// dg/dδ of lanes with a force g.
    #[inline(always)]
    pub(super) fn slope<S: Simd>(&self, w: Wide<S>, depth: Lane<S>, force: Lane<S>) -> Lane<S> {
        // k = π E* L/(u − 1),   u = π E* L δ/g
        let scale = w.splat(self.scale);
        let left = (scale * depth - force).max(w.splat(LEAST_DEPTH));
        let slope = scale * force * left.recip();
        let bent = w.splat(self.knee).greater(depth);
        bent.select(slope, w.splat(self.steepest))
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::elastic::Johnson;
    use chaindrive_contact::{Dissipation, Elastic};
    use chaindrive_integrate::{Registers, kernel};
    use pulp::WithSimd;

    use super::*;
    use crate::lanes::LANES;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>) {
            let pairs = [(1.2e-3, 5.7e9), (4.28e-4, 3.75e8), (0.1, 1e8)];
            let behind = [None, Some(4.37e9), Some(5e7)];
            for ((length_scale, modulus_length), series) in pairs
                .into_iter()
                .flat_map(|pair| behind.map(|series| (pair, series)))
            {
                let law = Law {
                    elastic: Elastic::Johnson(Johnson {
                        length_scale,
                        modulus_length,
                    }),
                    series,
                    dissipation: Dissipation::None,
                    onset_floor: 0.0,
                };
                let lanes = Logarithm::of(&law).expect("a logarithm");
                for i in 0..3000 {
                    // From below the size of an atom to beyond the knee.
                    let depth = lanes.knee * 10.0_f64.powf(-22.0 + 23.0 * f64::from(i) / 3000.0);
                    let lane = w.splat(depth);
                    let force = lanes.force(w, lane);
                    let slope = lanes.slope(w, lane, force);
                    let expected = [law.elastic_force(depth), law.stiffness(depth)];
                    // k has u − 1 in it, which near the knee is a third of u.
                    let found = [(force, 1e-12), (slope, 3e-12)];
                    for ((found, most), expected) in found.into_iter().zip(expected) {
                        let found: [f64; LANES] = found.numbers();
                        let error = (found[0] / expected - 1.0).abs();
                        assert!(error < most, "{law:?} at {depth:e}: {error:e}");
                    }
                }
            }
            let law = Law {
                elastic: Elastic::Johnson(Johnson {
                    length_scale: 1e-3,
                    modulus_length: 1e9,
                }),
                series: None,
                dissipation: Dissipation::None,
                onset_floor: 0.0,
            };
            let lanes = Logarithm::of(&law).expect("a logarithm");
            let [open, none] = [w.splat(0.0), w.splat(0.0)];
            assert!(lanes.force(w, open).sum() < 1e-18);
            assert!(lanes.slope(w, open, none).sum().is_finite());
        }
    );

    /// As the law itself, which takes a logarithm and a step of fourth order.
    #[test]
    fn lanes_find_what_the_law_says() {
        Registers::in_use().dispatch(checked());
        checked().with_simd(pulp::Scalar);
    }
}
