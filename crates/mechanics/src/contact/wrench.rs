//! Loads of rollers on a body, with the losses and onsets of their contacts.

use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::memory::Onset;
use crate::lanes::{Lane, Mask, Wide};

/// Loads of the rollers on a body, with the figures that the step control reads.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
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
    /// Greatest normal force of one circle, on all its sides together \[N\].
    pub(crate) greatest: f64,
    /// Largest damping of one contact, along the normal and across \[N s/m\].
    pub(crate) damping: f64,
    /// Largest damping across alone \[N s/m\].
    pub(crate) across: f64,
    /// Deepest penetration of a contact that began in this step \[m\].
    pub(crate) first_depth: f64,
    /// Smallest share of the step after which such a contact began.
    pub(crate) first_share: f64,
    /// The contact that began in this step.
    pub(crate) begun: Onsets,
}

/// Contacts that began in a step.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Onsets {
    /// Their number.
    pub(crate) count: f64,
    /// Those that closed slower than the floor of the law.
    pub(crate) gentle: f64,
    /// Greatest closing speed at touch \[m/s\].
    pub(crate) fastest: f64,
}

impl Onsets {
    /// With those of others.
    pub(crate) fn and(self, others: Self) -> Self {
        Self {
            count: self.count + others.count,
            gentle: self.gentle + others.gentle,
            fastest: self.fastest.max(others.fastest),
        }
    }
}

/// Losses of contacts, lane by lane, and their onsets.
pub(crate) struct LaneTally<S: Simd> {
    /// Power lost along the normals \[W\].
    pub(crate) normal_loss: Lane<S>,
    /// Power lost by friction \[W\].
    pub(crate) friction_loss: Lane<S>,
    /// Deepest penetration \[m\].
    pub(super) depth: Lane<S>,
    /// Numbers, not lanes, which would be put down and fetched in every loop for what is rare.
    begun: Onsets,
    first_depth: f64,
    first_share: f64,
}

impl<S: Simd> LaneTally<S> {
    #[inline(always)]
    pub(crate) fn new(w: Wide<S>) -> Self {
        let zero = w.splat(0.0);
        Self {
            normal_loss: zero,
            friction_loss: zero,
            depth: zero,
            begun: Onsets::default(),
            first_depth: 0.0,
            first_share: 1.0,
        }
    }

    /// Takes note of contacts that began after some share of the step, where the law has this floor of the speed at touch \[m/s\].
    #[inline(always)]
    pub(super) fn began(
        &mut self,
        w: Wide<S>,
        fresh: Mask<S>,
        depth: Lane<S>,
        onset: &Onset<S>,
        floor: f64,
    ) {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let depth = fresh.select(depth, zero).largest();
        self.first_depth = self.first_depth.max(depth);
        let share = fresh.select(onset.share, one).smallest();
        self.first_share = self.first_share.min(share);
        let gentle = fresh & w.splat(floor).greater(onset.speed);
        self.begun = self.begun.and(Onsets {
            count: fresh.select(one, zero).sum(),
            gentle: gentle.select(one, zero).sum(),
            fastest: fresh.select(onset.speed, zero).largest(),
        });
    }

    /// Deepest penetration \[m\].
    #[inline(always)]
    pub(crate) fn deepest(&self) -> f64 {
        self.depth.largest()
    }

    /// The contacts that began.
    #[inline(always)]
    pub(crate) fn begun(&self) -> Onsets {
        self.begun
    }

    /// Deepest penetration \[m\] of the contacts that began, and the smallest share of the step that had passed then.
    #[inline(always)]
    pub(crate) fn first(&self) -> [f64; 2] {
        [self.first_depth, self.first_share]
    }

    /// Writes all of it into a wrench.
    #[inline(always)]
    pub(super) fn total(&self, rubbing: bool, wrench: Wrench) -> Wrench {
        let [first_depth, first_share] = self.first();
        let friction_loss = if rubbing {
            self.friction_loss.sum()
        } else {
            0.0
        };
        Wrench {
            normal_loss: self.normal_loss.sum(),
            friction_loss,
            depth: self.depth.largest(),
            first_depth,
            first_share,
            begun: self.begun(),
            ..wrench
        }
    }
}

/// Sums over all slots of a body, lane by lane.
pub(super) struct Sums<S: Simd> {
    pub(super) fx: Lane<S>,
    pub(super) fy: Lane<S>,
    pub(super) moment: Lane<S>,
    pub(super) damping: Lane<S>,
    pub(super) across: Lane<S>,
    /// Greatest normal force of one circle \[N\].
    pub(super) greatest: Lane<S>,
    pub(super) tally: LaneTally<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    pub(super) fn new(w: Wide<S>) -> Self {
        let zero = w.splat(0.0);
        Self {
            fx: zero,
            fy: zero,
            moment: zero,
            damping: zero,
            across: zero,
            greatest: zero,
            tally: LaneTally::new(w),
        }
    }

    #[inline(always)]
    pub(super) fn total(&self, rubbing: bool) -> Wrench {
        let wrench = Wrench {
            force: [self.fx.sum(), self.fy.sum()],
            moment: self.moment.sum(),
            damping: self.damping.largest(),
            across: if rubbing { self.across.largest() } else { 0.0 },
            greatest: self.greatest.largest(),
            ..Wrench::default()
        };
        self.tally.total(rubbing, wrench)
    }
}
