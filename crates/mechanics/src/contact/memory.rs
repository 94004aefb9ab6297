//! Memory of contacts of any kind.
//!
//! A contact is closed from the first accepted state with a penetration to the last one. Its memory counts only in between:
//! a contact that begins takes nothing from the one that was there before, neither the speed at touch nor the bristles of its
//! friction.

use chaindrive_integrate::Array;
use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::MemoryError;
use crate::lanes::{LANES, Lane, Lanes, LanesMut, Mask, Wide, padded};

/// Gap \[m\] of what cannot touch.
pub(crate) const FAR: f64 = 1.0;

/// Quantities remembered of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MemoryField {
    /// Inverse of the closing speed at touch \[s/m\]; zero while open.
    InverseOnset,
    /// Gap \[m\], negative in contact; where there is oil, what the law behind the film sees.
    Gap,
    /// Closing speed \[m/s\].
    Closing,
    /// Normal force \[N\].
    Force,
    /// Acceleration of a closed contact's circle towards the surface by all else that acts on it \[m/s²\]; kept where steps look ahead.
    Thrust,
    /// State of a friction law that has one; means something while closed.
    Stick,
    /// Share of the flank's law, where there is one; means something while closed.
    Share,
    /// What has been squeezed out of the film of oil \[m\], and how fast it drains \[m/s\]; kept where there is one.
    Squeezed,
    Draining,
}

impl MemoryField {
    const COUNT: usize = Self::Draining as usize + 1;
}

/// State of contacts at one instant, whole lanes.
///
/// Contacts stand in blocks of eight, and a block has eight numbers of everything that is [`MemoryField`]: a kernel looks at one array, once,
/// and what it wants of a lane is in one place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactMemory {
    numbers: Array,
}

/// Numbers of a block.
const BLOCK: usize = MemoryField::COUNT * LANES;

/// Numbers of the blocks that hold as many contacts.
const fn blocks(count: usize) -> usize {
    padded(count) * MemoryField::COUNT
}

/// Index of a number of a contact.
const fn place(what: MemoryField, contact: usize) -> usize {
    contact / LANES * BLOCK + what as usize * LANES + contact % LANES
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
        self.numbers.clear();
        self.numbers.resize(blocks(count), 0.0);
        for contact in 0..self.len() {
            self.set(MemoryField::Gap, contact, FAR);
        }
    }

    #[inline]
    pub(crate) fn resize(&mut self, count: usize) {
        if self.numbers.len() != blocks(count) {
            self.numbers.resize(blocks(count), 0.0);
        }
    }

    /// Number of contacts, whole blocks.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len() / MemoryField::COUNT
    }

    #[inline]
    pub(crate) fn get(&self, what: MemoryField, contact: usize) -> f64 {
        self.numbers[place(what, contact)]
    }

    #[inline]
    pub(crate) fn set(&mut self, what: MemoryField, contact: usize, value: f64) {
        self.numbers[place(what, contact)] = value;
    }

    /// One kind of number of the eight contacts of a block.
    #[inline]
    pub(crate) fn row(&self, what: MemoryField, block: usize) -> &[f64] {
        &self.numbers[block * BLOCK + what as usize * LANES..][..LANES]
    }

    /// One kind of number, of one contact after the other.
    pub(crate) fn each(&self, what: MemoryField) -> impl Iterator<Item = f64> {
        let blocks = 0..self.len() / LANES;
        blocks.flat_map(move |block| self.row(what, block).iter().copied())
    }

    /// The same, eight contacts at a time.
    pub(crate) fn eights(&self, what: MemoryField) -> impl Iterator<Item = &[f64]> {
        let row = what as usize * LANES;
        let blocks = self.numbers.chunks_exact(BLOCK);
        blocks.map(move |block| &block[row..row + LANES])
    }

    /// Takes over one contact of another memory.
    pub(crate) fn carry(&mut self, to: usize, other: &Self, from: usize) {
        let [to, from] = [to, from].map(|contact| place(MemoryField::InverseOnset, contact));
        for row in (0..BLOCK).step_by(LANES) {
            self.numbers[to + row] = other.numbers[from + row];
        }
    }

    /// Whether a contact is closed.
    #[inline]
    pub(crate) fn is_closed(&self, contact: usize) -> bool {
        self.get(MemoryField::InverseOnset, contact) > 0.0
    }

    /// Speed at touch \[m/s\] and force \[N\] of a closed contact.
    pub(crate) fn closed(&self, contact: usize) -> Option<(f64, f64)> {
        let inverse = self.get(MemoryField::InverseOnset, contact);
        (inverse > 0.0).then(|| (1.0 / inverse, self.get(MemoryField::Force, contact)))
    }

    /// Refuses a memory of another number of contacts.
    pub(crate) fn check(&self, count: usize) -> Result<(), MemoryError> {
        MemoryError::unless("contacts", self.len(), padded(count))
    }

    /// A contact as it is.
    pub(crate) fn at(&self, contact: usize) -> ContactState {
        ContactState {
            gap: self.get(MemoryField::Gap, contact),
            closing: self.get(MemoryField::Closing, contact),
            force: self.closed(contact).map(|(_, force)| force),
        }
    }
}

/// Share of a step after which a gap that changes its sign is zero.
///
/// ```text
/// s = g_a/(g_a − g_b)
/// ```
pub(crate) fn share_to_zero(before: f64, now: f64) -> f64 {
    let share = before / (before - now);
    // Not a number where nothing has moved.
    if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        1.0
    }
}

/// Contacts lane by lane: as the last accepted state left them, and as they are found now.
pub(crate) struct MemoryLanes<'a, S: Simd> {
    before: Lanes<'a, S>,
    now: LanesMut<'a, S>,
}

/// Onset of a contact between the last accepted state and now.
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
        let count = blocks(count);
        Self {
            before: w.lanes(&before.numbers[..count]),
            now: Wide::<S>::lanes_mut(&mut now.numbers[..count]),
        }
    }

    /// Which lane of all numbers holds one kind of some contacts.
    #[inline(always)]
    fn place(what: MemoryField, lane: usize) -> usize {
        // Lanes of a processor that a row of eight fills.
        let row = LANES / Wide::<S>::COUNT;
        lane / row * (MemoryField::COUNT * row) + what as usize * row + lane % row
    }

    #[inline(always)]
    fn before(&self, what: MemoryField, lane: usize) -> Lane<S> {
        self.before.get(Self::place(what, lane))
    }

    #[inline(always)]
    fn keep(&mut self, what: MemoryField, lane: usize, value: Lane<S>) {
        self.now.set(Self::place(what, lane), value);
    }

    /// Writes down where the surfaces of a lane are.
    #[inline(always)]
    pub(crate) fn look(&mut self, lane: usize, gap: Lane<S>, closing: Lane<S>) {
        self.keep(MemoryField::Gap, lane, gap);
        self.keep(MemoryField::Closing, lane, closing);
    }

    /// Opens a lane.
    #[inline(always)]
    pub(crate) fn open(&mut self, w: Wide<S>, lane: usize) {
        self.keep(MemoryField::InverseOnset, lane, w.splat(0.0));
        self.keep(MemoryField::Force, lane, w.splat(0.0));
    }

    /// Inverse of the speed at touch of contacts that were closed before, zero for the others.
    #[inline(always)]
    pub(crate) fn inverse_onset(&self, lane: usize) -> Lane<S> {
        self.before(MemoryField::InverseOnset, lane)
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
        let gap_before = self.before(MemoryField::Gap, lane).max(w.splat(0.0));
        let closing_before = self.before(MemoryField::Closing, lane);
        let share = gap_before * (gap_before + depth).recip();
        Onset {
            speed: closing_before + share * (closing - closing_before),
            share,
        }
    }

    /// Keeps the inverse speeds at touch, zero where open.
    #[inline(always)]
    pub(crate) fn keep_onset(&mut self, lane: usize, inverse: Lane<S>) {
        self.keep(MemoryField::InverseOnset, lane, inverse);
    }

    /// Forces \[N\], and what else drew the circles towards their surfaces \[m/s²\], at the last accepted state.
    #[inline(always)]
    pub(super) fn pushed(&self, lane: usize) -> [Lane<S>; 2] {
        [
            self.before(MemoryField::Force, lane),
            self.before(MemoryField::Thrust, lane),
        ]
    }

    /// Keeps what else draws the circles.
    #[inline(always)]
    pub(super) fn keep_thrust(&mut self, lane: usize, thrust: Lane<S>) {
        self.keep(MemoryField::Thrust, lane, thrust);
    }

    /// Keeps the forces, zero where open.
    #[inline(always)]
    pub(crate) fn keep_force(&mut self, lane: usize, force: Lane<S>) {
        self.keep(MemoryField::Force, lane, force);
    }

    /// Forces of a lane that has been written \[N\], zero where open.
    #[inline(always)]
    pub(super) fn force(&self, w: Wide<S>, lane: usize) -> Lane<S> {
        self.now.get(w, Self::place(MemoryField::Force, lane))
    }

    #[inline(always)]
    pub(crate) fn keep_share(&mut self, lane: usize, share: Lane<S>) {
        self.keep(MemoryField::Share, lane, share);
    }

    /// Gap \[m\] at the last accepted state, what had been squeezed out of the film \[m\], and how fast it drained \[m/s\].
    #[inline(always)]
    pub(super) fn squeezed(&self, lane: usize) -> [Lane<S>; 3] {
        [
            MemoryField::Gap,
            MemoryField::Squeezed,
            MemoryField::Draining,
        ]
        .map(|what| self.before(what, lane))
    }

    /// Keeps the state of the film.
    #[inline(always)]
    pub(super) fn keep_squeezed(&mut self, lane: usize, squeezed: Lane<S>, draining: Lane<S>) {
        self.keep(MemoryField::Squeezed, lane, squeezed);
        self.keep(MemoryField::Draining, lane, draining);
    }

    /// State of the friction of contacts that were closed before; the others begin without.
    #[inline(always)]
    pub(crate) fn stick(&self, w: Wide<S>, lane: usize) -> Lane<S> {
        let zero = w.splat(0.0);
        let was_closed = self.before(MemoryField::InverseOnset, lane).greater(zero);
        was_closed.select(self.before(MemoryField::Stick, lane), zero)
    }

    /// Keeps the state of the friction where closed.
    #[inline(always)]
    pub(crate) fn keep_stick(&mut self, w: Wide<S>, lane: usize, closed: Mask<S>, stick: Lane<S>) {
        self.keep(MemoryField::Stick, lane, closed.select(stick, w.splat(0.0)));
    }
}
