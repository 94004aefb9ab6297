//! Memory of the contacts with one body, as plain data.

use chaindrive_integrate::Array;
use serde::{Deserialize, Serialize};

use super::{Contacts, PlateContact, Run, Touch};
use crate::MemoryError;
use crate::lanes::{LANES, padded};

/// Windows of rollers near a body, and the states of the contacts in them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Windows {
    runs: Vec<Run>,
    axes: [Array; 2],
    memory: Box<Touch>,
    accepted: f64,
}

/// States of the contacts of link plates.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PlateMemory {
    near: Vec<usize>,
    memory: Box<Touch>,
    accepted: f64,
}

impl Contacts {
    /// Their memory.
    pub(crate) fn windows(&self) -> Windows {
        Windows {
            runs: self.runs.clone(),
            axes: [self.axis_x.clone(), self.axis_y.clone()],
            memory: self.memory.clone(),
            accepted: self.accepted,
        }
    }

    /// Goes on from there; `rollers` are those of the chain, its copies not counted.
    pub(crate) fn remember(&mut self, windows: Windows, rollers: usize) -> Result<(), MemoryError> {
        let slots = windows.runs.len() * LANES;
        let last = windows.runs.iter().map(|run| run.start + run.count).max();
        MemoryError::unless_within("roller", last.unwrap_or(0), rollers)?;
        let widest = windows.runs.iter().map(|run| run.count).max();
        MemoryError::unless_within("roller of a lane", widest.unwrap_or(0), LANES)?;
        for axis in &windows.axes {
            MemoryError::unless("gap axes", axis.len(), slots)?;
        }
        let contacts = slots * self.sides();
        MemoryError::unless("lanes at rest", windows.memory.wake.len(), contacts)?;
        windows.memory.state.check(contacts)?;
        self.runs = windows.runs;
        self.candidates = self.runs.iter().map(|run| run.count).sum();
        self.slots = slots;
        [self.axis_x, self.axis_y] = windows.axes;
        self.memory = windows.memory;
        self.accepted = windows.accepted;
        self.renew_uneven();
        Ok(())
    }
}

impl PlateContact {
    /// Its memory.
    pub(crate) fn remembered(&self) -> PlateMemory {
        PlateMemory {
            near: self.near.clone(),
            memory: self.memory.clone(),
            accepted: self.accepted,
        }
    }

    /// Goes on from there.
    pub(crate) fn remember(&mut self, memory: PlateMemory) -> Result<(), MemoryError> {
        let contacts = padded(self.links);
        MemoryError::unless("lanes at rest", memory.memory.wake.len(), contacts)?;
        memory.memory.state.check(contacts)?;
        let last = memory.near.iter().map(|first| first + LANES).max();
        MemoryError::unless_within("link", last.unwrap_or(0), contacts)?;
        let first_of_lanes = memory.near.iter().all(|first| first % LANES == 0);
        if !first_of_lanes {
            return Err(MemoryError::Model);
        }
        self.near = memory.near;
        self.memory = memory.memory;
        self.accepted = memory.accepted;
        Ok(())
    }
}
