//! Integration tests in one binary: linking dozens of them takes longer than running them.

mod energy_drift;
mod first_contact;
mod guards;
mod implicit;
mod instruction_sets;
mod memory;
mod order;
mod predicted;
mod problems;
mod states;
mod validation_bounce;
