//! The log of contacts: when each began and ended, how fast it closed, and how hard it pressed.
//!
//! Kept on accepted states only. A contact that is lost and found again within one step was never
//! seen to end; starts and ends are exact to the step.

use serde::{Deserialize, Serialize};

use crate::contact::Contacts;
use crate::system::{RailContact, System};

/// What touched what.
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
    /// What touched what.
    pub pair: ContactPair,
    /// When it began \[s\].
    pub start: f64,
    /// When it ended \[s\]; infinite while it lasts.
    pub end: f64,
    /// Closing speed at touch \[m/s\], not below the floor of the law.
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
    /// Contacts that last, by place: wheels, rails, joints, bushes, each times the rollers.
    lasting: Vec<Option<ContactEvent>>,
    ended: Vec<ContactEvent>,
    time: f64,
}

impl EventLog {
    /// Places where a contact can be.
    pub(crate) fn places(&self) -> usize {
        self.lasting.len()
    }

    fn see(&mut self, place: usize, pair: ContactPair, t: f64, seen: Option<(f64, f64)>) {
        let dt = t - self.time;
        let entry = &mut self.lasting[place];
        match (entry.as_mut(), seen) {
            (Some(event), Some((_, force))) => {
                event.peak_force = event.peak_force.max(force);
                event.impulse += force * dt;
            }
            (None, Some((onset_speed, force))) => {
                *entry = Some(ContactEvent {
                    pair,
                    start: t,
                    end: f64::INFINITY,
                    onset_speed,
                    peak_force: force,
                    impulse: force * dt,
                });
            }
            (Some(event), None) => {
                event.end = t;
                self.ended.push(*event);
                *entry = None;
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
            lasting: vec![None; places],
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
        let lasting = self.events.iter().flat_map(|log| &log.lasting);
        lasting.flatten().copied().collect()
    }

    /// Compares the accepted state at `t` with the log.
    pub(crate) fn note_events(&mut self, t: f64) {
        let Some(mut log) = self.events.take() else {
            return;
        };
        let kinds = log.kinds;
        let rollers = self.rollers();
        let (mut first, mut first_joint) = (0, 0);
        for member in &self.chains {
            for on in member.contacts.teeth.iter().filter(|_| kinds.teeth) {
                on.contacts.each_candidate(|roller, seen| {
                    let roller = first + roller;
                    let pair = ContactPair::Tooth {
                        sprocket: on.wheel,
                        roller,
                    };
                    log.see(on.wheel * rollers + roller, pair, t, seen);
                });
            }
            let base = self.bodies.wheels.len();
            for on in member.contacts.rails.iter().filter(|_| kinds.guides) {
                let mut see = |roller: usize, seen| {
                    let roller = first + roller;
                    let pair = ContactPair::Guide {
                        guide: on.rail,
                        roller,
                    };
                    log.see((base + on.rail) * rollers + roller, pair, t, seen);
                };
                match &on.contact {
                    RailContact::Circles(contacts) => contacts.each_candidate(see),
                    RailContact::Plates(plates) => {
                        for link in 0..member.chain.links() {
                            see(link, plates.memory.closed(link));
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
                let touching = member.chain.touching(index);
                for (kind, (pair, seen)) in pairs.into_iter().zip(touching).enumerate() {
                    log.see((base + kind) * rollers + joint, pair, t, seen);
                }
            }
            first += member.chain.rollers();
            first_joint += member.chain.joints();
        }
        log.time = t;
        self.events = Some(log);
    }
}

impl Contacts {
    /// Calls `visit` with every roller near this body, and the speed at touch and the force of its contact, if it has one.
    ///
    /// A roller is open long before it ceases to be near.
    fn each_candidate(&self, mut visit: impl FnMut(usize, Option<(f64, f64)>)) {
        let sides = self.sides();
        self.for_each_slot(|slot, roller| {
            // Both flanks of a gap count as one contact.
            let mut seen: Option<(f64, f64)> = None;
            for side in 0..sides {
                let index = side * self.slots + slot;
                if let Some((touch, push)) = self.memory.state.closed(index) {
                    let (speed, force) = seen.unwrap_or((0.0, 0.0));
                    seen = Some((speed.max(touch), force + push));
                }
            }
            visit(roller, seen);
        });
    }
}
