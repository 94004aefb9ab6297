//! Contact of the rollers with one body: windows, memory and the kernel over them.
//!
//! Only rollers near the body are looked at: contiguous runs of them, padded to whole lanes and
//! renewed every few dozen steps, with a margin that no roller can cross meanwhile. For each
//! such slot the contact remembers, since the last accepted state, the gap, the closing speed
//! and, while closed, the inverse of the speed at touch.

mod arrivals;
mod bore;
mod bristles;
mod faced_surface;
mod film;
mod friction;
mod impacts;
mod journal;
mod kernel;
mod law;
mod logarithm;
mod memory;
mod plates;
mod power_on_spring;
mod predicted;
mod resting_lanes;
mod rollers;
mod rubbing;
mod slot_differences;
mod slots;
mod stick_slip;
#[cfg(test)]
mod tests;
mod window;
mod windows;
mod wrench;

use chaindrive_contact::Law;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Array;
use serde::{Deserialize, Serialize};

pub(crate) use arrivals::Arrivals;
pub use arrivals::Impact;
pub(crate) use bore::{BoreContact, CENTRED, Grip, RelativeMotion, Tally};
pub(crate) use bristles::{Sweep, swept};
pub(crate) use friction::LaneFriction;
pub use impacts::Impacts;
pub(crate) use law::SurfaceLaw;
pub(crate) use memory::{
    ContactMemory, ContactState, FAR, MemoryField, MemoryLanes, share_to_zero,
};
pub(crate) use plates::{OfPins, PinAccelerations, PlateContact, PlatePins, pressing};
pub(crate) use rollers::Rollers;
pub(crate) use stick_slip::Holding;
pub(crate) use window::{Places, Run, Spare};
pub(crate) use windows::{PlateMemory, Windows};
pub(crate) use wrench::{LaneTally, Onsets, Wrench};

use slot_differences::SlotDifferences;

use crate::lanes::LANES;
use crate::profile::{GapFace, RailFace};
use crate::surface::{Flank, Surface};

/// A depth \[m\] that no power is taken below; the force there is nothing beside rounding.
const LEAST_DEPTH: f64 = 1e-30;

/// The position and motion of the frame in which a profile is given.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Frame {
    /// Origin: axis of a wheel, pivot of an arm, or displaced origin of a rail \[m\].
    pub(crate) origin: Point,
    /// Centre of the teeth, from there: that of a wheel that runs out lies beside its axis \[m\].
    pub(crate) eccentric: Vector,
    /// Cosine and sine of the rotation.
    pub(crate) turn: [f64; 2],
    /// Velocity of the origin \[m/s\].
    pub(crate) velocity: Vector,
    /// Angular speed \[rad/s\].
    pub(crate) spin: f64,
}

/// Shape of the profile.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// z gaps around a wheel.
    Teeth(Teeth),
    /// The face of a guide, given about the frame's reference origin.
    Rail {
        face: RailFace,
        /// Origin of the frame in the coordinates of the face.
        reference: Point,
        /// Box around the face in its own coordinates (low, high).
        bounds: [Point; 2],
    },
}

/// The teeth of a wheel.
#[derive(Clone, Debug)]
pub(crate) struct Teeth {
    pub(crate) face: GapFace,
    pub(crate) count: u32,
    /// tan(π/z): where the next gap begins.
    pub(crate) tan_half: f64,
    /// cos and sin of 2π/z.
    pub(crate) pitch_turn: [f64; 2],
    /// Tip radius \[m\].
    pub(crate) tip_radius: f64,
    /// Angles by which the gaps stand from their places \[rad\], counter-clockwise; none where all are in place.
    pub(crate) errors: Vec<f64>,
}

/// All contacts of the chain's rollers with one body.
#[derive(Clone, Debug)]
pub(crate) struct Contacts {
    pub(crate) shape: Shape,
    pub(crate) surface: Surface,
    /// Differences on the flanks.
    pub(crate) flank: Option<Flank>,
    /// The two, ready for lanes.
    law: SurfaceLaw,
    /// Radius of the touching circles \[m\].
    pub(crate) radius: f64,
    /// The same with the film of oil around them \[m\].
    touching: f64,
    /// The same of the largest of them \[m\].
    largest: f64,
    /// Differences between them, and between gaps.
    uneven: Option<Box<SlotDifferences>>,
    /// Runs of rollers that can touch.
    pub(crate) runs: Vec<Run>,
    /// Number of rollers in them.
    pub(crate) candidates: usize,
    /// Number of slots, whole lanes.
    pub(crate) slots: usize,
    /// Gap axis of each slot in the wheel frame (teeth only).
    pub(crate) axis_x: Array,
    pub(crate) axis_y: Array,
    /// State of each slot at the last accepted step, for every side.
    pub(crate) memory: Box<Touch>,
    /// When that was \[s\].
    pub(crate) accepted: f64,
    /// Whether the chain reads the faces that its circles press on: rigid links for implicit steps, strands for the friction that turns
    /// their bushes. No lane rests then, because a link that is struck at its other end moves at once.
    pub(crate) writes_faces: bool,
    spare: Option<Box<Spare>>,
}

/// The lane does not rest: it is looked at at any time, times before 0 included.
const AWAKE: f64 = f64::NEG_INFINITY;

/// Contact state per slot; where a gap has several stretches, each is a side, and the slots of one stand after those of the
/// other.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Touch {
    pub(crate) state: ContactMemory,
    /// Until when \[s\] nothing can touch in the lane that begins with this slot.
    pub(crate) wake: Vec<f64>,
    /// Faces with stiffness, damping and friction; kept for chains that read them only, and valid where a contact is closed.
    pub(crate) faces: Faces,
}

/// The surfaces that closed contacts press on, per slot.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Faces {
    /// Outward normal of the surface.
    pub(crate) normal_x: Array,
    pub(crate) normal_y: Array,
    /// Curvature of the level line of the gap through the roller centre \[1/m\], positive around a bulge.
    pub(crate) bend: Array,
    /// ∂F/∂δ \[N/m\] and ∂F/∂δ̇ \[N s/m\].
    pub(crate) stiffness: Array,
    pub(crate) damping: Array,
    /// Friction \[N\], its slope and its secant \[N s/m\]; kept where there is friction.
    pub(crate) rub: Array,
    pub(crate) drag: Array,
    pub(crate) secant: Array,
}

impl Faces {
    #[inline]
    pub(crate) fn resize(&mut self, slots: usize) {
        if self.bend.len() == slots {
            return;
        }
        for values in [
            &mut self.normal_x,
            &mut self.normal_y,
            &mut self.bend,
            &mut self.stiffness,
            &mut self.damping,
            &mut self.rub,
            &mut self.drag,
            &mut self.secant,
        ] {
            values.resize(slots, 0.0);
        }
    }
}

impl Touch {
    /// As many slots, none of them in contact.
    pub(crate) fn open(&mut self, slots: usize) {
        self.state.reopen(slots);
        self.wake.clear();
        self.wake.resize(slots, AWAKE);
    }

    #[inline]
    pub(crate) fn resize(&mut self, slots: usize) {
        if self.wake.len() == slots {
            return;
        }
        self.state.resize(slots);
        self.wake.resize(slots, AWAKE);
    }
}

impl Contacts {
    pub(crate) fn new(shape: Shape, surface: Surface, flank: Option<Flank>, radius: f64) -> Self {
        let law = SurfaceLaw::new(&surface, flank);
        let touching = radius + law.film_thickness();
        Self {
            shape,
            surface,
            flank,
            law,
            radius,
            touching,
            largest: touching,
            uneven: None,
            runs: Vec::new(),
            candidates: 0,
            slots: 0,
            axis_x: Array::default(),
            axis_y: Array::default(),
            memory: Box::default(),
            accepted: 0.0,
            writes_faces: false,
            spare: None,
        }
    }

    /// Number of sides that a slot looks at: stretches with a contact each.
    #[inline]
    pub(crate) fn sides(&self) -> usize {
        match &self.shape {
            Shape::Teeth(teeth) => teeth.face.stretches.len(),
            Shape::Rail { .. } => 1,
        }
    }

    /// Oil above the roughness \[m\] in a contact that presses, if there is any between the surfaces.
    pub(crate) fn film(&self, state: &ContactMemory, slot: usize) -> Option<f64> {
        let film = self.surface.film?;
        Some(film.thickness - state.get(MemoryField::Squeezed, slot))
    }

    /// Sum of the elastic energies of all closed slots \[J\].
    pub(crate) fn stored(&self, touch: &Touch) -> f64 {
        let law = &self.surface.law;
        let of_flank = self.flank.as_ref().map(|flank| flank.law(&self.surface));
        let state = &touch.state;
        let contacts = state
            .each(MemoryField::Gap)
            .zip(state.each(MemoryField::Share));
        let mut closed = contacts.filter(|(gap, _)| *gap < 0.0);
        let batches = std::iter::from_fn(|| {
            // A contact is open to a law that has no part in it, and so are those that eight lack.
            let [mut in_seat, mut on_flank, mut shares] = [[0.0; LANES]; 3];
            let mut count = 0;
            for (gap, share) in closed.by_ref().take(LANES) {
                if of_flank.is_none() || share < 1.0 {
                    in_seat[count] = -gap;
                }
                if share > 0.0 {
                    on_flank[count] = -gap;
                }
                shares[count] = share;
                count += 1;
            }
            let mut stored = law.energies(in_seat);
            if let Some(of_flank) = &of_flank {
                let on_flank = of_flank.energies(on_flank);
                for ((stored, share), on_flank) in stored.iter_mut().zip(shares).zip(on_flank) {
                    *stored = (1.0 - share) * *stored + share * on_flank;
                }
            }
            (count > 0).then(|| stored.into_iter().take(count))
        });
        batches.flatten().sum()
    }

    /// Adds the normal forces \[N\] of a state to those on the rollers of the chain.
    pub(crate) fn add_forces(&self, state: &ContactMemory, to: &mut [f64]) {
        for (block, run) in self.runs.iter().enumerate() {
            let own = &mut to[run.start..][..run.count];
            for side in 0..self.sides() {
                let row = state.row(MemoryField::Force, side * self.runs.len() + block);
                for (sum, force) in own.iter_mut().zip(row) {
                    *sum += force;
                }
            }
        }
    }
}

impl Flank {
    /// The law on the flank of a surface.
    pub(crate) fn law(&self, surface: &Surface) -> Law {
        Law {
            elastic: self.elastic,
            ..surface.law
        }
    }

    /// Share s of the flank's law at a distance beyond the end of the hollow \[m\].
    #[inline]
    pub(crate) fn share(&self, beyond: f64) -> f64 {
        // s = x² (3 − 2x),   x = (ξ + w)/(2w)
        let x = (0.5 * (beyond / self.width + 1.0)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

/// A depth at which laws that start softly have some stiffness \[m\].
const SHALLOW: f64 = 1e-7;

impl Surface {
    /// Least speed at touch \[m/s\]; without hysteresis it is only kept, never used.
    pub(crate) fn floor(&self) -> f64 {
        self.law.onset_floor.max(f64::MIN_POSITIVE.sqrt())
    }

    /// Tangent stiffness of a contact of some depth \[N/m\], for the choice of the step.
    pub(crate) fn stiffness(&self, depth: f64) -> f64 {
        self.law.stiffness(depth.max(SHALLOW))
    }
}
