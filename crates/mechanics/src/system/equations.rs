//! The equations of motion of everything but the rollers, and the powers that go with them.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::bodies::{RailSupport, WheelRotation, WheelSupport};
use super::{HeldEnd, Record, System};
use crate::End;
use crate::energy::Flow;

impl System {
    /// Accelerations of everything but the rollers, and the powers that go with them.
    pub(super) fn bodies(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &Record) {
        for (wheel, wrench) in self.wheels.iter().zip(&record.wheel_wrenches) {
            let (frame, course, acceleration) = self.wheel_frame(wheel, at);
            match &wheel.rotation {
                WheelRotation::Prescribed(_) => {
                    // P = (J α − M) ω
                    let torque = wheel.inertia * course.acceleration - wrench.moment;
                    rates[Flow::Driver as usize] += torque * course.rate;
                }
                WheelRotation::Free { dof, drive, load } => {
                    let sum = |torques: &[crate::Torque]| -> f64 {
                        let angle = course.position - wheel.angle;
                        torques.iter().map(|m| m.at(at.t, angle, course.rate)).sum()
                    };
                    let (driving, loading) = (sum(drive), sum(load));
                    rates[Flow::DriveTorque as usize] += driving * course.rate;
                    rates[Flow::Load as usize] += loading * course.rate;
                    // J α = M + M_drive + M_load
                    a[*dof] = (wrench.moment + driving + loading) / wheel.inertia;
                }
            }
            match &wheel.support {
                WheelSupport::Fixed => {}
                WheelSupport::Prescribed { .. } => {
                    // P = (m a − F − m g)·v
                    let force = Vector::new(wrench.force[0], wrench.force[1]);
                    let needed = (acceleration - self.gravity) * wheel.mass - force;
                    rates[Flow::Motions as usize] += needed.dot(&frame.velocity);
                }
                WheelSupport::Springs {
                    dof,
                    stiffness,
                    damping,
                } => {
                    for axis in 0..2 {
                        let away = frame.origin[axis] - wheel.centre[axis];
                        let speed = frame.velocity[axis];
                        // m a = F + m g − k x − c ẋ
                        let force =
                            wrench.force[axis] - stiffness[axis] * away - damping[axis] * speed;
                        a[dof + axis] = force / wheel.mass + self.gravity[axis];
                        rates[Flow::SupportLoss as usize] += damping[axis] * speed * speed;
                    }
                }
                WheelSupport::Carried(index) => {
                    let slide = &self.slides[*index];
                    if let Some(dof) = slide.dof {
                        a[dof] += slide.project(wrench.force, frame.origin);
                    }
                }
            }
        }
        for (rail, wrench) in self.rails.iter().zip(&record.rail_wrenches) {
            match &rail.support {
                RailSupport::Fixed => {}
                RailSupport::Prescribed { .. } => {
                    let frame = rail.frame(at.t, at.q, at.v, &self.slides);
                    let force = Vector::new(wrench.force[0], wrench.force[1]);
                    rates[Flow::Motions as usize] -= force.dot(&frame.velocity);
                }
                RailSupport::Carried(index) => {
                    let slide = &self.slides[*index];
                    if let Some(dof) = slide.dof {
                        // A rail on an arm has the pivot as its origin: the moment is about it.
                        a[dof] += match &slide.carrier {
                            crate::Carrier::Slider { .. } => {
                                slide.project(wrench.force, Point::origin())
                            }
                            crate::Carrier::Arm { .. } => wrench.moment,
                        };
                    }
                }
            }
        }
        for slide in &self.slides {
            let Some(dof) = slide.dof else { continue };
            let pose = slide.pose(at.q, at.v);
            let (extension, lever) = slide.carrier.extension(pose.coordinate);
            let push = slide.push.force(extension, lever * pose.rate);
            rates[Flow::TensionerLoss as usize] -= push.damping * lever * pose.rate;
            let mut force = a[dof] + (push.elastic + push.damping) * lever;
            for (mass, at_rest) in &slide.weights {
                let (place, _) = slide.carry(pose, *at_rest);
                let weight = self.gravity * *mass;
                force += slide.project([weight.x, weight.y], place);
            }
            a[dof] = force / slide.inertia;
        }
    }

    /// Accelerations of the end rollers whose motion or load is given.
    pub(super) fn hold_ends(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64]) {
        let n = self.stride;
        for held in &self.ends {
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
                    let needed =
                        self.end_force(at, held, Vector::new(x.acceleration, y.acceleration));
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

    /// Force that a support exerts on a held end roller \[N\].
    fn end_force(&self, at: Moment<'_>, held: &HeldEnd, acceleration: Vector) -> Vector {
        let (link, inward) = if held.roller == 0 {
            (0, 1.0)
        } else {
            (held.roller - 1, -1.0)
        };
        let pins = [self.pin(at, link), self.pin(at, link + 1)];
        let along = (pins[1].0 - pins[0].0).normalize() * inward;
        let pull = along * self.links.tension(link, pins);
        // F = m (a − g) − T
        (acceleration - self.gravity) * self.masses[held.roller] - pull
    }
}
