//! Impacts of rollers that come to a body: the first contact of each since it was away.
//!
//! ```text
//! v = v_a + s (v_b − v_a),   s = g_a/(g_a − g_b)     closing speed where the gap is zero
//! J = ∫ F dt                                         F along straight lines between the ends of steps
//! ```
//!
//! An impact ends where the surfaces part, or close again after they have been opening: what a seated roller bears from then on is
//! the load of the chain. A roller has been away when it was farther than half a pitch from all that it could touch.

use serde::{Deserialize, Serialize};

use super::{ContactMemory, ContactState, Contacts, share_to_zero};
use crate::MemoryError;

/// The impact of a roller that came to a sprocket: its first contact since it was away, farther than half a pitch from all teeth.
///
/// It ends where roller and tooth part, or close again after opening. Bounces and the load of the chain follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// Index of the sprocket.
    pub sprocket: usize,
    /// Number of the roller.
    pub roller: usize,
    /// When it touched \[s\].
    pub time: f64,
    /// Closing speed at touch, along the normal of the tooth \[m/s\].
    pub speed: f64,
    /// Largest normal force \[N\].
    pub peak_force: f64,
    /// ∫ F dt \[N s\].
    pub impulse: f64,
}

/// An impact that has not ended.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct OngoingImpact {
    impact: Impact,
    /// Force at the last accepted state \[N\].
    force: f64,
    /// Opening seen since the touch.
    opened: bool,
}

/// Impacts on one sprocket; rollers are numbered within their chain.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Arrivals {
    /// Nearby rollers that have struck, by roller.
    struck: Vec<bool>,
    /// Whether the rollers that already lie on the body are still to be found.
    fresh: bool,
    lasting: Vec<OngoingImpact>,
    ended: Vec<Impact>,
    /// Room for the next `struck`.
    #[serde(skip)]
    next: Vec<bool>,
}

impl Arrivals {
    /// Starts again: rollers on the body have arrived before, those on their way are still to arrive.
    pub(crate) fn begin(&mut self, rollers: usize) {
        self.lasting.clear();
        self.ended.clear();
        self.struck.clear();
        self.struck.resize(rollers, false);
        self.fresh = true;
        // Room for all at once, so that no step has to make some.
        self.next.reserve(rollers);
        self.lasting.reserve(rollers);
        self.ended.reserve(rollers);
    }

    /// Marks the rollers that are near, after the windows were renewed.
    pub(crate) fn look_around(&mut self, contacts: &Contacts) {
        let Self { struck, next, .. } = self;
        next.clear();
        next.resize(struck.len(), false);
        contacts.for_each_slot(|_, roller| {
            if let Some(struck) = struck.get(roller) {
                next[roller] = *struck;
            }
        });
        std::mem::swap(struck, next);
    }

    /// Compares the state accepted at `t` with the one before, in the memory of `contacts`; `begun`: a contact began in between.
    pub(crate) fn note(
        &mut self,
        sprocket: usize,
        contacts: &Contacts,
        now: &ContactMemory,
        t: f64,
        begun: bool,
    ) {
        let dt = t - contacts.accepted;
        let Self {
            struck,
            fresh,
            lasting,
            ended,
            ..
        } = self;
        if std::mem::take(fresh) {
            contacts.for_each_slot(|slot, roller| {
                let state = contacts.both_sides(now, slot);
                struck[roller] = state.force.is_some() || state.gap < contacts.lying();
            });
        }
        lasting.retain_mut(|it| {
            let slot = contacts.slot_of(it.impact.roller);
            let state = slot.map(|slot| contacts.both_sides(now, slot));
            let force = state.and_then(|state| state.force);
            let impact = &mut it.impact;
            impact.impulse += 0.5 * (it.force + force.unwrap_or(0.0)) * dt;
            impact.peak_force = impact.peak_force.max(force.unwrap_or(0.0));
            it.force = force.unwrap_or(0.0);
            let closes = state.is_some_and(|state| state.closing > 0.0);
            let is_over = force.is_none() || (it.opened && closes);
            it.opened |= !closes;
            if is_over {
                ended.push(*impact);
            }
            !is_over
        });
        if !begun {
            return;
        }
        contacts.for_each_slot(|slot, roller| {
            if struck.get(roller).is_none_or(|struck| *struck) {
                return;
            }
            let [before, now] =
                [&contacts.memory.state, now].map(|it| contacts.both_sides(it, slot));
            let (None, Some(force)) = (before.force, now.force) else {
                return;
            };
            struck[roller] = true;
            let share = share_to_zero(before.gap, now.gap);
            let speed = before.closing + share * (now.closing - before.closing);
            let impact = Impact {
                sprocket,
                roller,
                time: contacts.accepted + share * dt,
                speed: speed.max(0.0),
                peak_force: force,
                impulse: 0.5 * force * dt,
            };
            lasting.push(OngoingImpact {
                impact,
                force,
                opened: now.closing <= 0.0,
            });
        });
    }

    /// Impacts that ended since the last call.
    pub(crate) fn take(&mut self) -> std::vec::Drain<'_, Impact> {
        self.ended.drain(..)
    }

    /// Refuses a memory of another number of rollers.
    pub(crate) fn check(&self, rollers: usize) -> Result<(), MemoryError> {
        let known = self.lasting.iter().map(|it| it.impact.roller + 1).max();
        MemoryError::unless_within("roller of an impact", known.unwrap_or(0), rollers)?;
        MemoryError::unless("rollers of impacts", self.struck.len(), rollers)
    }
}

/// Gap below which a roller lies on the body when a record begins, over its radius. *Assumed*: a seat leaves it a few thousandths to move,
/// and one that comes along a span is farther away but in its last moment.
const LYING: f64 = 0.05;

impl Contacts {
    /// See [`LYING`] \[m\].
    fn lying(&self) -> f64 {
        LYING * self.radius
    }

    /// Contact of a roller with the body: both flanks of a gap count as one, whose forces add up; the nearer one tells when it begins.
    pub(crate) fn both_sides(&self, memory: &ContactMemory, slot: usize) -> ContactState {
        let state = |side: usize| memory.at(side * self.slots + slot);
        (1..self.sides())
            .map(state)
            .fold(state(0), ContactState::with)
    }
}
