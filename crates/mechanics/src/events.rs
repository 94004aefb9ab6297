//! Writing the log of contacts, and reading it.

use crate::bodies::RailContact;
use crate::seam::{ContactEvent, ContactPair, EventKinds, EventLog};
use crate::system::System;

impl System {
    /// Chooses which contacts are logged; forgets what was logged before.
    pub fn log_events(&mut self, kinds: EventKinds) {
        let places = (self.bodies.wheels.len() + self.bodies.rails.len() + 2) * self.rollers();
        let any = kinds != EventKinds::default();
        self.events = any.then(|| EventLog::new(kinds, places));
    }

    /// Appends contacts that ended since the last call, in the order of their ends.
    pub fn hand_out_events(&mut self, to: &mut Vec<ContactEvent>) {
        if let Some(log) = &mut self.events {
            to.append(&mut log.ended);
        }
    }

    /// Contacts that last, with an infinite end.
    pub fn lasting_events(&self) -> Vec<ContactEvent> {
        self.events.iter().flat_map(EventLog::lasting).collect()
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
