//! The equations of motion of everything but the chains, and the powers that go with them.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, Prediction};

use super::forces::with_force;
use super::slide::Pose;
use super::{Bodies, RailSupport, TurnedBy, Wheel, WheelSupport};
use crate::accounts::{AccountRates, Source};
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
        let (rates, rest) = rates.split_at_mut(Flow::ALL.len());
        let (accounts, flows) = rest.split_at_mut(self.accounts.length());
        let accounts = &mut self.accounts.rates(accounts);
        self.turn_shafts(at, a, (rates, accounts), wheel_wrenches, resisting);
        if accounts.are_kept() {
            for (i, (wheel, wrench)) in self.wheels.iter().zip(wheel_wrenches).enumerate() {
                accounts.of_sprocket(i, wheel.shaft, wrench.moment, wrench.force);
            }
            for (i, wrench) in rail_wrenches.iter().enumerate() {
                accounts.of_guide(i, wrench.force, wrench.normal_loss + wrench.friction_loss);
            }
            self.balance_shafts(a, accounts);
        }
        for (index, (wheel, wrench)) in self.wheels.iter().zip(wheel_wrenches).enumerate() {
            let centre = || wheel.centre_kinematics(at.t, at.q, at.v, &self.slides);
            match &wheel.support {
                WheelSupport::Fixed => {}
                WheelSupport::Prescribed { .. } => {
                    let (_, velocity, acceleration) = centre();
                    let given = self.centre_force(index, at);
                    // P = (m a − F − m g)·v
                    let force = Vector::from(with_force(wrench.force, given));
                    let needed = (acceleration - self.gravity) * wheel.mass - force;
                    rates[Flow::Motions as usize] += needed.dot(&velocity);
                    if let Some(given) = given {
                        let power = Vector::from(given).dot(&velocity);
                        rates[Flow::Forces as usize] += power;
                        accounts.force_centre(index, power);
                    }
                }
                WheelSupport::Springs {
                    dof,
                    stiffness,
                    damping,
                } => {
                    let (centre, velocity, _) = centre();
                    let given = self.centre_force(index, at);
                    let force = with_force(wrench.force, given);
                    for axis in 0..2 {
                        let away = centre[axis] - wheel.centre[axis];
                        let speed = velocity[axis];
                        // m a = F + m g − k x − c ẋ
                        let force = force[axis] - stiffness[axis] * away - damping[axis] * speed;
                        a[dof + axis] = force / wheel.mass + self.gravity[axis];
                        let lost = damping[axis] * speed * speed;
                        rates[Flow::SupportLoss as usize] += lost;
                        accounts.damp(index, lost);
                    }
                    if let Some(given) = given {
                        let power = Vector::from(given).dot(&velocity);
                        rates[Flow::Forces as usize] += power;
                        accounts.force_centre(index, power);
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
        self.move_slides(at, prediction, a, (rates, accounts), (flows, pushes));
    }

    /// Accelerations of the tensioners; what else acts on their coordinates stands there.
    fn move_slides(
        &self,
        at: Moment<'_>,
        prediction: Option<Prediction<'_>>,
        a: &mut [f64],
        (rates, accounts): (&mut [f64], &mut AccountRates<'_>),
        (flows, pushes): (&mut [f64], &mut [Slopes]),
    ) {
        for (i, slide) in self.slides.iter().enumerate() {
            let Some(dof) = slide.dof else { continue };
            let mut pose = slide.pose(at.q, at.v);
            let mut state = slide.state(at.z);
            let input = self.inputs.force(i, at.t);
            let mut given = a[dof] + input + slide.weight(pose, self.gravity);
            self.each_force_on(i, pose, at, |force| given += force.along);
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
            let mut lost = -push.damping * lever * pose.rate;
            if let Some(place) = slide.state {
                lost += push.loss;
                flows[place] = push.flow;
                pushes[i] = slide.slopes(pose, state);
            }
            rates[Flow::TensionerLoss as usize] += lost;
            accounts.of_tensioner(i, [pose.coordinate, push.elastic + push.damping, lost]);
            rates[Flow::DriveTorque as usize] += input * pose.rate;
            self.each_force_on(i, pose, at, |force| {
                let power = force.along * pose.rate;
                rates[Flow::Forces as usize] += power;
                match force.centre {
                    Some(wheel) => accounts.force_centre(wheel, power),
                    None => accounts.force_carrier(i, power),
                }
            });
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
        (rates, accounts): (&mut [f64], &mut AccountRates<'_>),
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
            let control = self.inputs.torque(i, at.t);
            let driving = self.torque(&shaft.drive, kinematics, at) + control;
            let loading = shaft.load_factor * self.torque(&shaft.load, kinematics, at);
            rates[Flow::DriveTorque as usize] += driving * kinematics.rate;
            rates[Flow::Load as usize] += loading * kinematics.rate;
            accounts.turn(i, kinematics.rate, kinematics.acceleration);
            accounts.add(i, Source::Drive, (driving - control) * kinematics.rate);
            accounts.add(i, Source::Control, control * kinematics.rate);
            accounts.add(i, Source::Load, loading * kinematics.rate);
            if let Some((dof, ratio)) = shaft.turn.turned_by() {
                a[dof] += ratio * driving;
                a[dof] += ratio * loading;
            } else {
                // What else turns with a motion that is given, or resists it, is supplied by it.
                let torque = shaft.inertia * kinematics.acceleration - driving - loading;
                rates[Flow::Driver as usize] += torque * kinematics.rate;
            }
        }
        self.resist(at, a, (rates, accounts), wheel_wrenches, resisting);
        for coupling in &self.couplings {
            let [torque, rate] = self.coupling_torque(coupling, at);
            rates[Flow::SupportLoss as usize] += coupling.damping * rate * rate;
            for (index, sign) in coupling.shafts.into_iter().zip([1.0, -1.0]) {
                let turn = &self.shafts[index].turn;
                let speed = turn.kinematics(at.t, at.q, at.v).rate;
                accounts.add(index, Source::Couplings, sign * torque * speed);
                if let Some((dof, ratio)) = turn.turned_by() {
                    a[dof] += sign * ratio * torque;
                } else {
                    // A motion that is given supplies what the coupling takes.
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

    /// Adds what gears and motions that are given do on the shafts.
    ///
    /// ```text
    /// P = J α ω − Σ M ω     what is missing on a shaft: a given motion supplies it, through the gears of a train
    /// ```
    fn balance_shafts(&self, a: &[f64], accounts: &mut AccountRates<'_>) {
        for (i, shaft) in self.shafts.iter().enumerate() {
            let [speed, mut acceleration] = accounts.turning(i);
            let leader = shaft.turn.train;
            if let Some((dof, ratio)) = shaft.turn.turned_by() {
                acceleration = ratio * a[dof];
                accounts.turn(i, speed, acceleration);
                let mut train = self.shafts.iter().filter(|it| it.turn.train == leader);
                // Alone on its coordinate nothing is missing but rounding.
                if train.nth(1).is_none() {
                    continue;
                }
            }
            let on_it = self.wheels.iter().filter(|wheel| wheel.shaft == i);
            let inertia = shaft.inertia + on_it.map(|wheel| wheel.inertia).sum::<f64>();
            let missing = inertia * acceleration * speed - accounts.power(i);
            if shaft.turn.turned_by().is_none() {
                accounts.add(leader, Source::Motion, missing);
                accounts.add(leader, Source::Gears, -missing);
            }
            accounts.add(i, Source::Gears, missing);
        }
    }

    /// Losses of the shafts, at their sprockets and elsewhere; their damping is written down.
    ///
    /// ```text
    /// F = |F_chain + F_outside + m g|      P = −T ω
    /// ```
    fn resist(
        &self,
        at: Moment<'_>,
        a: &mut [f64],
        (rates, accounts): (&mut [f64], &mut AccountRates<'_>),
        wheel_wrenches: &[Wrench],
        resisting: &mut [f64],
    ) {
        let weighed = |(index, (wheel, wrench)): (usize, (&Wheel, &Wrench))| {
            let weight = self.gravity * wheel.mass;
            let force = with_force(wrench.force, self.centre_force(index, at));
            (force[0] + weight.x).hypot(force[1] + weight.y)
        };
        let wheels = self.wheels.iter().zip(wheel_wrenches).enumerate();
        let at_wheels = wheels.map(|it| {
            let (_, (wheel, _)) = it;
            (wheel.shaft, &wheel.turn, &wheel.loss, Some(it))
        });
        let shafts = self.shafts.iter().enumerate();
        let elsewhere = shafts.map(|(index, it)| (index, &it.turn, &it.loss, None));
        for ((shaft, turn, loss, carries), damping) in at_wheels.chain(elsewhere).zip(resisting) {
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
            accounts.add(shaft, Source::Bearings, bearing * speed);
            accounts.add(shaft, Source::Drag, drag * speed);
            if let Some((dof, ratio)) = turn.turned_by() {
                a[dof] += ratio * (bearing + drag);
            } else {
                // A motion that is given supplies what resists it.
                rates[Flow::Driver as usize] -= (bearing + drag) * speed;
            }
        }
    }
}
