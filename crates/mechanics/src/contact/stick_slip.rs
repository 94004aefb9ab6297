//! Friction that holds as a spring and slides, on lanes.

use pulp::Simd;

use super::rubbing::Rubbing;
use crate::lanes::{Lane, Wide};

/// A slip \[m/s\] that no force is divided by less than.
const LEAST_SLIP: f64 = 1e-30;

/// A spring and a slider, prepared.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LaneSpring {
    /// k \[N/m\]
    pub(crate) stiffness: f64,
    /// μ/k \[m/N\]
    coefficient_by_stiffness: f64,
}

/// A law that sticks as a spring up to a deflection at which it slides.
pub(crate) trait Holding: Copy {
    /// Dashpot \[N s/m\] beside the spring; none for the law that most have.
    const OILED: bool;

    fn spring(&self) -> LaneSpring;

    fn oil(&self) -> f64;

    /// Deflections \[m\] at which it slides under these normal forces at these slips.
    fn limit<S: Simd>(&self, w: Wide<S>, normal: Lane<S>, slip: Lane<S>) -> Lane<S>;
}

/// Share of its stiffness that a step of one solution carries while a spring holds: h²/4 k as of every other contact, where the slope
/// times the step is h² k.
const HELD: f64 = 0.25;
/// Share of |R/slip| while the spring slides. *Assumed*: with all of it friction holds back more than it can, and the bicycle errs by half as
/// much again at 8 to 16 µs; with none the slip is turned around from step to step, which brings energy in.
const SLIDING: f64 = 0.5;

impl Holding for LaneSpring {
    const OILED: bool = false;

    #[inline(always)]
    fn spring(&self) -> LaneSpring {
        *self
    }

    #[inline(always)]
    fn oil(&self) -> f64 {
        0.0
    }

    /// μ N/k
    #[inline(always)]
    fn limit<S: Simd>(&self, w: Wide<S>, normal: Lane<S>, _slip: Lane<S>) -> Lane<S> {
        w.splat(self.coefficient_by_stiffness) * normal
    }
}

impl LaneSpring {
    pub(super) fn new(coefficient: f64, stiffness: f64) -> Self {
        Self {
            stiffness,
            coefficient_by_stiffness: coefficient / stiffness,
        }
    }

    /// Friction, and the deflection of the spring.
    ///
    /// ```text
    /// z′ = z + v h, drawn back to |z′| ≤ limit;   f = −k z′,   −∂f/∂v = k h while it holds
    /// ```
    #[inline(always)]
    pub(crate) fn slide<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        limit: Lane<S>,
        slip: Lane<S>,
        before: Lane<S>,
    ) -> (Rubbing<S>, Lane<S>) {
        let stiffness = w.splat(self.stiffness);
        let tried = before.plus(slip, w.splat(dt));
        let stick = tried.max(-limit).min(limit);
        let holds = limit.greater(tried.abs());
        let spring = stiffness * w.splat(dt);
        let drag = holds.select(spring, w.splat(0.0));
        // |f/v| ≤ k h
        let sliding = stiffness * limit * slip.abs().max(w.splat(LEAST_SLIP)).recip();
        let rubbing = Rubbing {
            force: -(stiffness * stick),
            drag,
            secant: holds.select(
                w.splat(HELD) * spring,
                w.splat(SLIDING) * spring.min(sliding),
            ),
            steepest: drag,
        };
        (rubbing, stick)
    }
}
