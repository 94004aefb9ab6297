//! Impacts in a drive since the start.
//!
//! Counted on accepted states, whether contacts are logged or not. A contact that is lost and found again within one step was never seen
//! to end; where a tooth gap touches a roller at two places these are two.

use crate::System;
use crate::contact::{Impact, Impacts};

/// Impacts between parts of one kind, of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyImpacts {
    /// In words, such as "teeth of crank".
    pub place: String,
    /// The kind that is counted.
    pub impacts: Impacts,
    /// Depth \[m\] from which on the law is no more than its own tangent, where there is one.
    pub reach: Option<f64>,
    /// Floor of the law \[m/s\].
    pub floor: f64,
}

impl System {
    /// Counts contacts from here on; what lasts has begun before, and rollers that lie on a sprocket have come.
    pub fn forget_impacts(&mut self) {
        for member in &mut self.chains {
            for impacts in member.impacts_mut() {
                *impacts = Impacts::default();
            }
            let rollers = member.chain.rollers();
            for on in &mut member.contacts.teeth {
                on.arrivals.begin(rollers);
            }
        }
    }

    /// Appends impacts of rollers that came to a sprocket, those that ended since the last call.
    pub fn hand_out_impacts(&mut self, to: &mut Vec<Impact>) {
        let mut first = 0;
        for member in &mut self.chains {
            for on in &mut member.contacts.teeth {
                to.extend(on.arrivals.take().map(|impact| Impact {
                    roller: first + impact.roller,
                    ..impact
                }));
            }
            first += member.chain.rollers();
        }
    }

    /// Impacts since the start, of every sprocket, guide and chain where anything can touch.
    pub fn struck(&self) -> Vec<BodyImpacts> {
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
                all.push(BodyImpacts {
                    place: format!("teeth of {}", wheels[on.wheel].name),
                    impacts: on.impacts,
                    reach: [law.reach(), flank].into_iter().flatten().reduce(f64::min),
                    floor: law.onset_floor(),
                });
            }
            for on in &member.contacts.rails {
                let law = on.contact.surface().law.prepared();
                all.push(BodyImpacts {
                    place: format!("guide {}", rails[on.rail].name),
                    impacts: on.impacts,
                    reach: law.reach(),
                    floor: law.onset_floor(),
                });
            }
            let [pins, bushes] = member.chain.bearing_laws();
            let of_joints = [("pins in bushes", pins), ("bushes in rollers", bushes)];
            for ((what, law), impacts) in of_joints.into_iter().zip(member.joint_impacts) {
                let Some(law) = law else { continue };
                all.push(BodyImpacts {
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
