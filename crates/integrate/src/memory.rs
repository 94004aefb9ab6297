//! Memory of a stepper beside the state: with both, a run goes on to the last bit.

use serde::{Deserialize, Serialize};

use crate::stepper::Pace;
use crate::{IntegrationError, Method, SecondOrderSystem, State, Statistics, Stepper};

/// Memory of a [`Stepper`] from one step to the next, with records of type `R`.
///
/// Plain data, for snapshots in memory and on disk. What follows from the method and the size of the system is not in it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StepperMemory<R> {
    method: Method,
    pace: Pace,
    /// Accelerations and rates that the method carries from step to step.
    carried: Vec<f64>,
    statistics: Statistics,
    /// Time of the next event \[s\].
    event: f64,
    /// The record of the accepted state, where the next step begins with it.
    record: Option<R>,
}

impl<R> StepperMemory<R> {
    /// The record of the accepted state, for methods whose next step begins with it.
    pub fn record(&self) -> Option<&R> {
        self.record.as_ref()
    }
}

impl<S: SecondOrderSystem<Record: Clone>> Stepper<S> {
    /// Its memory.
    pub fn memory(&self) -> StepperMemory<S::Record> {
        StepperMemory {
            method: self.method(),
            pace: self.pace,
            carried: self.kernel.carried().to_vec(),
            statistics: self.statistics,
            event: self.event,
            record: self.kernel.needs_record().then(|| self.record.clone()),
        }
    }

    /// Goes on from what a stepper of the same method and system remembered in a state.
    ///
    /// # Errors
    /// [`IntegrationError::OtherMethod`], [`IntegrationError::Shape`]; nothing is changed then.
    pub fn remember(
        &mut self,
        system: &S,
        state: &State,
        memory: StepperMemory<S::Record>,
    ) -> Result<(), IntegrationError> {
        if memory.method != self.method() {
            return Err(IntegrationError::OtherMethod {
                expected: self.method().name(),
                found: memory.method.name(),
            });
        }
        state.check(system)?;
        let (found, expected) = (memory.carried.len(), self.kernel.carried().len());
        if found != expected {
            let what = "accelerations";
            return Err(IntegrationError::Shape {
                what,
                found,
                expected,
            });
        }
        self.kernel.carry_on(&memory.carried);
        self.pace = memory.pace;
        self.statistics = memory.statistics;
        self.event = memory.event;
        if let Some(record) = memory.record {
            self.record = record;
        }
        Ok(())
    }
}
