//! The slots of a body, lane by lane: what was at the last accepted state, and what is found now.

use pulp::Simd;

use super::memory::FAR;
use super::memory::MemoryLanes;
use super::slot_differences::SlotDifferenceLanes;
use super::{Contacts, Touch};
use crate::lanes::{Lane, Lanes, LanesMut, Wide};

/// All that the kernel reads and writes of slots. Lanes of the second side stand after those of the first.
pub(super) struct Slots<'a, S: Simd> {
    pub(super) memory: MemoryLanes<'a, S>,
    /// Where rigid links roll.
    pub(super) faces: Option<FacesNow<'a, S>>,
    axis: [Lanes<'a, S>; 2],
    /// Differences between slots, if there are any.
    pub(super) uneven: Option<SlotDifferenceLanes<'a, S>>,
    wake: &'a [f64],
    until: &'a mut [f64],
    lanes: usize,
}

/// Stiffness, damping and faces that implicit steps read.
pub(super) struct FacesNow<'a, S: Simd> {
    pub(super) normal_x: LanesMut<'a, S>,
    pub(super) normal_y: LanesMut<'a, S>,
    pub(super) bend: LanesMut<'a, S>,
    pub(super) stiffness: LanesMut<'a, S>,
    pub(super) damping: LanesMut<'a, S>,
    pub(super) rub: LanesMut<'a, S>,
    pub(super) drag: LanesMut<'a, S>,
    pub(super) secant: LanesMut<'a, S>,
}

impl<'a, S: Simd> Slots<'a, S> {
    #[inline(always)]
    pub(super) fn new(w: Wide<S>, contacts: &'a Contacts, touch: &'a mut Touch) -> Self {
        let (slots, sides) = (contacts.slots, contacts.sides());
        let n = slots * sides;
        let faces = if contacts.writes_faces {
            touch.faces.resize(n);
            let faces = &mut touch.faces;
            Some(FacesNow {
                normal_x: Wide::lanes_mut(&mut faces.normal_x),
                normal_y: Wide::lanes_mut(&mut faces.normal_y),
                bend: Wide::lanes_mut(&mut faces.bend),
                stiffness: Wide::lanes_mut(&mut faces.stiffness),
                damping: Wide::lanes_mut(&mut faces.damping),
                rub: Wide::lanes_mut(&mut faces.rub),
                drag: Wide::lanes_mut(&mut faces.drag),
                secant: Wide::lanes_mut(&mut faces.secant),
            })
        } else {
            None
        };
        let before = &contacts.memory;
        Self {
            faces,
            memory: MemoryLanes::new(w, &before.state, &mut touch.state, n),
            axis: [&contacts.axis_x, &contacts.axis_y].map(|axis| w.lanes(&axis[..slots])),
            uneven: contacts.uneven.as_ref().map(|it| it.lanes(w, slots)),
            wake: &before.wake[..n],
            until: &mut touch.wake[..n],
            lanes: slots / Wide::<S>::COUNT,
        }
    }

    /// Number of lanes of one side.
    #[inline(always)]
    pub(super) fn lanes(&self) -> usize {
        self.lanes
    }

    /// Gap axes in the wheel's frame; one for all sides.
    #[inline(always)]
    pub(super) fn axis(&self, lane: usize) -> [Lane<S>; 2] {
        [self.axis[0].get(lane), self.axis[1].get(lane)]
    }

    /// Until when \[s\] nothing can touch in a lane, as found at the last accepted step.
    #[inline(always)]
    pub(super) fn wake(&self, lane: usize) -> f64 {
        self.wake[lane * Wide::<S>::COUNT]
    }

    #[inline(always)]
    pub(super) fn set_wake(&mut self, lane: usize, until: f64) {
        self.until[lane * Wide::<S>::COUNT] = until;
    }

    /// A lane without contacts, at rest until some time \[s\].
    #[inline(always)]
    pub(super) fn leave_open(&mut self, w: Wide<S>, lane: usize, until: f64) {
        self.memory.look(lane, w.splat(FAR), w.splat(0.0));
        self.memory.open(w, lane);
        self.set_wake(lane, until);
    }
}
