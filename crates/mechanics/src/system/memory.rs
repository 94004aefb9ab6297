//! Memory of a system from one accepted state to the next, as plain data.
//!
//! With it, the state and the memory of the time stepping a run goes on to the last bit. What follows from the drive is not
//! in it.

use chaindrive_integrate::SecondOrderSystem;
use serde::{Deserialize, Serialize};

use super::inputs::InputPath;
use super::{Member, Record, System};
use crate::MemoryError;
use crate::applied;
use crate::bodies::{Anchor, BodyContacts, Inputs, RailContact};
use crate::chains::ChainMemory;
use crate::contact::{Arrivals, Impacts, PlateMemory, Windows};
use crate::seam::EventLog;
use crate::seam::Rates;
use crate::watch::Watch;

/// Contacts, windows, inputs and the log of a [`System`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SystemMemory {
    chains: Vec<MemberMemory>,
    inputs: Inputs,
    courses: Vec<InputPath>,
    events: Option<EventLog>,
    applied: applied::AppliedForces,
    time_scales: [f64; 4],
    watch: Option<Box<Watch>>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct MemberMemory {
    chain: ChainMemory,
    teeth: Vec<(Anchor, Windows, Arrivals)>,
    rails: Vec<RailMemory>,
    renew: (f64, u32),
    rates: Rates,
    impacts: Vec<Impacts>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum RailMemory {
    Circles(Windows),
    Plates(PlateMemory),
}

impl System {
    /// Its memory.
    pub fn memory(&self) -> SystemMemory {
        SystemMemory {
            chains: self.chains.iter().map(Member::memory).collect(),
            inputs: self.bodies.inputs.clone(),
            courses: self.on_courses(),
            events: self.events.clone(),
            applied: self.applied.clone(),
            time_scales: self.time_scales,
            watch: self.watch.clone(),
        }
    }

    /// Goes on from what another system of the same drive remembered.
    ///
    /// # Errors
    /// [`MemoryError`] where the drive is seen to be another one; the system is not to be used any more then.
    pub fn remember(&mut self, memory: SystemMemory) -> Result<(), MemoryError> {
        MemoryError::unless("chains", memory.chains.len(), self.chains.len())?;
        for (member, memory) in self.chains.iter_mut().zip(memory.chains) {
            member.remember(memory)?;
        }
        let places = memory.events.as_ref().map_or(0, EventLog::places);
        MemoryError::unless(
            "places of contacts",
            places,
            self.events.as_ref().map_or(0, EventLog::places),
        )?;
        match (&memory.watch, &self.watch) {
            (None, None) => {}
            (Some(watch), Some(own)) => watch.check(own)?,
            (Some(_), None) | (None, Some(_)) => return Err(MemoryError::Model),
        }
        self.set_again(&memory.courses, &memory.inputs.tuned)?;
        self.bodies.inputs = memory.inputs;
        self.events = memory.events;
        self.applied = memory.applied;
        self.time_scales = memory.time_scales;
        self.watch = memory.watch;
        Ok(())
    }

    /// Refuses a record that is not of this system.
    ///
    /// # Errors
    /// [`MemoryError`].
    pub fn check_record(&self, record: &Record) -> Result<(), MemoryError> {
        let own = self.new_record();
        let lengths = |record: &Record| {
            let bodies = [record.wheel_wrenches.len(), record.rail_wrenches.len()];
            let chains = record.chains.iter().map(|chain| {
                let loads = &chain.loads;
                let touches = [loads.teeth.len(), loads.rails.len()];
                let wrenches = [loads.wheel_wrenches.len(), loads.rail_wrenches.len()];
                let frames = [loads.frames.len(), loads.ways.len()];
                [touches, wrenches, frames]
            });
            (bodies, chains.collect::<Vec<_>>())
        };
        if lengths(record) == lengths(&own) {
            Ok(())
        } else {
            Err(MemoryError::Model)
        }
    }
}

impl Member {
    fn memory(&self) -> MemberMemory {
        let BodyContacts { teeth, rails } = &self.contacts;
        let teeth = teeth.iter();
        let teeth = teeth.map(|on| (on.anchor, on.contacts.windows(), on.arrivals.clone()));
        let rails = rails.iter().map(|on| match &on.contact {
            RailContact::Circles(contacts) => RailMemory::Circles(contacts.windows()),
            RailContact::Plates(plates) => RailMemory::Plates(plates.remembered()),
        });
        MemberMemory {
            chain: self.chain.memory(),
            teeth: teeth.collect(),
            rails: rails.collect(),
            renew: self.renew,
            rates: self.rates,
            impacts: self.impacts().copied().collect(),
        }
    }

    fn remember(&mut self, memory: MemberMemory) -> Result<(), MemoryError> {
        let rollers = self.chain.rollers();
        self.chain.remember(memory.chain)?;
        let BodyContacts { teeth, rails } = &mut self.contacts;
        MemoryError::unless("sprockets of a chain", memory.teeth.len(), teeth.len())?;
        for (on, (anchor, windows, arrivals)) in teeth.iter_mut().zip(memory.teeth) {
            on.contacts.remember(windows, rollers)?;
            arrivals.check(rollers)?;
            on.arrivals = arrivals;
            on.anchor = anchor;
        }
        MemoryError::unless("guides of a chain", memory.rails.len(), rails.len())?;
        for (on, memory) in rails.iter_mut().zip(memory.rails) {
            match (&mut on.contact, memory) {
                (RailContact::Circles(contacts), RailMemory::Circles(windows)) => {
                    contacts.remember(windows, rollers)?;
                }
                (RailContact::Plates(plates), RailMemory::Plates(memory)) => {
                    plates.remember(memory)?;
                }
                (RailContact::Circles(_), RailMemory::Plates(_))
                | (RailContact::Plates(_), RailMemory::Circles(_)) => {
                    return Err(MemoryError::Model);
                }
            }
        }
        self.renew = memory.renew;
        self.rates = memory.rates;
        let known = memory.impacts.len();
        MemoryError::unless("places of impacts", known, self.impacts().count())?;
        for (own, then) in self.impacts_mut().zip(memory.impacts) {
            *own = then;
        }
        self.press_sideways();
        Ok(())
    }
}
