//! The log of contacts: when each began and ended, how fast it closed, and how hard it pressed.
//!
//! Kept on accepted states only. A contact that is lost and found again within one step was never seen to end. Starts,
//! ends and closing speeds are those of the moment in which the gap is zero, between two accepted states.

use serde::{Deserialize, Serialize};

use crate::contact::{ContactState, Contacts, share_to_zero};
use crate::system::{RailContact, System};

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
    kinds: EventKinds,
    /// Wheels, rails, joints, bushes, each times the rollers.
    places: Vec<Place>,
    ended: Vec<ContactEvent>,
    time: f64,
}

/// Where two things can touch.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Place {
    /// As the last accepted state left the surfaces, if they have been near each other.
    before: Option<ContactState>,
    /// The contact, while it lasts.
    lasting: Option<ContactEvent>,
}

impl EventLog {
    /// Places where a contact can be.
    pub(crate) fn places(&self) -> usize {
        self.places.len()
    }

    fn see(&mut self, place: usize, pair: ContactPair, t: f64, now: ContactState) {
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

impl System {
    /// Chooses which contacts are logged; forgets what was logged before.
    pub fn log_events(&mut self, kinds: EventKinds) {
        let places = (self.bodies.wheels.len() + self.bodies.rails.len() + 2) * self.rollers();
        let any = kinds != EventKinds::default();
        self.events = any.then(|| EventLog {
            kinds,
            places: vec![Place::default(); places],
            ..EventLog::default()
        });
    }

    /// Contacts that ended since the last call, in the order of their ends.
    pub fn take_events(&mut self) -> Vec<ContactEvent> {
        self.events
            .as_mut()
            .map_or_else(Vec::new, |log| std::mem::take(&mut log.ended))
    }

    /// Contacts that last, with an infinite end.
    pub fn lasting_events(&self) -> Vec<ContactEvent> {
        let places = self.events.iter().flat_map(|log| &log.places);
        places.filter_map(|place| place.lasting).collect()
    }

    /// Compares the accepted state at `t` with the log.
    pub(crate) fn note_events(&mut self, t: f64) {
        let Some(mut log) = self.events.take() else {
            return;
        };
        let kinds = log.kinds;
        let known = log.ended.len();
        let rollers = self.rollers();
        let (mut first, mut first_joint) = (0, 0);
        for member in &self.chains {
            for on in member.contacts.teeth.iter().filter(|_| kinds.teeth) {
                on.contacts.each_candidate(|roller, now| {
                    let roller = first + roller;
                    let pair = ContactPair::Tooth {
                        sprocket: on.wheel,
                        roller,
                    };
                    log.see(on.wheel * rollers + roller, pair, t, now);
                });
            }
            let base = self.bodies.wheels.len();
            for on in member.contacts.rails.iter().filter(|_| kinds.guides) {
                let mut see = |roller: usize, now| {
                    let roller = first + roller;
                    let pair = ContactPair::Guide {
                        guide: on.rail,
                        roller,
                    };
                    log.see((base + on.rail) * rollers + roller, pair, t, now);
                };
                match &on.contact {
                    RailContact::Circles(contacts) => contacts.each_candidate(see),
                    RailContact::Plates(plates) => {
                        for link in 0..member.chain.links() {
                            see(link, plates.memory.state.at(link));
                        }
                    }
                }
            }
            let base = base + self.bodies.rails.len();
            let joints = if kinds.joints {
                member.chain.joints()
            } else {
                0
            };
            for index in 0..joints {
                let joint = first_joint + index;
                let pairs = [ContactPair::Joint { joint }, ContactPair::Roller { joint }];
                let contacts = member.chain.contacts_of(index);
                for (kind, (pair, now)) in pairs.into_iter().zip(contacts).enumerate() {
                    if let Some(now) = now {
                        log.see((base + kind) * rollers + joint, pair, t, now);
                    }
                }
            }
            first += member.chain.rollers();
            first_joint += member.chain.joints();
        }
        // Several may have ended within the step.
        log.ended[known..].sort_by(|a, b| a.end.total_cmp(&b.end));
        log.time = t;
        self.events = Some(log);
    }
}

impl Contacts {
    /// Calls `visit` with every roller near this body, and how it stands to it.
    ///
    /// A roller is open long before it ceases to be near.
    fn each_candidate(&self, mut visit: impl FnMut(usize, ContactState)) {
        self.for_each_slot(|slot, roller| visit(roller, self.both_sides(&self.memory.state, slot)));
    }
}
