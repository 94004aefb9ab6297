//! The inside of a drive, as plain numbers: for tests that compare two ways to compute them.

use chaindrive_integrate::Moment;

pub use crate::chains::{Contact, Inside, Joints};
use crate::contact::MemoryField;
use crate::system::{Record, System};

/// The first chain of a drive, of rigid links, with the state that a record is of.
///
/// # Panics
/// If the chain is made of anything else.
pub fn chain<'a>(system: &'a System, record: &'a mut Record) -> Inside<'a> {
    let chain = &system.chains[0].chain;
    Inside::of(chain, &mut record.chains[0], system.group_bodies(0))
        .expect("a chain of rigid links")
}

/// A roller near a tooth, by the lanes and by a look at the surface.
#[derive(Clone, Copy, Debug)]
pub struct Tooth {
    /// Gap \[m\] by the lanes, and by the look.
    pub gaps: [f64; 2],
    /// Closing speed \[m/s\].
    pub closing: f64,
    /// 1/onset speed \[s/m\].
    pub inverse_onset: f64,
    /// Normal force \[N\].
    pub force: f64,
    /// Share of the flank in the law at its place.
    pub share: f64,
}

/// All rollers of the first chain that face a tooth with a flank of its own.
pub fn teeth(system: &System, record: &Record, at: Moment<'_>) -> Vec<Tooth> {
    let member = &system.chains[0];
    let mut found = Vec::new();
    let loads = &record.chains[0].loads.teeth;
    for (on, touch) in member.contacts.teeth.iter().zip(loads) {
        let frame = system.bodies.wheel_frame(on.wheel, &on.anchor, at);
        let contacts = &on.contacts;
        let Some(flank) = contacts.flank else {
            continue;
        };
        contacts.for_each_slot(|slot, roller| {
            let place = member.chain.roller_moving(at.q, roller).place;
            let Some(probe) = contacts.probes(&frame, roller, place).pop() else {
                return;
            };
            let kept = |what| touch.state.get(what, slot);
            found.push(Tooth {
                gaps: [kept(MemoryField::Gap), probe.gap],
                closing: kept(MemoryField::Closing),
                inverse_onset: kept(MemoryField::InverseOnset),
                force: kept(MemoryField::Force),
                share: flank.share(probe.beyond),
            });
        });
    }
    found
}
