//! Contacts and friction in the joints of a chain: what an evaluation finds, and what is remembered of the accepted state.

use serde::{Deserialize, Serialize};

use super::{Joints, Resistance};
use crate::MemoryError;
use crate::contact::{ContactMemory, Tally};

/// State of the contacts in all joints at an accepted moment; empty where there are none.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JointMemory {
    pub(crate) time: f64,
    /// Pins in their bushes.
    pub(crate) pins: ContactMemory,
    /// Bushes in their rollers.
    pub(crate) bushes: ContactMemory,
}

/// Results of one evaluation in the joints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JointFindings {
    pub(crate) memory: JointMemory,
    /// Contacts of pins in bushes, and of bushes in rollers.
    pub(crate) tallies: [Tally; 2],
    /// What resists beside the contacts; empty where nothing does.
    pub(crate) resistance: Resistance,
}

impl JointMemory {
    /// Open contacts: of so many pins, and of so many rollers.
    pub(crate) fn open(time: f64, [pins, bushes]: [usize; 2]) -> Self {
        Self {
            time,
            pins: ContactMemory::open(pins),
            bushes: ContactMemory::open(bushes),
        }
    }

    /// Takes what an evaluation found, friction included.
    pub(crate) fn commit(&mut self, joints: Option<&mut Joints>, found: &mut JointFindings) {
        std::mem::swap(self, &mut found.memory);
        if let Some(joints) = joints {
            joints.commit(&mut found.resistance);
        }
    }

    /// Goes on from what other joints remembered.
    pub(crate) fn remember(&mut self, memory: Self) -> Result<(), MemoryError> {
        memory.pins.check(self.pins.len())?;
        memory.bushes.check(self.bushes.len())?;
        *self = memory;
        Ok(())
    }
}
