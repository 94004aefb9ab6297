//! Differences between rollers, and between tooth gaps.

use chaindrive_integrate::Array;
use pulp::Simd;

use super::window::for_each_slot;
use super::{Contacts, Run, Shape, Teeth};
use crate::lanes::{LANES, Lane, Lanes, Wide};

/// Differences between rollers, and between gaps.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlotDifferences {
    /// By how much the radius of every roller exceeds that of the contacts \[m\]; none where all are alike.
    rollers: Vec<f64>,
    /// The same for each slot.
    larger: Array,
    /// cos and sin of the turn from the gap of each slot to the gap on its right, then to that on its left.
    turns: [Array; 4],
}

/// The same, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct SlotDifferenceLanes<'a, S: Simd> {
    larger: Lanes<'a, S>,
    turns: [Lanes<'a, S>; 4],
}

impl<S: Simd> SlotDifferenceLanes<'_, S> {
    /// By how much the rollers of a lane exceed the radius of the contacts \[m\].
    #[inline(always)]
    pub(super) fn larger(&self, lane: usize) -> Lane<S> {
        self.larger.get(lane)
    }

    /// cos and sin of the turns to the gaps on the right and on the left.
    #[inline(always)]
    pub(super) fn turns(&self, lane: usize) -> [Lane<S>; 4] {
        let [a, b, c, d] = &self.turns;
        [a.get(lane), b.get(lane), c.get(lane), d.get(lane)]
    }
}

impl SlotDifferences {
    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, w: Wide<S>, slots: usize) -> SlotDifferenceLanes<'_, S> {
        let [a, b, c, d] = &self.turns;
        SlotDifferenceLanes {
            larger: w.lanes(&self.larger[..slots]),
            turns: [a, b, c, d].map(|turn| w.lanes(&turn[..slots])),
        }
    }

    fn renew(&mut self, runs: &[Run], teeth: Option<&Teeth>, [x, y]: [&[f64]; 2]) {
        let slots = runs.len() * LANES;
        for values in std::iter::once(&mut self.larger).chain(&mut self.turns) {
            values.clear();
            values.resize(slots, 0.0);
        }
        for_each_slot(runs, |slot, roller| {
            self.larger[slot] = self.rollers.get(roller).copied().unwrap_or(0.0);
            if let Some(teeth) = teeth {
                let turns = teeth.turns([x[slot], y[slot]]);
                for (values, turn) in self.turns.iter_mut().zip(turns) {
                    values[slot] = turn;
                }
            }
        });
    }
}

impl Contacts {
    /// With the errors of the gaps, and with deviations of the roller diameters from that of the contacts \[m\]: one value a roller, or none where
    /// all are alike.
    pub(crate) fn with_errors(mut self, deviations: &[f64]) -> Self {
        let gaps_differ = matches!(&self.shape, Shape::Teeth(teeth) if !teeth.errors.is_empty());
        if !deviations.is_empty() || gaps_differ {
            let rollers: Vec<f64> = deviations.iter().map(|it| 0.5 * it).collect();
            self.largest = rollers
                .iter()
                .copied()
                .fold(self.touching, |largest, it| largest.max(self.touching + it));
            self.uneven = Some(Box::new(SlotDifferences {
                rollers,
                ..SlotDifferences::default()
            }));
        }
        self
    }

    /// Finds what differs in the slots as they are now.
    pub(super) fn renew_uneven(&mut self) {
        let Some(uneven) = &mut self.uneven else {
            return;
        };
        let teeth = match &self.shape {
            Shape::Teeth(teeth) => Some(teeth),
            Shape::Rail { .. } => None,
        };
        uneven.renew(&self.runs, teeth, [&self.axis_x, &self.axis_y]);
    }

    /// By how much the radius of a roller exceeds that of the contacts \[m\].
    pub(super) fn larger(&self, roller: usize) -> f64 {
        let rollers = self.uneven.as_ref().map(|uneven| &uneven.rollers);
        rollers
            .and_then(|rollers| rollers.get(roller))
            .copied()
            .unwrap_or(0.0)
    }
}

impl Teeth {
    /// Axis of a gap in the wheel frame; gaps are counted counter-clockwise from the one on the x axis.
    pub(super) fn axis(&self, gap: f64) -> [f64; 2] {
        let pitch = std::f64::consts::TAU / f64::from(self.count);
        let angle = gap * pitch + self.error(gap);
        [angle.cos(), angle.sin()]
    }

    /// The gap whose axis points into this direction, or nearly.
    pub(super) fn gap_at(&self, [x, y]: [f64; 2]) -> f64 {
        let pitch = std::f64::consts::TAU / f64::from(self.count);
        (y.atan2(x) / pitch).round()
    }

    /// Angle by which a gap stands from its place \[rad\].
    fn error(&self, gap: f64) -> f64 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number, not negative"
        )]
        let place = gap.rem_euclid(f64::from(self.count)) as usize;
        self.errors.get(place).copied().unwrap_or(0.0)
    }

    /// cos and sin of the turn by a pitch, for gaps that are in place.
    #[inline(always)]
    pub(super) fn pitch_turns<S: Simd>(&self, w: Wide<S>) -> [Lane<S>; 4] {
        let [c, s] = self.pitch_turn.map(|it| w.splat(it));
        [c, s, c, s]
    }

    /// cos and sin of the turns from a gap to the one on its right, which is clockwise, and to the one on its left.
    pub(super) fn turns(&self, axis: [f64; 2]) -> [f64; 4] {
        let gap = self.gap_at(axis);
        let pitch = std::f64::consts::TAU / f64::from(self.count);
        let here = self.error(gap);
        let right = pitch + here - self.error(gap - 1.0);
        let left = pitch + self.error(gap + 1.0) - here;
        [right.cos(), right.sin(), left.cos(), left.sin()]
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::dissipation::Dissipation;
    use chaindrive_contact::elastic::Power;
    use chaindrive_contact::{Elastic, Friction, Law};
    use chaindrive_geometry::{Point, Seat, Tip, ToothForm, ToothGap, Vector};

    use super::*;
    use crate::contact::Frame;
    use crate::profile::GapFace;
    use crate::surface::Surface;

    const TEETH: u32 = 18;
    const RADIUS: f64 = 0.01;

    fn teeth(errors: Vec<f64>, deviations: &[f64]) -> Contacts {
        let form = ToothForm::Iso606 {
            gap: 0.5,
            tip: Tip::Mid,
            seat: Seat::Bottom,
        };
        let gap = ToothGap::new(TEETH, 0.03, 2.0 * RADIUS, &form).unwrap();
        let step = std::f64::consts::TAU / f64::from(TEETH);
        let shape = Shape::Teeth(Teeth {
            face: GapFace::new(gap.pieces(), RADIUS),
            count: TEETH,
            tan_half: (0.5 * step).tan(),
            pitch_turn: [step.cos(), step.sin()],
            tip_radius: gap.tip_radius,
            errors,
        });
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
        Contacts::new(shape, surface, None, RADIUS).with_errors(deviations)
    }

    /// A gap that is turned, around a centre that is shifted, holds a roller that moves with it as before; a larger roller is nearer.
    #[test]
    fn rollers_see_gaps_where_they_are() {
        let errors: Vec<f64> = (0..TEETH).map(|gap| 1e-3 * f64::from(gap).sin()).collect();
        let drawn = teeth(Vec::new(), &[]);
        let made = teeth(errors.clone(), &[0.0, 3e-5]);
        let turned = |angle: f64| Frame {
            turn: [angle.cos(), angle.sin()],
            ..Frame::fixed()
        };
        let shift = Vector::new(2e-4, -1e-4);
        let step = std::f64::consts::TAU / f64::from(TEETH);
        for (gap, error) in errors.into_iter().enumerate() {
            // In the very middle a roller above its seat faces both flanks alike.
            for aside in [-0.3, -0.1, 0.05, 0.2] {
                let angle = (gap as f64 + aside) * step;
                let place = Point::new(0.0, 0.0) + turned(angle).outward(Vector::new(0.087, 0.0));
                let along = turned(error);
                let moved = Point::origin() + along.outward(place.coords) + shift;
                let frame = Frame {
                    eccentric: shift,
                    ..Frame::fixed()
                };
                let [before] = drawn.probes(&Frame::fixed(), 0, place)[..] else {
                    panic!("one stretch");
                };
                for (roller, larger) in [0.0, 1.5e-5].into_iter().enumerate() {
                    let [after] = made.probes(&frame, roller, moved)[..] else {
                        panic!("one stretch");
                    };
                    assert!((after.gap - (before.gap - larger)).abs() < 1e-15);
                    let normal = along.outward(before.normal);
                    // Beside the centre of its seat, 1e-16 m turn the normal of a roller by 1e-12.
                    assert!((after.normal - normal).norm() < 1e-10);
                }
            }
        }
    }
}
