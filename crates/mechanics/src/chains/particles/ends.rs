//! The ends of a strand of particles: held, driven or pulled.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::{Particles, Turning};
use crate::chains::strand_ends::HeldEnd;
use crate::energy::Flow;
use crate::joints::Resistance;
use crate::kinematics::Kinematics;
use crate::{End, Motion};

impl Particles {
    /// Puts driven ends where they are given.
    pub(super) fn put_ends(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        let n = self.series.stride;
        for held in &self.series.ends {
            if let End::Driven { x, y } = &held.end {
                let (x, y): (Kinematics, Kinematics) = (Motion::at(x, t), y.at(t));
                q[held.roller] = held.place.x + x.position;
                q[n + held.roller] = held.place.y + y.position;
                v[held.roller] = x.rate;
                v[n + held.roller] = y.rate;
            }
        }
    }

    /// Accelerations of the end rollers whose motion or load is given; links pull as `pull` says \[N\].
    pub(super) fn hold_ends(
        &self,
        gravity: Vector,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        joints: (&Turning, &Resistance),
        pull: impl Fn(usize, [(Point, Vector); 2]) -> f64,
    ) {
        let n = self.series.stride;
        for held in &self.series.ends {
            let i = held.roller;
            match &held.end {
                End::Free => {}
                End::Fixed => {
                    a[i] = 0.0;
                    a[n + i] = 0.0;
                }
                End::Driven { x, y } => {
                    let (x, y) = (x.at(at.t), y.at(at.t));
                    a[i] = x.acceleration;
                    a[n + i] = y.acceleration;
                    // F = m (a − g) − T − what turns and drags
                    let over = Vector::new(x.acceleration, y.acceleration) - gravity;
                    let needed =
                        self.end_force(at, held, over, &pull) - self.beside(at, held, joints);
                    rates[Flow::Motions as usize] += needed.x * x.rate + needed.y * y.rate;
                }
                End::Pulled { force } => {
                    a[i] += force.x * self.inverse_masses[i];
                    a[n + i] += force.y * self.inverse_masses[i];
                    rates[Flow::DriveTorque as usize] += force.x * at.v[i] + force.y * at.v[n + i];
                }
            }
        }
    }

    /// Force of the joint at the other end of the last link, and of drag, on an end roller \[N\].
    fn beside(
        &self,
        at: Moment<'_>,
        held: &HeldEnd,
        (turning, found): (&Turning, &Resistance),
    ) -> Vector {
        let [link, end] = if held.roller == 0 {
            [0, 0]
        } else {
            [held.roller - 1, 1]
        };
        let mut force = Vector::zeros();
        if let Some(drag) = &self.drag {
            force += drag.at_end(self, at, [link, end]);
        }
        if self.series.joints.is_some() {
            // F = ± (M_i − M_{i+1}) n_i/ℓ_i
            let couple = found.torque[link] - found.torque[link + 1];
            let [x, y] = &turning.across;
            let sign = if end == 0 { -couple } else { couple };
            force += Vector::new(x[link], y[link]) * sign;
        }
        force
    }

    /// Force that a support exerts on an end roller which is accelerated by `over` more than its weight does \[N\].
    fn end_force(
        &self,
        at: Moment<'_>,
        held: &HeldEnd,
        over: Vector,
        pull: &impl Fn(usize, [(Point, Vector); 2]) -> f64,
    ) -> Vector {
        let (link, inward) = if held.roller == 0 {
            (0, 1.0)
        } else {
            (held.roller - 1, -1.0)
        };
        let pins = self.pins(at, link);
        let along = (pins[1].0 - pins[0].0).normalize() * inward;
        over * self.masses[held.roller] - along * pull(link, pins)
    }
}
