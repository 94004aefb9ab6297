//! Joints between the links of a chain, whatever the links are: pins and rollers with play, closed contacts, resistance.

mod clearance;
mod element;
mod memory;
mod mount;
mod pin;
mod pins;
mod resistance;
mod side;
#[cfg(test)]
mod validation_slider_crank;

pub use clearance::{Clearance, FreeRoller};
pub(crate) use element::{Element, Partner, Row, cross, partner_row, turned};
pub(crate) use memory::{JointFindings, JointMemory};
pub(crate) use mount::{Mount, rail_mount, wheel_mount};
pub(crate) use pin::{add_joint, touch};
pub(crate) use pins::{Pairs, Pins, contacts};
pub(crate) use resistance::{JointLosses, Joints, Resistance, Stick, Turns, remember};
pub(crate) use side::{JointMates, Mate, Part, Sides, Tip};
