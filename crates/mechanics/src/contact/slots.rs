//! The slots of a body, lane by lane: what was at the last accepted state, and what is found now.

use pulp::Simd;

use super::window::FAR;
use super::{Contacts, Touch};
use crate::lanes::{Lane, Lanes, LanesMut, Wide};

/// All that the kernel reads and writes of slots. Lanes of the second side stand behind those of the first.
pub(super) struct Slots<'a, S: Simd> {
    pub(super) before: Before<'a, S>,
    pub(super) now: Now<'a, S>,
    /// Where rigid links roll.
    pub(super) faces: Option<FacesNow<'a, S>>,
    axis: [Lanes<'a, S>; 2],
    wake: &'a [f64],
    until: &'a mut [f64],
    stick: (&'a [f64], &'a mut [f64]),
    lanes: usize,
}

/// State at the last accepted step.
pub(super) struct Before<'a, S: Simd> {
    pub(super) inverse_onset: Lanes<'a, S>,
    pub(super) gap: Lanes<'a, S>,
    pub(super) closing: Lanes<'a, S>,
}

/// State here.
pub(super) struct Now<'a, S: Simd> {
    pub(super) inverse_onset: LanesMut<'a, S>,
    pub(super) gap: LanesMut<'a, S>,
    pub(super) closing: LanesMut<'a, S>,
    pub(super) force: LanesMut<'a, S>,
    pub(super) share: LanesMut<'a, S>,
}

/// What implicit steps want to know.
pub(super) struct FacesNow<'a, S: Simd> {
    pub(super) normal_x: LanesMut<'a, S>,
    pub(super) normal_y: LanesMut<'a, S>,
    pub(super) bend: LanesMut<'a, S>,
    pub(super) stiffness: LanesMut<'a, S>,
    pub(super) damping: LanesMut<'a, S>,
}

impl<'a, S: Simd> Slots<'a, S> {
    #[inline(always)]
    pub(super) fn new(w: Wide<S>, contacts: &'a Contacts, touch: &'a mut Touch) -> Self {
        let (slots, sides) = (contacts.slots, contacts.sides());
        let n = slots * sides;
        let memory = &contacts.memory;
        let faces = if contacts.for_links {
            touch.faces.resize(n);
            let faces = &mut touch.faces;
            Some(FacesNow {
                normal_x: Wide::lanes_mut(&mut faces.normal_x),
                normal_y: Wide::lanes_mut(&mut faces.normal_y),
                bend: Wide::lanes_mut(&mut faces.bend),
                stiffness: Wide::lanes_mut(&mut faces.stiffness),
                damping: Wide::lanes_mut(&mut faces.damping),
            })
        } else {
            None
        };
        Self {
            faces,
            before: Before {
                inverse_onset: w.lanes(&memory.inverse_onset[..n]),
                gap: w.lanes(&memory.gap[..n]),
                closing: w.lanes(&memory.closing[..n]),
            },
            now: Now {
                inverse_onset: Wide::<S>::lanes_mut(&mut touch.inverse_onset[..n]),
                gap: Wide::<S>::lanes_mut(&mut touch.gap[..n]),
                closing: Wide::<S>::lanes_mut(&mut touch.closing[..n]),
                force: Wide::<S>::lanes_mut(&mut touch.force[..n]),
                share: Wide::<S>::lanes_mut(&mut touch.share[..n]),
            },
            axis: [&contacts.axis_x, &contacts.axis_y].map(|axis| w.lanes(&axis[..slots])),
            wake: &memory.wake[..n],
            until: &mut touch.wake[..n],
            stick: (&memory.stick[..n], &mut touch.stick[..n]),
            lanes: slots / Wide::<S>::COUNT,
        }
    }

    /// Number of lanes of one side.
    #[inline(always)]
    pub(super) fn lanes(&self) -> usize {
        self.lanes
    }

    /// Gap axes in the wheel's frame; one for both sides.
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

    /// State of a friction law that has one, before and now.
    #[inline(always)]
    pub(super) fn stick(&mut self, lane: usize) -> (&[f64], &mut [f64]) {
        let slots = lane * Wide::<S>::COUNT..(lane + 1) * Wide::<S>::COUNT;
        (&self.stick.0[slots.clone()], &mut self.stick.1[slots])
    }

    /// A lane without contacts, at rest until some time \[s\].
    #[inline(always)]
    pub(super) fn leave_open(&mut self, w: Wide<S>, lane: usize, until: f64) {
        let zero = w.splat(0.0);
        self.now.gap.set(lane, w.splat(FAR));
        self.now.closing.set(lane, zero);
        self.now.inverse_onset.set(lane, zero);
        self.now.force.set(lane, zero);
        self.set_wake(lane, until);
    }
}
