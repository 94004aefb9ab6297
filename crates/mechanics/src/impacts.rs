//! What has touched since the start: how often, how fast, how deep.
//!
//! Counted on accepted states, whether contacts are logged or not. A contact that is lost and found again within one step was never seen
//! to end; where a tooth gap touches a roller at two places these are two.

use serde::{Deserialize, Serialize};

use crate::System;
use crate::contact::Begun;
use crate::events::ContactPair;
use crate::system::Member;

/// Contacts of two parts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Impacts {
    /// Contacts that began.
    pub count: u64,
    /// Those that closed slower than the floor of the law, which acts on them as a damper.
    pub gentle: u64,
    /// Greatest closing speed at touch \[m/s\].
    pub fastest: f64,
    /// Deepest indentation \[m\].
    pub deepest: f64,
}

/// What parts of one kind, of one body, have done to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Struck {
    /// What touched what; of rollers and joints the first.
    pub pair: ContactPair,
    /// In words, such as "teeth of crank".
    pub place: String,
    /// What is counted.
    pub impacts: Impacts,
    /// Depth \[m\] from which on the law is no more than its own tangent, where there is one.
    pub reach: Option<f64>,
    /// Floor of the law \[m/s\].
    pub floor: f64,
}

impl Impacts {
    /// Takes in what an accepted state shows.
    pub(crate) fn note(&mut self, begun: &Begun, depth: f64) {
        self.deepest = self.deepest.max(depth);
        if begun.count > 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a number of contacts"
            )]
            let [count, gentle] = [begun.count, begun.gentle].map(|number| number as u64);
            self.count += count;
            self.gentle += gentle;
            self.fastest = self.fastest.max(begun.fastest);
        }
    }
}

impl Member {
    /// What is counted of the chain, in one order.
    pub(crate) fn impacts(&self) -> impl Iterator<Item = &Impacts> {
        let teeth = self.contacts.teeth.iter().map(|on| &on.impacts);
        let rails = self.contacts.rails.iter().map(|on| &on.impacts);
        teeth.chain(rails).chain(&self.joint_impacts)
    }

    /// The same, to change it.
    pub(crate) fn impacts_mut(&mut self) -> impl Iterator<Item = &mut Impacts> {
        let teeth = self.contacts.teeth.iter_mut().map(|on| &mut on.impacts);
        let rails = self.contacts.rails.iter_mut().map(|on| &mut on.impacts);
        teeth.chain(rails).chain(&mut self.joint_impacts)
    }
}

impl System {
    /// Counts contacts from here on; what lasts has begun before.
    pub fn forget_impacts(&mut self) {
        for impacts in self.chains.iter_mut().flat_map(Member::impacts_mut) {
            *impacts = Impacts::default();
        }
    }

    /// What has touched since the start, of every sprocket, guide and chain where anything can.
    pub fn struck(&self) -> Vec<Struck> {
        let mut all = Vec::new();
        for member in &self.chains {
            let (wheels, rails) = (&self.bodies.wheels, &self.bodies.rails);
            let of_chain = match &member.name {
                Some(name) => format!(" of {name}"),
                None => String::new(),
            };
            for on in &member.contacts.teeth {
                let law = on.contacts.surface.law.prepared();
                let flank = on
                    .contacts
                    .flank
                    .and_then(|flank| flank.law(&on.contacts.surface).prepared().reach());
                all.push(Struck {
                    pair: ContactPair::Tooth {
                        sprocket: on.wheel,
                        roller: 0,
                    },
                    place: format!("teeth of {}", wheels[on.wheel].name),
                    impacts: on.impacts,
                    reach: [law.reach(), flank].into_iter().flatten().reduce(f64::min),
                    floor: law.onset_floor(),
                });
            }
            for on in &member.contacts.rails {
                let law = on.contact.surface().law.prepared();
                all.push(Struck {
                    pair: ContactPair::Guide {
                        guide: on.rail,
                        roller: 0,
                    },
                    place: format!("guide {}", rails[on.rail].name),
                    impacts: on.impacts,
                    reach: law.reach(),
                    floor: law.onset_floor(),
                });
            }
            let [pins, bushes] = member.chain.bearing_laws();
            let of_joints = [
                (ContactPair::Joint { joint: 0 }, "pins in bushes", pins),
                (
                    ContactPair::Roller { joint: 0 },
                    "bushes in rollers",
                    bushes,
                ),
            ];
            for ((pair, what, law), impacts) in of_joints.into_iter().zip(member.joint_impacts) {
                let Some(law) = law else { continue };
                all.push(Struck {
                    pair,
                    place: format!("{what}{of_chain}"),
                    impacts,
                    reach: law.reach(),
                    floor: law.onset_floor(),
                });
            }
        }
        all
    }
}
