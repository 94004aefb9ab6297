//! Rollers and links in a row: what every chain has, whatever it is made of.

use chaindrive_geometry::Point;
use chaindrive_integrate::Registers;

use super::chain::Chain;
use super::strand_ends::{HeldEnd, held_ends};
use crate::joints::{JointMemory, Joints};
use crate::{End, Motion};

/// The row of links, its ends, and its joints.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) rollers: usize,
    pub(crate) links: usize,
    /// Length of the roller arrays, copies of the first rollers after the last included.
    pub(crate) stride: usize,
    /// Nominal pitch \[m\].
    pub(crate) pitch: f64,
    /// None: the chain is closed.
    pub(crate) ends: Vec<HeldEnd>,
    /// Resistance in the joints beside the contacts of pins and bushes, if there is any.
    pub(crate) joints: Option<Joints>,
    /// Contacts in the joints at the last accepted state.
    pub(crate) memory: JointMemory,
    pub(crate) registers: Registers,
}

impl Series {
    /// The row of a chain whose rollers were laid at `places`; its joints have entries for so many, and no contacts yet.
    pub(crate) fn laid(chain: &Chain, places: &[Point], [stride, entries]: [usize; 2]) -> Self {
        Self {
            rollers: chain.rollers(),
            links: chain.links(),
            stride,
            pitch: chain.pitch,
            ends: held_ends(chain, places),
            joints: joints(chain, entries),
            memory: JointMemory::default(),
            registers: Registers::in_use(),
        }
    }

    /// The same row with contacts in its joints, at rest since `time`.
    pub(crate) fn with_contacts(&self, chain: &Chain, entries: usize, memory: JointMemory) -> Self {
        Self {
            joints: joints(chain, entries),
            memory,
            ..self.clone()
        }
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.ends.is_empty()
    }

    /// Whether something pulls at an end.
    pub(crate) fn is_pulled(&self) -> bool {
        let mut ends = self.ends.iter();
        ends.any(|held| matches!(held.end, End::Pulled { .. }))
    }

    /// Time \[s\] of the first knot of an end's motion after t; none without one.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        let knots = self.ends.iter().filter_map(|held| match &held.end {
            End::Driven { x, y } => x
                .next_knot(t)
                .into_iter()
                .chain(y.next_knot(t))
                .reduce(f64::min),
            End::Free | End::Fixed | End::Pulled { .. } => None,
        });
        knots.reduce(f64::min)
    }

    /// Lets driven ends stand still.
    pub(crate) fn hold_still(&mut self) {
        for held in &mut self.ends {
            if let End::Driven { x, y } = &mut held.end {
                (*x, *y) = (Motion::Held, Motion::Held);
            }
        }
    }

    /// Says when the memory of joints and free rollers is of.
    pub(crate) fn set_clock(&mut self, t: f64) {
        self.memory.time = t;
        if let Some(joints) = &mut self.joints {
            joints.set_clock(t);
        }
    }
}

fn joints(chain: &Chain, entries: usize) -> Option<Joints> {
    let row = (chain.links(), chain.is_closed());
    Joints::new(chain.articulation, row, entries)
}
