//! Interpolation between two accepted states.

use serde::{Deserialize, Serialize};

/// A time within an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    /// Length of the interval \[s\].
    h: f64,
    /// Place in the interval, 0 at the beginning and 1 at the end.
    s: f64,
}

/// Interpolation of positions and velocities between two accepted states, at the order of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Interpolation {
    /// From q, v and a of both ends.
    #[default]
    Quintic,
    /// From q and v of both ends.
    Cubic,
    /// Positions from positions, velocities from velocities.
    Linear,
}

/// Weights of the ends of an interval in the position and the velocity at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    position: [f64; 6],
    velocity: [f64; 6],
}

impl Interval {
    pub(crate) fn new(from: f64, to: f64, t: f64) -> Self {
        let h = to - from;
        let s = if h > 0.0 {
            ((t - from) / h).clamp(0.0, 1.0)
        } else {
            1.0
        };
        Self { h, s }
    }

    /// Cubic from values and rates at both ends.
    pub(crate) fn cubic(self, y0: f64, y1: f64, r0: f64, r1: f64) -> f64 {
        // y = y₀ + (y₁ − y₀) s² (3 − 2s) + h s (1 − s) [r₀ (1 − s) − r₁ s]
        let Self { h, s } = self;
        y0 + (y1 - y0) * s * s * (3.0 - 2.0 * s) + h * s * (1.0 - s) * (r0 * (1.0 - s) - r1 * s)
    }
}

impl Interpolation {
    /// Weights at a place of an interval.
    pub(crate) fn weights(self, at: Interval) -> Weights {
        match self {
            Self::Quintic => quintic(at),
            Self::Cubic => cubic(at),
            Self::Linear => linear(at),
        }
    }
}

/// Straight lines.
fn linear(Interval { s, .. }: Interval) -> Weights {
    // q = (1 − s) q₀ + s q₁,  v = (1 − s) v₀ + s v₁
    let r = 1.0 - s;
    Weights {
        position: [r, s, 0.0, 0.0, 0.0, 0.0],
        velocity: [0.0, 0.0, r, s, 0.0, 0.0],
    }
}

/// Hermite's basis of third degree, scaled to the interval.
fn cubic(Interval { h, s }: Interval) -> Weights {
    let r = 1.0 - s;
    // Position of the end: s² (3 − 2 s); its slope is 6 s r.
    let end = s * s * (3.0 - 2.0 * s);
    let slope = 6.0 * s * r;
    Weights {
        position: [1.0 - end, end, h * s * r * r, -h * r * s * s, 0.0, 0.0],
        velocity: if h > 0.0 {
            let (first, last) = (r * (1.0 - 3.0 * s), s * (1.0 - 3.0 * r));
            [-slope / h, slope / h, first, last, 0.0, 0.0]
        } else {
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
        },
    }
}

/// Hermite's basis of fifth degree, scaled to the interval; ends in the order q₀ q₁ v₀ v₁ a₀ a₁.
fn quintic(Interval { h, s }: Interval) -> Weights {
    let r = 1.0 - s;
    // Position of the end: s³ (10 − 15 s + 6 s²); its slope is 30 s² r².
    let end = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
    // v₀: s r³ (1 + 3 s),  v₁: −r s³ (1 + 3 r),  a₀: ½ s² r³,  a₁: ½ r² s³, by symmetry under s ↔ r
    let slope = 30.0 * s * s * r * r;
    Weights {
        position: [
            1.0 - end,
            end,
            h * s * r * r * r * (1.0 + 3.0 * s),
            -h * r * s * s * s * (1.0 + 3.0 * r),
            0.5 * h * h * s * s * r * r * r,
            0.5 * h * h * r * r * s * s * s,
        ],
        velocity: if h > 0.0 {
            [
                -slope / h,
                slope / h,
                r * r * (1.0 + 2.0 * s - 15.0 * s * s),
                s * s * (1.0 + 2.0 * r - 15.0 * r * r),
                0.5 * h * s * r * r * (2.0 - 5.0 * s),
                -0.5 * h * r * s * s * (2.0 - 5.0 * r),
            ]
        } else {
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
        },
    }
}

impl Weights {
    /// Position and velocity from q₀ q₁ v₀ v₁ a₀ a₁.
    #[inline]
    pub(crate) fn apply(&self, ends: [f64; 6]) -> (f64, f64) {
        let sum = |weights: &[f64; 6]| -> f64 {
            // Measured from the beginning, so that a large position does not cost digits of the velocity.
            weights[1] * (ends[1] - ends[0])
                + weights[2] * ends[2]
                + weights[3] * ends[3]
                + weights[4] * ends[4]
                + weights[5] * ends[5]
        };
        (ends[0] + sum(&self.position), sum(&self.velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every polynomial up to the degree of the basis is reproduced, with its derivative.
    #[test]
    fn polynomials_are_exact() {
        let (from, to) = (0.3, 0.8);
        let quintic = (0..=5).map(|degree| (Interpolation::Quintic, degree));
        let cubic = (0..=3).map(|degree| (Interpolation::Cubic, degree));
        let linear = (0..=1).map(|degree| (Interpolation::Linear, degree));
        for (interpolation, degree) in quintic.chain(cubic).chain(linear) {
            let q = |t: f64| t.powi(degree);
            let v = |t: f64| f64::from(degree) * t.powi(degree - 1);
            let a = |t: f64| f64::from(degree * (degree - 1)) * t.powi(degree - 2);
            for t in [0.3, 0.35, 0.5, 0.77, 0.8] {
                let weights = interpolation.weights(Interval::new(from, to, t));
                let (position, velocity) =
                    weights.apply([q(from), q(to), v(from), v(to), a(from), a(to)]);
                assert!((position - q(t)).abs() < 1e-15, "degree {degree}, t {t}");
                assert!((velocity - v(t)).abs() < 2e-14, "degree {degree}, t {t}");
            }
        }
    }

    #[test]
    fn cubic_is_exact_and_ends_are_clamped() {
        let y = |t: f64| 1.0 - t + t * t * t;
        let r = |t: f64| 3.0 * t * t - 1.0;
        let at = |t: f64| Interval::new(1.0, 1.5, t).cubic(y(1.0), y(1.5), r(1.0), r(1.5));
        assert!((at(1.2) - y(1.2)).abs() < 1e-15);
        assert!((at(7.0) - y(1.5)).abs() < 1e-15);
        assert!((at(0.0) - y(1.0)).abs() < 1e-15);
    }
}
