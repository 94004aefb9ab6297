//! The force of friction on lanes, and its derivatives.

use pulp::Simd;

use crate::lanes::{Lane, Wide};

/// Force of friction, and its derivatives.
pub(crate) struct Rubbing<S: Simd> {
    /// Force along the slip \[N\].
    pub(crate) force: Lane<S>,
    /// Its slope −∂R/∂slip, not negative \[N s/m\].
    pub(crate) drag: Lane<S>,
    /// Resistance that a step of one solution reckons with where friction is about to stop the slip \[N s/m\]: |R/slip|, or the slope
    /// where that is steeper. With it a step cannot carry the slip beyond zero, where the slope of a saturated friction would let it chatter. Of a
    /// spring that sticks or slides it is a share (`friction.rs`).
    pub(crate) secant: Lane<S>,
    /// The slope that limits explicit steps \[N s/m\].
    pub(crate) steepest: Lane<S>,
}

impl<S: Simd> Rubbing<S> {
    #[inline(always)]
    pub(super) fn none(w: Wide<S>) -> Self {
        Self::all(w.splat(0.0))
    }

    #[inline(always)]
    pub(super) fn unknown(w: Wide<S>) -> Self {
        Self::all(w.splat(f64::NAN))
    }

    #[inline(always)]
    fn all(value: Lane<S>) -> Self {
        Self {
            force: value,
            drag: value,
            secant: value,
            steepest: value,
        }
    }
}
