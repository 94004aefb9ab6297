//! The C interface of functional mock-up units of chain drives: FMI 2.0 and 3.0, co-simulation.
//!
//! Importers get no pointers into this library: instances and states are numbers that look like pointers, and every call looks its number
//! up. A call with a number that nobody has given out, a null pointer, more values than a unit has, or at the wrong time returns an error and
//! says why, and so does one that panics: no panic crosses the interface.
//!
//! What C alone knows, how long an array is and whether a text ends, nobody can check: lengths are bounded by what a unit has.

pub mod fmi2;
pub mod fmi3;

mod calls;
mod logger;
#[cfg(test)]
mod misuse;
mod pointers;
mod states;
mod units;
mod versions;

/// Blocks that begin where a cache line does, as in the other forms of the program.
#[cfg(not(test))]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;
