//! Memory of contacts of any kind.
//!
//! A contact is closed from the first accepted state with a penetration to the last one. Its memory counts only in between:
//! a contact that begins takes nothing from the one that was there before, neither the speed at touch nor the bristles of its
//! friction.

use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::window::FAR;
use crate::MemoryError;
use crate::lanes::{Lane, Lanes, LanesMut, Mask, Wide};

/// State of contacts at one instant, one number a contact, whole lanes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactMemory {
    /// Inverse of the closing speed at touch \[s/m\]; zero while open.
    pub(crate) inverse_onset: Vec<f64>,
    /// Gap \[m\], negative in contact.
    pub(crate) gap: Vec<f64>,
    /// Closing speed \[m/s\].
    pub(crate) closing: Vec<f64>,
    /// Normal force \[N\].
    pub(crate) force: Vec<f64>,
    /// Acceleration of a closed contact's circle towards the surface by all else that acts on it \[m/s²\]; kept where steps look ahead.
    pub(crate) thrust: Vec<f64>,
    /// State of a friction law that has one; means something while closed.
    pub(crate) stick: Vec<f64>,
    /// Share of the flank's law, where there is one; means something while closed.
    pub(crate) share: Vec<f64>,
}

/// One contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactState {
    /// Gap \[m\], negative in contact.
    pub(crate) gap: f64,
    /// Closing speed \[m/s\].
    pub(crate) closing: f64,
    /// Normal force \[N\], if it is closed.
    pub(crate) force: Option<f64>,
}

impl ContactState {
    /// Two contacts of one roller with one body, taken for one.
    pub(crate) fn with(self, other: Self) -> Self {
        let nearer = if other.gap < self.gap { other } else { self };
        let force = match (self.force, other.force) {
            (Some(one), Some(more)) => Some(one + more),
            (one, more) => one.or(more),
        };
        Self { force, ..nearer }
    }
}

impl ContactMemory {
    /// As many contacts, all open.
    pub(crate) fn open(count: usize) -> Self {
        let mut memory = Self::default();
        memory.reopen(count);
        memory
    }

    /// Opens all of as many contacts.
    pub(crate) fn reopen(&mut self, count: usize) {
        for values in self.all() {
            values.clear();
            values.resize(count, 0.0);
        }
        self.gap.fill(FAR);
    }

    #[inline]
    pub(crate) fn resize(&mut self, count: usize) {
        if self.gap.len() == count {
            return;
        }
        for values in self.all() {
            values.resize(count, 0.0);
        }
    }

    /// Takes over one contact of another memory.
    pub(crate) fn carry(&mut self, to: usize, other: &Self, from: usize) {
        self.inverse_onset[to] = other.inverse_onset[from];
        self.gap[to] = other.gap[from];
        self.closing[to] = other.closing[from];
        self.force[to] = other.force[from];
        self.thrust[to] = other.thrust[from];
        self.stick[to] = other.stick[from];
        self.share[to] = other.share[from];
    }

    /// Speed at touch \[m/s\] and force \[N\] of a closed contact.
    pub(crate) fn closed(&self, index: usize) -> Option<(f64, f64)> {
        let inverse = self.inverse_onset[index];
        (inverse > 0.0).then(|| (1.0 / inverse, self.force[index]))
    }

    /// Refuses a memory of another number of contacts.
    pub(crate) fn check(&self, count: usize) -> Result<(), MemoryError> {
        for values in [
            &self.inverse_onset,
            &self.gap,
            &self.closing,
            &self.force,
            &self.thrust,
            &self.stick,
            &self.share,
        ] {
            MemoryError::unless("contacts", values.len(), count)?;
        }
        Ok(())
    }

    /// A contact as it is.
    pub(crate) fn at(&self, index: usize) -> ContactState {
        ContactState {
            gap: self.gap[index],
            closing: self.closing[index],
            force: self.closed(index).map(|(_, force)| force),
        }
    }

    fn all(&mut self) -> [&mut Vec<f64>; 7] {
        [
            &mut self.inverse_onset,
            &mut self.gap,
            &mut self.closing,
            &mut self.force,
            &mut self.thrust,
            &mut self.stick,
            &mut self.share,
        ]
    }
}

/// Contacts lane by lane: as the last accepted state left them, and as they are found now.
pub(crate) struct MemoryLanes<'a, S: Simd> {
    before: Before<'a, S>,
    now: Now<'a, S>,
}

struct Before<'a, S: Simd> {
    inverse_onset: Lanes<'a, S>,
    gap: Lanes<'a, S>,
    closing: Lanes<'a, S>,
    force: Lanes<'a, S>,
    thrust: Lanes<'a, S>,
    stick: Lanes<'a, S>,
}

struct Now<'a, S: Simd> {
    inverse_onset: LanesMut<'a, S>,
    gap: LanesMut<'a, S>,
    closing: LanesMut<'a, S>,
    force: LanesMut<'a, S>,
    thrust: LanesMut<'a, S>,
    stick: LanesMut<'a, S>,
    share: LanesMut<'a, S>,
}

/// How a contact began between the last accepted state and now.
pub(crate) struct Onset<S: Simd> {
    /// Closing speed at touch \[m/s\].
    pub(crate) speed: Lane<S>,
    /// Share of the step that had passed then.
    pub(crate) share: Lane<S>,
}

impl<'a, S: Simd> MemoryLanes<'a, S> {
    /// The first `count` contacts of two memories, whole lanes.
    #[inline(always)]
    pub(crate) fn new(
        w: Wide<S>,
        before: &'a ContactMemory,
        now: &'a mut ContactMemory,
        count: usize,
    ) -> Self {
        Self {
            before: Before {
                inverse_onset: w.lanes(&before.inverse_onset[..count]),
                gap: w.lanes(&before.gap[..count]),
                closing: w.lanes(&before.closing[..count]),
                force: w.lanes(&before.force[..count]),
                thrust: w.lanes(&before.thrust[..count]),
                stick: w.lanes(&before.stick[..count]),
            },
            now: Now {
                inverse_onset: Wide::<S>::lanes_mut(&mut now.inverse_onset[..count]),
                gap: Wide::<S>::lanes_mut(&mut now.gap[..count]),
                closing: Wide::<S>::lanes_mut(&mut now.closing[..count]),
                force: Wide::<S>::lanes_mut(&mut now.force[..count]),
                thrust: Wide::<S>::lanes_mut(&mut now.thrust[..count]),
                stick: Wide::<S>::lanes_mut(&mut now.stick[..count]),
                share: Wide::<S>::lanes_mut(&mut now.share[..count]),
            },
        }
    }

    /// Writes down where the surfaces of a lane are.
    #[inline(always)]
    pub(crate) fn look(&mut self, lane: usize, gap: Lane<S>, closing: Lane<S>) {
        self.now.gap.set(lane, gap);
        self.now.closing.set(lane, closing);
    }

    /// Opens a lane.
    #[inline(always)]
    pub(crate) fn open(&mut self, w: Wide<S>, lane: usize) {
        self.now.inverse_onset.set(lane, w.splat(0.0));
        self.now.force.set(lane, w.splat(0.0));
    }

    /// Inverse of the speed at touch of contacts that were closed before, zero for the others.
    #[inline(always)]
    pub(crate) fn inverse_onset(&self, lane: usize) -> Lane<S> {
        self.before.inverse_onset.get(lane)
    }

    /// Speed at touch, interpolated to zero gap as
    /// [`interpolated_onset`](chaindrive_contact::interpolated_onset) does; may be negative.
    #[inline(always)]
    pub(crate) fn onset(
        &self,
        w: Wide<S>,
        lane: usize,
        depth: Lane<S>,
        closing: Lane<S>,
    ) -> Onset<S> {
        // v = v_a + s (v_b − v_a),   s = g_a/(g_a − g_b)
        let gap_before = self.before.gap.get(lane).max(w.splat(0.0));
        let closing_before = self.before.closing.get(lane);
        let share = gap_before * (gap_before + depth).recip();
        Onset {
            speed: closing_before + share * (closing - closing_before),
            share,
        }
    }

    /// Keeps the inverse speeds at touch, zero where open.
    #[inline(always)]
    pub(crate) fn keep_onset(&mut self, lane: usize, inverse: Lane<S>) {
        self.now.inverse_onset.set(lane, inverse);
    }

    /// Forces \[N\], and what else drew the circles towards their surfaces \[m/s²\], at the last accepted state.
    #[inline(always)]
    pub(super) fn pushed(&self, lane: usize) -> [Lane<S>; 2] {
        [self.before.force.get(lane), self.before.thrust.get(lane)]
    }

    /// Keeps what else draws the circles.
    #[inline(always)]
    pub(super) fn keep_thrust(&mut self, lane: usize, thrust: Lane<S>) {
        self.now.thrust.set(lane, thrust);
    }

    /// Keeps the forces, zero where open.
    #[inline(always)]
    pub(crate) fn keep_force(&mut self, lane: usize, force: Lane<S>) {
        self.now.force.set(lane, force);
    }

    #[inline(always)]
    pub(crate) fn keep_share(&mut self, lane: usize, share: Lane<S>) {
        self.now.share.set(lane, share);
    }

    /// State of the friction of contacts that were closed before; the others begin without.
    #[inline(always)]
    pub(crate) fn stick(&self, w: Wide<S>, lane: usize) -> Lane<S> {
        let zero = w.splat(0.0);
        let was_closed = self.before.inverse_onset.get(lane).greater(zero);
        was_closed.select(self.before.stick.get(lane), zero)
    }

    /// Keeps the state of the friction where closed.
    #[inline(always)]
    pub(crate) fn keep_stick(&mut self, w: Wide<S>, lane: usize, closed: Mask<S>, stick: Lane<S>) {
        self.now.stick.set(lane, closed.select(stick, w.splat(0.0)));
    }
}
