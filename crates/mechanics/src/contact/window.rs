//! Rollers that can touch a body before the windows are renewed.

use std::mem::swap;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Array;
use serde::{Deserialize, Serialize};

use super::memory::FAR;
use super::{ContactState, Contacts, Frame, MemoryField, Shape, Teeth, Touch};
use crate::lanes::LANES;

/// A run of consecutive rollers, no more than one lane of eight holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// First roller.
    pub(crate) start: usize,
    /// Number of rollers.
    pub(crate) count: usize,
}

/// Windows as they were before the last ones: their space is that of the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spare {
    runs: Vec<Run>,
    axis_x: Array,
    axis_y: Array,
    memory: Touch,
}

/// Positions of the rollers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    /// Number of rollers, ghosts not counted.
    pub(crate) count: usize,
}

/// Share of the roller radius below which a gap may close before the windows are renewed.
const LIKELY: f64 = 0.1;

impl Contacts {
    /// Looks for the rollers within `margin` \[m\] of touching, and carries the memory over.
    pub(crate) fn renew(&mut self, frame: &Frame, places: Places<'_>, margin: f64) {
        // In the space of the windows before the last, so that nothing is allocated.
        let mut next = self.spare.take().unwrap_or_default();
        next.runs.clear();
        for run in self.near_runs(frame, places, margin) {
            next.runs.extend(self.cut(run));
        }
        let slots = next.runs.len() * LANES;
        let sides = self.sides();
        next.memory.open(slots * sides);
        for (axis, value) in [(&mut next.axis_x, 1.0), (&mut next.axis_y, 0.0)] {
            axis.clear();
            axis.resize(slots, value);
        }
        for_each_slot(&next.runs, |slot, roller| {
            let old = self.slot_of(roller);
            let axis = old.map(|old| [self.axis_x[old], self.axis_y[old]]);
            // By how many stretches the gap of the roller has moved on.
            let mut over = 0;
            if let Shape::Teeth(teeth) = &self.shape {
                let d = Point::new(places.x[roller], places.y[roller]) - frame.centre();
                let here = teeth.gap_axis(frame.turn, d, axis);
                over = axis.map_or(0, |axis| sides_over(axis, here, sides));
                [next.axis_x[slot], next.axis_y[slot]] = here;
            }
            let Some(old) = old else { return };
            for side in 0..sides {
                let from = (side + over) % sides * self.slots + old;
                let to = side * slots + slot;
                next.memory.state.carry(to, &self.memory.state, from);
            }
        });
        self.slots = slots;
        swap(&mut self.runs, &mut next.runs);
        self.candidates = self.runs.iter().map(|run| run.count).sum();
        swap(&mut *self.memory, &mut next.memory);
        swap(&mut self.axis_x, &mut next.axis_x);
        swap(&mut self.axis_y, &mut next.axis_y);
        self.spare = Some(next);
        self.renew_uneven();
    }

    /// Rollers that are near, in their order.
    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Least distance \[m\] of a roller at a place from touching; nothing or less where it may touch.
    pub(crate) fn room(&self, frame: &Frame, place: Point) -> f64 {
        let d = place - frame.centre();
        match &self.shape {
            Shape::Teeth(teeth) => d.norm() - teeth.tip_radius - self.largest,
            Shape::Rail {
                reference, bounds, ..
            } => {
                let [c, s] = frame.turn;
                let local = [
                    c * d.x + s * d.y + reference.x,
                    c * d.y - s * d.x + reference.y,
                ];
                let outside = |axis: usize| {
                    f64::max(bounds[0][axis] - local[axis], local[axis] - bounds[1][axis])
                };
                outside(0).max(outside(1)) - self.largest
            }
        }
    }

    /// Rollers that are near, and follow each other.
    fn near_runs<'a>(
        &'a self,
        frame: &'a Frame,
        places: Places<'a>,
        margin: f64,
    ) -> impl Iterator<Item = Run> + 'a {
        let near = move |roller: usize| {
            let place = Point::new(places.x[roller], places.y[roller]);
            self.room(frame, place) < margin
        };
        let mut rest = 0..places.count;
        std::iter::from_fn(move || {
            let start = rest.find(|&roller| near(roller))?;
            let end = rest.find(|&roller| !near(roller));
            let count = end.unwrap_or(places.count) - start;
            Some(Run { start, count })
        })
    }

    /// Cuts a run into lanes of eight rollers. The first takes fewer, where those likely to touch then need fewer lanes:
    /// lanes of rollers that come and go rest.
    fn cut(&self, run: Run) -> impl Iterator<Item = Run> {
        let likely = |k: &usize| {
            let slot = self.slot_of(run.start + k);
            slot.is_some_and(|slot| {
                let state = &self.memory.state;
                let gap = |side| state.get(MemoryField::Gap, side * self.slots + slot);
                let gaps = (0..self.sides()).map(gap);
                gaps.fold(FAR, f64::min) < LIKELY * self.radius
            })
        };
        let first = (0..run.count).find(likely);
        let last = (0..run.count).rfind(likely);
        let few = first.zip(last).map_or(0, |(first, last)| {
            let lanes = |few: &usize| (last - few) / LANES - (first - few) / LANES;
            (0..=first.min(LANES - 1)).min_by_key(lanes).unwrap_or(0)
        });
        let part = move |(start, end): (usize, usize)| Run {
            start: run.start + start,
            count: end - start,
        };
        let starts = (few..run.count).step_by(LANES);
        let whole = starts.map(move |start| (start, run.count.min(start + LANES)));
        let first = (few > 0).then_some((0, few));
        first.into_iter().chain(whole).map(part)
    }

    /// The slot that holds `roller`, if any.
    pub(crate) fn slot_of(&self, roller: usize) -> Option<usize> {
        let holds = |run: &Run| (run.start..run.start + run.count).contains(&roller);
        let lane = self.runs.iter().position(holds)?;
        Some(lane * LANES + roller - self.runs[lane].start)
    }

    /// Calls `visit` with (slot, roller) for every slot in use.
    pub(crate) fn for_each_slot(&self, visit: impl FnMut(usize, usize)) {
        for_each_slot(&self.runs, visit);
    }

    /// Calls `visit` with every roller near this body, and how it stands to it.
    ///
    /// A roller is open long before it ceases to be near.
    pub(crate) fn each_candidate(&self, mut visit: impl FnMut(usize, ContactState)) {
        self.for_each_slot(|slot, roller| visit(roller, self.both_sides(&self.memory.state, slot)));
    }
}

pub(super) fn for_each_slot(runs: &[Run], mut visit: impl FnMut(usize, usize)) {
    for (lane, run) in runs.iter().enumerate() {
        for k in 0..run.count {
            visit(lane * LANES + k, run.start + k);
        }
    }
}

/// The side of the gap at one axis that keeps the first stretch of the gap at another: see `contact/faced_surface.rs`.
fn sides_over(from: [f64; 2], to: [f64; 2], sides: usize) -> usize {
    let across = to[0] * from[1] - to[1] * from[0];
    if across.abs() < 1e-9 {
        0
    } else if across > 0.0 {
        1 % sides
    } else {
        sides - 1
    }
}

impl Teeth {
    /// Axis, in the wheel frame, of the gap nearest to the roller at `d` from the centre of the teeth.
    pub(super) fn gap_axis(&self, turn: [f64; 2], d: Vector, start: Option<[f64; 2]>) -> [f64; 2] {
        let [c, s] = turn;
        let w = [c * d.x + s * d.y, c * d.y - s * d.x];
        if let Some(e) = start {
            let (x, y) = (w[0] * e[1] - w[1] * e[0], w[0] * e[0] + w[1] * e[1]);
            if x.abs() <= y * self.tan_half {
                return e;
            }
        }
        self.axis(self.gap_at(w))
    }
}

/// The frame of a body that neither moves nor turns.
impl Frame {
    pub(crate) fn fixed() -> Self {
        Self {
            origin: Point::origin(),
            eccentric: Vector::zeros(),
            turn: [1.0, 0.0],
            velocity: Vector::zeros(),
            spin: 0.0,
        }
    }

    /// Centre of the teeth \[m\].
    #[inline(always)]
    pub(crate) fn centre(&self) -> Point {
        self.origin + self.eccentric
    }

    /// The same body, seen from the centre of its teeth.
    #[inline(always)]
    pub(super) fn at_centre(&self) -> Self {
        let e = self.eccentric;
        Self {
            origin: self.centre(),
            eccentric: Vector::zeros(),
            // v_c = v + ω ẑ × e
            velocity: self.velocity + Vector::new(-e.y, e.x) * self.spin,
            ..*self
        }
    }

    /// Position in the frame's coordinates, relative to `reference`.
    pub(crate) fn local(&self, at: Point, reference: Point) -> Point {
        let d = at - self.origin;
        let [c, s] = self.turn;
        Point::new(
            c * d.x + s * d.y + reference.x,
            c * d.y - s * d.x + reference.y,
        )
    }

    /// Direction in the world of a direction in the frame.
    pub(crate) fn outward(&self, v: Vector) -> Vector {
        let [c, s] = self.turn;
        Vector::new(c * v.x - s * v.y, s * v.x + c * v.y)
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::dissipation::Dissipation;
    use chaindrive_contact::elastic::Power;
    use chaindrive_contact::{Elastic, Friction, Law};
    use chaindrive_geometry::{Piece, Segment};

    use super::*;
    use crate::profile::RailFace;
    use crate::surface::Surface;

    /// Runs hold every roller once, in lanes of eight, and those that are likely to touch in as few lanes as can be.
    #[test]
    fn runs_are_cut_where_few_lanes_touch() {
        let ends = [[1.0, 0.0], [0.0, 0.0]].map(|[x, y]| Point::new(x, y));
        let face = [Piece::Segment(Segment::new(ends[0], ends[1]))];
        let shape = Shape::Rail {
            face: RailFace::new(&face),
            reference: Point::origin(),
            bounds: [ends[1], ends[0]],
        };
        let surface = Surface {
            law: Law {
                series: None,
                elastic: Elastic::Power(Power::linear(1e6)),
                dissipation: Dissipation::None,
                onset_floor: 0.01,
            },
            friction: Friction::None,
            film: None,
        };
        let mut contacts = Contacts::new(shape, surface, None, 0.01);
        let whole = Run {
            start: 36,
            count: 27,
        };
        contacts.runs = contacts.cut(whole).collect();
        assert_eq!(contacts.runs.len(), 4);
        contacts.slots = 4 * LANES;
        for first in 0..whole.count {
            for last in first..whole.count {
                contacts.memory.open(contacts.slots);
                for slot in first..=last {
                    contacts.memory.state.set(MemoryField::Gap, slot, -1e-6);
                }
                let cut: Vec<Run> = contacts.cut(whole).collect();
                let rollers = cut.iter().flat_map(|run| run.start..run.start + run.count);
                assert!(rollers.eq(36..36 + 27), "{cut:?}");
                assert!(cut.iter().all(|run| (1..=LANES).contains(&run.count)));
                let likely = 36 + first..=36 + last;
                let touched = cut.iter().filter(|run| {
                    (run.start..run.start + run.count).any(|roller| likely.contains(&roller))
                });
                let least = (last - first + 1).div_ceil(LANES);
                assert_eq!(touched.count(), least, "{first} to {last}: {cut:?}");
            }
        }
    }
}
