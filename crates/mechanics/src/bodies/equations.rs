//! The equations of motion of everything but the chains, and the powers that go with them.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, Prediction};

use super::slide::Pose;
use super::{Bodies, RailSupport, TurnedBy, Wheel, WheelSupport};
use crate::contact::Wrench;
use crate::energy::Flow;
use crate::tensioner::Slopes;

impl Bodies {
    /// Accelerations of the bodies under what all chains together do to wheels and rails, and the powers that go with them.
    pub(crate) fn accelerate(
        &self,
        at: Moment<'_>,
        prediction: Option<Prediction<'_>>,
        a: &mut [f64],
        rates: &mut [f64],
        [wheel_wrenches, rail_wrenches]: [&[Wrench]; 2],
        (pushes, resisting): (&mut [Slopes], &mut [f64]),
    ) {
        let (rates, flows) = rates.split_at_mut(Flow::ALL.len());
        self.turn_shafts(at, a, rates, wheel_wrenches, resisting);
        for (wheel, wrench) in self.wheels.iter().zip(wheel_wrenches) {
            let centre = || wheel.centre_kinematics(at.t, at.q, at.v, &self.slides);
            match &wheel.support {
                WheelSupport::Fixed => {}
                WheelSupport::Prescribed { .. } => {
                    let (_, velocity, acceleration) = centre();
                    // P = (m a − F − m g)·v
                    let force = Vector::new(wrench.force[0], wrench.force[1]);
                    let needed = (acceleration - self.gravity) * wheel.mass - force;
                    rates[Flow::Motions as usize] += needed.dot(&velocity);
                }
                WheelSupport::Springs {
                    dof,
                    stiffness,
                    damping,
                } => {
                    let (centre, velocity, _) = centre();
                    for axis in 0..2 {
                        let away = centre[axis] - wheel.centre[axis];
                        let speed = velocity[axis];
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
                        let (centre, _, _) = centre();
                        let pose = slide.pose(at.q, at.v);
                        a[dof] += slide.project(pose, wrench.force, centre);
                    }
                }
            }
        }
        for (rail, wrench) in self.rails.iter().zip(rail_wrenches) {
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
                        // Q = F·∂x/∂s + M ∂φ/∂s, both about the origin of the face
                        let origin = rail.frame(at.t, at.q, at.v, &self.slides).origin;
                        let pose = slide.pose(at.q, at.v);
                        let shifting = slide.project(pose, wrench.force, origin);
                        a[dof] += shifting + slide.carrier.turning() * wrench.moment;
                    }
                }
            }
        }
        for (i, slide) in self.slides.iter().enumerate() {
            let Some(dof) = slide.dof else { continue };
            let mut pose = slide.pose(at.q, at.v);
            let mut state = slide.state(at.z);
            let input = self.inputs.force(i, at.t);
            let given = a[dof] + input + slide.weight(pose, self.gravity);
            let reduced = slide.reduced(pose);
            // I s̈ = Σ Q − ½ I′ ṡ²
            let accelerate = |pose: Pose, state: f64| {
                let (push, lever) = slide.pushed(pose, state);
                let force = given + (push.elastic + push.damping) * lever;
                let turning = 0.5 * reduced.slope * pose.rate * pose.rate;
                (push, lever, (force - turning) / reduced.inertia)
            };
            if let Some(prediction) = prediction {
                state = slide.state_ahead(pose, at.z, prediction);
                let (_, _, acceleration) = accelerate(pose, state);
                pose.rate = slide.rate_ahead(pose, state, acceleration, prediction);
            }
            let (push, lever, acceleration) = accelerate(pose, state);
            a[dof] = acceleration;
            rates[Flow::TensionerLoss as usize] -= push.damping * lever * pose.rate;
            if let Some(place) = slide.state {
                rates[Flow::TensionerLoss as usize] += push.loss;
                flows[place] = push.flow;
                pushes[i] = slide.slopes(pose, state);
            }
            rates[Flow::DriveTorque as usize] += input * pose.rate;
        }
    }

    /// Accelerations of the shafts.
    ///
    /// ```text
    /// (Σ i² J) α = Σ i (M_chain + M_drive + M_load + M_loss + M_coupling),   over all that turns with a coordinate
    /// ```
    fn turn_shafts(
        &self,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        wheel_wrenches: &[Wrench],
        resisting: &mut [f64],
    ) {
        for (wheel, wrench) in self.wheels.iter().zip(wheel_wrenches) {
            if let Some((dof, ratio)) = wheel.turn.turned_by() {
                a[dof] += ratio * wrench.moment;
            } else {
                // P = (J α − M) ω
                let kinematics = wheel.kinematics(at.t, at.q, at.v);
                let torque = wheel.inertia * kinematics.acceleration - wrench.moment;
                rates[Flow::Driver as usize] += torque * kinematics.rate;
            }
        }
        for (i, shaft) in self.shafts.iter().enumerate() {
            let kinematics = shaft.turn.kinematics(at.t, at.q, at.v);
            let driving = self.torque(&shaft.drive, kinematics, at) + self.inputs.torque(i, at.t);
            let loading = shaft.load_factor * self.torque(&shaft.load, kinematics, at);
            rates[Flow::DriveTorque as usize] += driving * kinematics.rate;
            rates[Flow::Load as usize] += loading * kinematics.rate;
            if let Some((dof, ratio)) = shaft.turn.turned_by() {
                a[dof] += ratio * driving;
                a[dof] += ratio * loading;
            } else {
                // What else turns with a motion that is given, or resists it, is supplied by it.
                let torque = shaft.inertia * kinematics.acceleration - driving - loading;
                rates[Flow::Driver as usize] += torque * kinematics.rate;
            }
        }
        self.resist(at, a, rates, wheel_wrenches, resisting);
        for coupling in &self.couplings {
            let [torque, rate] = self.coupling_torque(coupling, at);
            rates[Flow::SupportLoss as usize] += coupling.damping * rate * rate;
            for (index, sign) in coupling.shafts.into_iter().zip([1.0, -1.0]) {
                let turn = &self.shafts[index].turn;
                if let Some((dof, ratio)) = turn.turned_by() {
                    a[dof] += sign * ratio * torque;
                } else {
                    // A motion that is given supplies what the coupling takes.
                    let speed = turn.kinematics(at.t, at.q, at.v).rate;
                    rates[Flow::Driver as usize] -= sign * torque * speed;
                }
            }
        }
        for shaft in self.shafts.iter().filter(|it| it.leads) {
            match &shaft.turn.by {
                TurnedBy::Coordinate(dof) => a[*dof] /= self.inertia(*dof),
                TurnedBy::Driven { dof, path } => a[*dof] = path.at(at.t).acceleration,
                TurnedBy::Motion(_) => {}
            }
        }
    }

    /// Losses of the shafts, at their sprockets and elsewhere; their damping is written down.
    ///
    /// ```text
    /// F = |F_chain + m g|      P = −T ω
    /// ```
    fn resist(
        &self,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        wheel_wrenches: &[Wrench],
        resisting: &mut [f64],
    ) {
        let weighed = |(wheel, wrench): (&Wheel, &Wrench)| {
            let weight = self.gravity * wheel.mass;
            (wrench.force[0] + weight.x).hypot(wrench.force[1] + weight.y)
        };
        let wheels = self.wheels.iter().zip(wheel_wrenches);
        let at_wheels = wheels.map(|it| (&it.0.turn, &it.0.loss, Some(it)));
        let elsewhere = self.shafts.iter().map(|it| (&it.turn, &it.loss, None));
        for ((turn, loss, carries), damping) in at_wheels.chain(elsewhere).zip(resisting) {
            if loss.is_none() {
                continue;
            }
            let force = carries.map_or(0.0, weighed);
            let speed = turn.kinematics(at.t, at.q, at.v).rate;
            let found = loss.act(force, speed);
            let [bearing, drag] = found.torques;
            *damping = found.damping;
            rates[Flow::BearingLoss as usize] -= bearing * speed;
            rates[Flow::ShaftDragLoss as usize] -= drag * speed;
            if let Some((dof, ratio)) = turn.turned_by() {
                a[dof] += ratio * (bearing + drag);
            } else {
                // A motion that is given supplies what resists it.
                rates[Flow::Driver as usize] -= (bearing + drag) * speed;
            }
        }
    }
}
