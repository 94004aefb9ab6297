//! The log of contacts: when each began and ended, how fast it closed, and how hard it pressed.
//!
//! Kept on accepted states only. A contact that is lost and found again within one step was never seen to end. Starts,
//! ends and closing speeds are those of the moment in which the gap is zero, between two accepted states.

use serde::{Deserialize, Serialize};

use crate::contact::{ContactState, share_to_zero};

/// Kind of a contact: the two bodies that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ContactPair {
    /// A roller and the teeth of a sprocket.
    Tooth {
        /// Index of the sprocket.
        sprocket: usize,
        /// Number of the roller.
        roller: usize,
    },
    /// A roller, or plate eye, and a guide.
    Guide {
        /// Index of the guide.
        guide: usize,
        /// Number of the roller.
        roller: usize,
    },
    /// A pin and its bush.
    Joint {
        /// Number of the joint.
        joint: usize,
    },
    /// A bush and the free roller on it.
    Roller {
        /// Number of the joint.
        joint: usize,
    },
}

/// One contact from touch to parting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactEvent {
    /// Kind of a contact: the two bodies that touch.
    pub pair: ContactPair,
    /// When it began \[s\].
    pub start: f64,
    /// When it ended \[s\]; infinite while it lasts.
    pub end: f64,
    /// Closing speed at touch \[m/s\], also where it lies below the floor of the law.
    pub onset_speed: f64,
    /// Largest normal force \[N\].
    pub peak_force: f64,
    /// ∫ F dt \[N s\].
    pub impulse: f64,
}

/// Which contacts are logged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventKinds {
    /// Rollers on teeth.
    pub teeth: bool,
    /// Rollers on guides.
    pub guides: bool,
    /// Pins in bushes, and bushes in free rollers.
    pub joints: bool,
}

/// The log, and the contacts that last.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct EventLog {
    pub(crate) kinds: EventKinds,
    /// Wheels, rails, joints, bushes, each times the rollers.
    places: Vec<LoggedPair>,
    pub(crate) ended: Vec<ContactEvent>,
    pub(crate) time: f64,
}

/// A pair of surfaces that can touch, with its state.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct LoggedPair {
    /// As the last accepted state left the surfaces, if they have been near each other.
    before: Option<ContactState>,
    /// The contact, while it lasts.
    lasting: Option<ContactEvent>,
}

impl EventLog {
    /// An empty log of so many places.
    pub(crate) fn new(kinds: EventKinds, places: usize) -> Self {
        Self {
            kinds,
            places: vec![LoggedPair::default(); places],
            ..Self::default()
        }
    }

    /// Contacts that last.
    pub(crate) fn lasting(&self) -> impl Iterator<Item = ContactEvent> {
        self.places.iter().filter_map(|place| place.lasting)
    }

    /// Places where a contact can be.
    pub(crate) fn places(&self) -> usize {
        self.places.len()
    }

    pub(crate) fn see(&mut self, place: usize, pair: ContactPair, t: f64, now: ContactState) {
        let dt = t - self.time;
        let place = &mut self.places[place];
        let before = place.before.replace(now);
        // Asked for where a contact begins or ends, which few do. Without a state before it was there from the start.
        let share = || before.map_or(1.0, |before| share_to_zero(before.gap, now.gap));
        match (place.lasting.as_mut(), now.force) {
            (Some(event), Some(force)) => {
                event.peak_force = event.peak_force.max(force);
                event.impulse += force * dt;
            }
            (None, Some(force)) => {
                let share = share();
                // v = v_a + s (v_b − v_a)
                let closing = before.map_or(now.closing, |before| before.closing);
                let onset_speed = closing + share * (now.closing - closing);
                place.lasting = Some(ContactEvent {
                    pair,
                    start: self.time + share * dt,
                    end: f64::INFINITY,
                    onset_speed: onset_speed.max(0.0),
                    peak_force: force,
                    impulse: force * dt,
                });
            }
            (Some(event), None) => {
                event.end = self.time + share() * dt;
                self.ended.push(*event);
                place.lasting = None;
            }
            (None, None) => {}
        }
    }
}
