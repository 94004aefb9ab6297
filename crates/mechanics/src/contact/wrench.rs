//! What the rollers do to a body, all together.

use pulp::Simd;

use crate::lanes::{Lane, Wide};

/// What the rollers do to a body, and what the step control wants to know.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wrench {
    /// Force on the body \[N\].
    pub(crate) force: [f64; 2],
    /// Moment about the frame's origin \[N m\].
    pub(crate) moment: f64,
    /// Power dissipated normal to the surface \[W\].
    pub(crate) normal_loss: f64,
    /// Power dissipated by friction \[W\].
    pub(crate) friction_loss: f64,
    /// Deepest penetration \[m\].
    pub(crate) depth: f64,
    /// Largest damping of one contact, along the normal and across \[N s/m\].
    pub(crate) damping: f64,
    /// Deepest penetration of a contact that opened this step \[m\].
    pub(crate) first_depth: f64,
    /// Smallest share of the step after which such a contact began.
    pub(crate) first_share: f64,
}

/// Sums over all slots of a body, lane by lane.
pub(super) struct Sums<S: Simd> {
    pub(super) fx: Lane<S>,
    pub(super) fy: Lane<S>,
    pub(super) moment: Lane<S>,
    pub(super) normal_loss: Lane<S>,
    pub(super) friction_loss: Lane<S>,
    pub(super) depth: Lane<S>,
    pub(super) damping: Lane<S>,
    /// Whether contacts began; only then the rest counts.
    pub(super) fresh: bool,
    pub(super) first_depth: Lane<S>,
    pub(super) first_share: Lane<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    pub(super) fn new(w: Wide<S>) -> Self {
        let zero = w.splat(0.0);
        Self {
            fx: zero,
            fy: zero,
            moment: zero,
            normal_loss: zero,
            friction_loss: zero,
            depth: zero,
            damping: zero,
            fresh: false,
            first_depth: zero,
            first_share: w.splat(1.0),
        }
    }

    #[inline(always)]
    pub(super) fn total(&self, rubbing: bool) -> Wrench {
        let (first_depth, first_share) = if self.fresh {
            (self.first_depth.largest(), self.first_share.smallest())
        } else {
            (0.0, 1.0)
        };
        let friction_loss = if rubbing {
            self.friction_loss.sum()
        } else {
            0.0
        };
        Wrench {
            force: [self.fx.sum(), self.fy.sum()],
            moment: self.moment.sum(),
            normal_loss: self.normal_loss.sum(),
            friction_loss,
            depth: self.depth.largest(),
            damping: self.damping.largest(),
            first_depth,
            first_share,
        }
    }
}
