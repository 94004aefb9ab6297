//! Lanes of rollers that cannot touch for a while are left alone.
//!
//! ```text
//! g(t + T) ≥ g − s T − ½ a T²,   T = min(0.3 g/s, √(0.4 g/a))
//! ```
//!
//! s is the relative speed, a the acceleration of the roller. Beside a face that bulges everywhere and does not turn,
//! the gap of a roller in straight motion is convex in time, so that its closing speed bounds it; s is that speed, and a
//! quarter of the whole for what the chain may do meanwhile. Half of the gap is left when the lane is looked at again,
//! so a contact never begins on stale memory.

use pulp::Simd;

use super::window::FAR;
use super::{Contacts, Touch};
use crate::lanes::{Lane, Wide};

/// Steps of which rests are made: shorter ones do not pay, and after longer ones the chain may have turned to anything.
const SHORTEST: f64 = 4.0;
const LONGEST: f64 = 16.0;
/// Steps before the end at which the lane is looked at again, should the steps grow.
const EARLY: f64 = 2.0;
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
}

impl<S: Simd> Clear<S> {
    /// How long \[s\] the lane may rest with steps of length dt; zero if it may not.
    #[inline(always)]
    pub(super) fn rest(&self, w: Wide<S>, dt: f64) -> f64 {
        let gap = self.gap.smallest();
        let whole = self.speed.largest().sqrt();
        let speed = match self.closing {
            Some(closing) => closing.max(w.splat(0.0)).largest() + TURNING * whole,
            None => whole,
        };
        let thrust = self.thrust.largest().sqrt();
        let rest = (0.3 * gap / speed).min((0.4 * gap / thrust).sqrt());
        // Not a number, where nothing moves: no rest.
        if rest > SHORTEST * dt && dt > 0.0 {
            (rest - EARLY * dt).min(LONGEST * dt)
        } else {
            0.0
        }
    }
}

impl Contacts {
    /// A lane without contacts, at rest until some time \[s\].
    #[inline(always)]
    pub(super) fn leave_open<S: Simd>(
        &self,
        w: Wide<S>,
        slot: usize,
        until: f64,
        touch: &mut Touch,
    ) {
        let zero = w.splat(0.0);
        for side in 0..self.sides() {
            let slot = side * self.slots + slot;
            w.splat(FAR).store(&mut touch.gap, slot);
            zero.store(&mut touch.closing, slot);
            zero.store(&mut touch.inverse_onset, slot);
            zero.store(&mut touch.force, slot);
        }
        touch.wake[slot] = until;
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::dissipation::Dissipation;
    use chaindrive_contact::elastic::Power;
    use chaindrive_contact::{Elastic, Friction, Law};
    use chaindrive_geometry::{Piece, Point, Segment};
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::contact::{Frame, Places, Shape};
    use crate::drive::Surface;
    use crate::profile::Profile;
    use crate::system::Rollers;

    struct Look<'a> {
        contacts: &'a Contacts,
        t: f64,
        rollers: Rollers<'a>,
        touch: &'a mut Touch,
    }

    impl WithSimd for Look<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(mut self, simd: S) {
            let frame = Frame::fixed();
            let wide = Wide(simd);
            self.contacts
                .act(wide, self.t, &frame, &mut self.rollers, self.touch);
        }
    }

    /// Rollers slide along a bent bar at 6 m/s and fall on it: some lane rests, and a contact is seen in the very step
    /// that the distance says.
    #[test]
    fn no_contact_begins_unseen() {
        let points = [[0.4, -0.05], [0.1, 0.0], [-0.4, 0.0]].map(|[x, y]| Point::new(x, y));
        let pieces = points.windows(2).map(|ends| {
            Piece::Segment(Segment {
                start: ends[0],
                end: ends[1],
            })
        });
        let profile = Profile::new(&pieces.collect::<Vec<_>>(), true, true);
        assert!(profile.bulges);
        let radius = 0.01;
        let surface = Surface {
            law: Law {
                elastic: Elastic::Power(Power::linear(1e6)),
                dissipation: Dissipation::None,
                onset_floor: 0.01,
            },
            friction: Friction::None,
        };
        let shape = Shape::Rail {
            profile: profile.clone(),
            reference: Point::origin(),
            bounds: [Point::new(-0.4, -0.05), Point::new(0.4, 0.0)],
        };
        let mut contacts = Contacts::new(shape, surface, None, radius);
        let count = 24;
        let place = |i: usize, t: f64| {
            let (i, along) = (i as f64, -6.0);
            let height = 0.011 + 0.0005 * i + 3e-3 * (0.2 * i).sin();
            [
                0.3 - 0.02 * i + along * t,
                height + 0.05 * (3.0 * i).cos() * t - 300.0 * t * t,
            ]
        };
        let [mut x, mut y, mut vx, mut vy] = [(); 4].map(|()| vec![0.0; count]);
        let (mut ax, mut ay) = (vec![0.0; count], vec![-600.0; count]);
        let inverse_mass = vec![0.0; count];
        let mut touch = Box::<Touch>::default();
        let (dt, mut rested, mut touched) = (1e-5, 0, 0);
        for step in 0..900 {
            let t = f64::from(step) * dt;
            for i in 0..count {
                let ([x0, y0], [x1, y1]) = (place(i, t), place(i, t + 1e-6));
                (x[i], y[i]) = (x0, y0);
                (vx[i], vy[i]) = ((x1 - x0) / 1e-6, (y1 - y0) / 1e-6);
            }
            if step % 64 == 0 {
                let (x, y) = (&x, &y);
                contacts.renew(&Frame::fixed(), Places { x, y, count }, 0.1);
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
            };
            Arch::new().dispatch(Look {
                contacts: &contacts,
                t,
                rollers,
                touch: &mut touch,
            });
            std::mem::swap(&mut contacts.memory, &mut touch);
            contacts.accepted = t;
            for i in 0..count {
                let inside = profile.probe(Point::new(x[i], y[i]), radius).gap < 0.0;
                let seen = contacts
                    .slot_of(i)
                    .is_some_and(|slot| contacts.memory.inverse_onset[slot] > 0.0);
                assert_eq!(inside, seen, "roller {i} at {t}");
                touched += usize::from(seen);
            }
        }
        assert!(rested > 500, "{rested}");
        assert!(touched > 1000, "{touched}");
    }
}
