//! Bushes turn with their inner link: how fast, and what their friction on teeth and guides does to that link.
//!
//! ```text
//! slip = t·u − ω r + …,   M = −r R        on the inner link, R: friction on the bush along t
//! F = ± M n/ℓ                             couple at the pins of that link
//! ```

use chaindrive_contact::Friction;
use chaindrive_integrate::Array;

use super::Strands;
use super::model::BushStrands;
use crate::bodies::{BodyContacts, RailContact};
use crate::chains::particles::{Particles, Turning};
use crate::contact::{Contacts, Touch};
use crate::lanes::LANES;
use crate::seam::Loads;

/// The inner link of every joint, copies after the last one included; the only link of the joint where the chain ends in an outer one.
pub(super) fn bearers(model: &BushStrands, chain: &Particles) -> Vec<usize> {
    let (links, joints) = (chain.series.links, chain.series.rollers);
    let bearer = |joint: usize| {
        let before = (joint + links - 1) % links;
        match joint {
            0 if !chain.links.closed => 0,
            joint if joint == links => before,
            joint if model.is_inner(joint) => joint,
            _ => before,
        }
    };
    (0..chain.series.stride)
        .map(|i| bearer(i % joints))
        .collect()
}

/// All contacts of bushes with bodies that rub, and what is found in them.
fn rubbing<'a>(
    contacts: &'a BodyContacts,
    loads: &'a Loads,
) -> impl Iterator<Item = (&'a Contacts, &'a Touch)> {
    let teeth = contacts.teeth.iter().map(|on| Some(&on.contacts));
    let rails = contacts.rails.iter().map(|on| match &on.contact {
        RailContact::Circles(contacts) => Some(contacts),
        RailContact::Plates(_) => None,
    });
    let touches = loads.teeth.iter().chain(&loads.rails);
    let found = teeth.chain(rails).zip(touches);
    let rubs = |it: &Contacts| it.surface.friction != Friction::None;
    found.filter_map(move |(on, touch)| Some((on.filter(|it| rubs(it))?, &**touch)))
}

impl Strands {
    /// Angular speeds of all bushes \[rad/s\]; none where nothing rubs on them.
    pub(super) fn spin(
        &self,
        turning: &Turning,
        contacts: &BodyContacts,
        loads: &Loads,
        spin: &mut Array,
    ) {
        let rubs = rubbing(contacts, loads).next().is_some();
        spin.resize(if rubs { self.bearers.len() } else { 0 }, 0.0);
        for (spin, link) in spin.iter_mut().zip(&self.bearers) {
            *spin = turning.rate[LANES + link];
        }
    }

    /// Adds what friction on the bushes does to their links.
    pub(super) fn turn(
        &self,
        turning: &Turning,
        contacts: &BodyContacts,
        loads: &Loads,
        a: &mut [f64],
    ) {
        let (n, joints) = (self.chain.series.stride, self.chain.series.rollers);
        let [x, y] = &turning.across;
        for (on, touch) in rubbing(contacts, loads) {
            on.for_each_slot(|slot, joint| {
                let closed = (0..on.sides()).map(|side| side * on.slots + slot);
                let closed = closed.filter(|contact| touch.state.is_closed(*contact));
                let friction: f64 = closed.map(|contact| touch.faces.rub[contact]).sum();
                let link = self.bearers[joint];
                let moment = -on.radius * friction;
                for (pin, sign) in [(link, -moment), ((link + 1) % joints, moment)] {
                    let push = sign * self.chain.inverse_masses[pin];
                    a[pin] += x[link] * push;
                    a[n + pin] += y[link] * push;
                }
            });
        }
    }
}
