//! Lanes of rollers that cannot touch for a while are left alone.
//!
//! ```text
//! g(t + T) ≥ g − s T − ½ a T²,   T = min(0.3 g/s, √(0.4 g/a))
//! ```
//!
//! s is the relative speed, a the acceleration of the roller. Beside a face that bulges everywhere and does not turn,
//! the gap of a roller in straight motion is convex in time, so that its closing speed bounds it; s is that speed, and a
//! quarter of the whole for what the chain may do meanwhile. Where the body turns, s and a are those that it sees. Half of the gap is left when the lane is looked at again,
//! so a contact never begins on stale memory.

use pulp::Simd;

use crate::lanes::{Lane, Wide};

/// Steps of which rests are made: shorter ones do not pay, and after longer ones the chain may have turned to anything.
const SHORTEST: f64 = 4.0;
const LONGEST: f64 = 16.0;
/// Steps before the end at which the lane is looked at again, should the steps grow.
const EARLY: f64 = 2.0;
/// Share of the roller radius below which gaps to teeth are looked at in every step. What a wheel's own acceleration takes
/// from a gap during a rest is some tens of indentations, and those are thousands of times smaller than a roller.
pub(super) const CLOSE: f64 = 0.04;
/// Share of the speed that may turn towards the face.
const TURNING: f64 = 0.25;

/// Open contacts of a lane.
#[derive(Clone, Copy)]
pub(super) struct Clear<S: Simd> {
    /// Lower bounds of the gaps \[m\].
    pub(super) gap: Lane<S>,
    /// Closing speeds \[m/s\], where they bound the gaps.
    pub(super) closing: Option<Lane<S>>,
    /// Squares of the relative speeds \[m²/s²\] and of the accelerations \[m²/s⁴\].
    pub(super) speed: Lane<S>,
    pub(super) thrust: Lane<S>,
    /// Squares of the distances from the body's origin \[m²\].
    pub(super) lever: Lane<S>,
}

impl<S: Simd> Clear<S> {
    /// Time \[s\] for which the lane may rest, with steps of length dt, beside a body that turns at `spin` \[rad/s\]; zero if it may not.
    #[inline(always)]
    pub(super) fn rest(&self, w: Wide<S>, dt: f64, spin: f64) -> f64 {
        // One lane rests as a whole: the least gap and the largest speed and acceleration of any of its circles count.
        let gap = self.gap.smallest();
        let whole = self.speed.largest().sqrt();
        let speed = match self.closing {
            Some(closing) => closing.max(w.splat(0.0)).largest() + TURNING * whole,
            None => whole,
        };
        let mut thrust = self.thrust.largest().sqrt();
        if spin.abs() > 0.0 {
            // |a − 2 ω × u − ω × (ω × d)|
            thrust += spin.abs() * (2.0 * whole + spin.abs() * self.lever.largest().sqrt());
        }
        let rest = (0.3 * gap / speed).min((0.4 * gap / thrust).sqrt());
        // Not a number, where nothing moves: no rest.
        if rest > SHORTEST * dt && dt > 0.0 {
            (rest - EARLY * dt).min(LONGEST * dt)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::dissipation::Dissipation;
    use chaindrive_contact::elastic::Power;
    use chaindrive_contact::{Elastic, Friction, Law};
    use chaindrive_geometry::{Piece, Point, Seat, Segment, Tip, ToothForm, ToothGap, Vector};
    use chaindrive_integrate::{Registers, kernel};

    use super::*;
    use crate::contact::{Contacts, Frame, Places, Rollers, Shape, Teeth, Touch, Wrench};
    use crate::profile::{GapFace, RailFace};
    use crate::surface::Surface;

    kernel!(
        fn look<'a, S: Simd>(
            w: Wide<S>,
            contacts: &'a Contacts,
            t: f64,
            frame: Frame,
            rollers: Rollers<'a>,
            touch: &'a mut Touch,
        ) {
            let (mut rollers, mut wrench) = (rollers, Wrench::default());
            contacts.act(w, t, &frame, &mut rollers, None, touch, &mut wrench);
        }
    );

    const RADIUS: f64 = 0.01;
    const DT: f64 = 1e-5;

    fn contacts(shape: Shape) -> Contacts {
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
        Contacts::new(shape, surface, None, RADIUS)
    }

    /// Moves rollers along given paths past a body: a contact must be seen in the very step that the distance says.
    /// Counts lanes at rest and rollers in contact.
    fn watch(
        contacts: &mut Contacts,
        frame: impl Fn(f64) -> Frame,
        path: impl Fn(usize, f64) -> [f64; 2],
        acceleration: f64,
    ) -> [usize; 2] {
        let count = 24;
        let [mut x, mut y, mut vx, mut vy] = [(); 4].map(|()| vec![0.0; count]);
        let (mut ax, mut ay) = (vec![0.0; count], vec![acceleration; count]);
        let inverse_mass = vec![0.0; count];
        let mut touch = Box::<Touch>::default();
        let (mut rested, mut touched) = (0, 0);
        for step in 0..900 {
            let t = f64::from(step) * DT;
            for i in 0..count {
                let ([x0, y0], [x1, y1]) = (path(i, t), path(i, t + 1e-6));
                (x[i], y[i]) = (x0, y0);
                (vx[i], vy[i]) = ((x1 - x0) / 1e-6, (y1 - y0) / 1e-6);
            }
            let here = frame(t);
            if step % 64 == 0 {
                let (x, y) = (&x, &y);
                contacts.renew(&here, Places { x, y, count }, 0.1);
            }
            rested += contacts.memory.wake.iter().filter(|w| **w > t).count();
            let rollers = Rollers {
                x: &x,
                y: &y,
                vx: &vx,
                vy: &vy,
                ax: &mut ax,
                ay: &mut ay,
                inverse_mass: &inverse_mass,
                spin: &[],
                half_step: 0.0,
            };
            Registers::in_use().dispatch(look(contacts, t, here, rollers, &mut touch));
            std::mem::swap(&mut contacts.memory, &mut touch);
            contacts.accepted = t;
            for i in 0..count {
                let slot = contacts.slot_of(i);
                let faces = contacts.probes(&here, i, Point::new(x[i], y[i]));
                let inside = faces.iter().any(|face| face.gap < 0.0);
                let closed = |slot| contacts.memory.state.closed(slot).is_some();
                let seen = slot.is_some_and(closed);
                assert_eq!(inside, seen, "roller {i} at {t}");
                touched += usize::from(seen);
            }
        }
        [rested, touched]
    }

    /// Rollers slide along a bent bar at 6 m/s and fall on it.
    #[test]
    fn no_contact_begins_unseen() {
        let points = [[0.4, -0.05], [0.1, 0.0], [-0.4, 0.0]].map(|[x, y]| Point::new(x, y));
        let pieces = points.windows(2).map(|ends| {
            Piece::Segment(Segment {
                start: ends[0],
                end: ends[1],
            })
        });
        let face = RailFace::new(&pieces.collect::<Vec<_>>());
        assert!(face.bulges());
        let mut contacts = contacts(Shape::Rail {
            face,
            reference: Point::origin(),
            bounds: [Point::new(-0.4, -0.05), Point::new(0.4, 0.0)],
        });
        let path = |i: usize, t: f64| {
            let (i, along) = (i as f64, -6.0);
            let height = 0.011 + 0.0005 * i + 3e-3 * (0.2 * i).sin();
            [
                0.3 - 0.02 * i + along * t,
                height + 0.05 * (3.0 * i).cos() * t - 300.0 * t * t,
            ]
        };
        let [rested, touched] = watch(&mut contacts, |_| Frame::fixed(), path, -600.0);
        assert!(rested > 500, "{rested}");
        assert!(touched > 1000, "{touched}");
    }

    /// Rollers fly over a turning wheel, faster than its rim, and fall on its teeth: as drawn, and with errors of wheel and rollers.
    #[test]
    fn no_contact_with_teeth_begins_unseen() {
        fall(&[], Vector::zeros(), &[]);
        let wave = |k: f64| 2e-4 * (1.7 * k).sin();
        let errors: Vec<f64> = (0..40).map(|gap| 0.1 * wave(f64::from(gap))).collect();
        let deviations: Vec<f64> = (0..24).map(|i| wave(f64::from(i))).collect();
        fall(&errors, Vector::new(3e-4, -2e-4), &deviations);
    }

    fn fall(errors: &[f64], eccentricity: Vector, deviations: &[f64]) {
        let (pitch, count) = (0.03, 40);
        let form = ToothForm::Iso606 {
            gap: 0.5,
            tip: Tip::Mid,
            seat: Seat::Bottom,
        };
        let gap = ToothGap::new(count, pitch, 2.0 * RADIUS, &form).unwrap();
        let step = std::f64::consts::TAU / f64::from(count);
        let mut contacts = contacts(Shape::Teeth(Teeth {
            face: GapFace::new(gap.pieces(), RADIUS),
            count,
            tan_half: (0.5 * step).tan(),
            pitch_turn: [step.cos(), step.sin()],
            tip_radius: gap.tip_radius,
            errors: errors.to_vec(),
        }))
        .with_errors(deviations);
        let (centre, rim) = (Point::new(0.0, -gap.pitch_radius), 6.0);
        let spin = rim / gap.pitch_radius;
        let frame = |t: f64| {
            let turned = Frame {
                origin: centre,
                turn: [(spin * t).cos(), (spin * t).sin()],
                spin,
                ..Frame::fixed()
            };
            Frame {
                eccentric: turned.outward(eccentricity),
                ..turned
            }
        };
        let path = |i: usize, t: f64| {
            let i = i as f64;
            let height = 0.01 + 1e-3 * i + 1e-3 * (0.7 * i).sin();
            [
                0.15 - pitch * i - 1.3 * rim * t,
                height - (3.0 + (3.0 * i).cos()) * t - 150.0 * t * t,
            ]
        };
        let [rested, touched] = watch(&mut contacts, frame, path, -300.0);
        assert!(rested > 500, "{rested}");
        assert!(touched > 1000, "{touched}");
    }
}
